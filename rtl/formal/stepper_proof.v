// SPDX-License-Identifier: MIT
/*
 * stepper, with anything at all in place of its arithmetic and of both methods, in runs of any length: a beat that is
 * offered holds still until it is taken, none is dropped, exactly one of a run is the last, done comes once, after it,
 * a beat with a fault is void, and a stop is followed by the void beat and by nothing else that is new.
 */
module stepper_proof #(
    parameter WORD = 17
) (
    input wire             clk,
    input wire             load,
    input wire [2:0]       load_space,
    input wire [9:0]       load_index,
    input wire [WORD+26:0] load_data,
    input wire             go,
    input wire             stop,
    input wire             ready
);
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 3) age <= age + 1;
    wire rst = age == 0;

    wire              busy, done, valid, last, stopped;
    wire [4:0]        faults;
    wire [WORD-2:0]   u;
    wire [2*WORD-1:0] point;
    stepper #(.WORD(WORD), .DIM(2), .RATIONAL(0)) dut (
        .clk(clk), .rst(rst), .load(load && !busy), .load_space(load_space), .load_index(load_index),
        .load_data(load_data), .go(go), .stop(stop), .busy(busy), .done(done), .valid(valid), .ready(ready), .u_out(u),
        .point_out(point), .last(last), .stopped(stopped), .faults(faults)
    );

    reg              waits = 0, running = 0, ended = 0, told = 0;
    reg [3*WORD:0]   was;
    always @(posedge clk) if (!rst) begin
        waits   <= valid && !ready;
        was     <= {stopped, last, u, point};
        running <= busy;
        if (go && !busy) ended <= 0;
        else if (valid && ready && last) ended <= 1;
        told <= busy && (told || (stop && !(valid && last)));
    end
    always @* if (!rst) begin
        assert (!(busy && done));
        if (waits) assert (valid && {stopped, last, u, point} == was);
        if (done) assert (ended && running && !valid);
        if (valid) assert (busy);
    end
    always @* if (!rst) begin
        cover (done && ended && faults == 0 && !stopped);
        cover (done && faults == 5'b01000);
        cover (done && faults == 0 && stopped);
        cover (valid && waits && !last);
    end
endmodule

/* Stand-ins: each answers when and what it likes, even unasked. */

module soft_limits #(parameter WORD = 35, parameter DIM = 3) (
    input wire clk, input wire load, input wire [3:0] load_index, input wire [WORD-1:0] load_data,
    input wire [DIM*WORD-1:0] point, input wire [DIM*WORD-1:0] point_before, output wire too_far, output wire beyond,
    input wire [2:0] bound, output wire bound_beyond
);
    assign bound_beyond = $anyseq;
    assign too_far = $anyseq;
    assign beyond = $anyseq;
endmodule

module runge_kutta #(parameter WORD = 35, parameter DIM = 3, parameter CACHED = 1) (
    input wire clk, input wire rst, input wire start, input wire first, input wire [WORD-2:0] u,
    input wire [WORD-2:0] u_before, input wire [DIM*WORD-1:0] point_before, input wire [WORD-2:0] s_now,
    input wire [WORD-2:0] s_half, input wire [WORD-2:0] s_whole, input wire [WORD-2:0] first_du,
    input wire [WORD-2:0] first_chord, output wire busy, output wire done, output wire point_done,
    output wire signed [WORD-1:0] k, output wire [WORD-2:0] u_next, output wire overflow, output wire by_zero,
    output wire row_start, output wire row_want_a, output wire row_want_b, output wire row_given,
    output wire row_half, output wire row_whole, output wire [WORD-2:0] row_s, output wire signed [WORD-1:0] row_du,
    output wire [DIM*WORD-1:0] row_base, output wire signed [WORD-1:0] row_shift, input wire row_done,
    input wire signed [WORD-1:0] row_k, input wire row_overflow, input wire row_by_zero
);
    assign row_shift = $anyseq;
    assign {busy, done, point_done, overflow, by_zero} = $anyseq;
    assign {row_start, row_want_a, row_want_b, row_given, row_half, row_whole} = $anyseq;
    assign k = $anyseq;
    assign u_next = $anyseq;
    assign row_s = $anyseq;
    assign row_du = $anyseq;
    assign row_base = $anyseq;
endmodule

module adams #(
    parameter WORD = 35, parameter DIM = 3, parameter ARRANGEMENT = 2, parameter ROWS = 1
) (
    input wire clk, input wire rst, input wire push, input wire [DIM*WORD-1:0] push_point,
    input wire signed [WORD-1:0] push_k, output wire [WORD-2:0] u_before, output wire [DIM*WORD-1:0] point_before,
    input wire start, input wire [WORD-2:0] u, input wire [WORD-2:0] s, output wire busy, output wire done,
    output wire signed [WORD-1:0] k, output wire [WORD-2:0] u_next, output wire overflow, output wire by_zero,
    output wire row_start, output wire [ROWS*(WORD-1)-1:0] row_u_a, output wire [ROWS*(WORD-1)-1:0] row_u_b,
    output wire [ROWS*(WORD-1)-1:0] row_s, output wire [ROWS*WORD-1:0] row_du, output wire [DIM*WORD-1:0] row_base,
    input wire row_taken, input wire [ROWS-1:0] row_done,
    input wire [ROWS*WORD-1:0] row_k, input wire row_overflow, input wire row_by_zero
);
    assign {busy, done, overflow, by_zero} = $anyseq;
    assign row_start = $anyseq;
    assign k = $anyseq;
    assign u_next = $anyseq;
    assign u_before = $anyseq;
    assign point_before = $anyseq;
    assign row_u_a = $anyseq;
    assign row_u_b = $anyseq;
    assign row_s = $anyseq;
    assign row_du = $anyseq;
    assign row_base = $anyseq;
endmodule

module vt #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire load, input wire [9:0] load_index, input wire [WORD+26:0] load_data,
    input wire start, input wire advance, output wire busy, output wire [WORD-2:0] now,
    output wire [WORD-2:0] half, output wire [WORD-2:0] whole, output wire overflow
);
    assign {busy, overflow} = $anyseq;
    assign now = $anyseq;
    assign half = $anyseq;
    assign whole = $anyseq;
endmodule

module slope #(
    parameter WORD = 35, parameter DIM = 3, parameter MAX_POINTS = 64, parameter RATIONAL = 1, parameter PAIR = 0
) (
    input wire clk, input wire rst, input wire load, input wire [1:0] load_space, input wire [9:0] load_index,
    input wire [WORD+2:0] load_data, input wire start, input wire want_a, input wire want_b, input wire want_k,
    input wire given, input wire [WORD-2:0] u_a, input wire [WORD-2:0] u_b, input wire signed [WORD-1:0] shift,
    input wire shift_half, input wire shift_whole, input wire [WORD-2:0] s, input wire signed [WORD-1:0] du,
    input wire [DIM*WORD-1:0] base, output wire busy, output wire taken, output wire done,
    output wire [DIM*WORD-1:0] point, output wire signed [WORD-1:0] k,
    output wire overflow, output wire by_zero
);
    assign busy = $anyseq;
    assign taken = $anyseq;
    assign done = $anyseq;
    assign point = $anyseq;
    assign k = $anyseq;
    assign overflow = $anyseq;
    assign by_zero = $anyseq;
endmodule
