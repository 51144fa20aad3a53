/*
 * stepper, with anything at all in place of its arithmetic: a point that is offered holds still until it is taken,
 * none is offered twice or dropped, exactly one of a run is the last, and done comes once, after it.
 */
module stepper_proof #(
    parameter WORD = 17
) (
    input wire             clk,
    input wire             load,
    input wire [2:0]       load_space,
    input wire [9:0]       load_index,
    input wire [WORD+14:0] load_data,
    input wire             go,
    input wire             ready
);
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 3) age <= age + 1;
    wire rst = age == 0;

    wire              busy, done, valid, last;
    wire [WORD-2:0]   u;
    wire [2*WORD-1:0] point;
    stepper #(.WORD(WORD), .DIM(2), .RATIONAL(0)) dut (
        .clk(clk), .rst(rst), .load(load && !busy), .load_space(load_space), .load_index(load_index),
        .load_data(load_data), .go(go), .busy(busy), .done(done), .valid(valid), .ready(ready), .u_out(u),
        .point_out(point), .last(last)
    );

    reg              waits = 0, running = 0, ended = 0;
    reg [3*WORD-1:0] was;
    always @(posedge clk) if (!rst) begin
        waits   <= valid && !ready;
        was     <= {last, u, point};
        running <= busy;
        if (go && !busy) ended <= 0;
        else if (valid && ready && last) ended <= 1;
    end
    always @* if (!rst) begin
        assert (!(busy && done));
        if (waits) assert (valid && {last, u, point} == was);
        if (done) assert (ended && running && !valid);
        if (ended && busy) assert (!valid);
        if (valid) assert (busy);
    end
endmodule

/* Stand-ins: each answers when and what it likes, even unasked. */

module vt #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire load, input wire [2:0] load_index, input wire [WORD+14:0] load_data,
    input wire start, input wire advance, output wire busy, output wire [WORD-2:0] now,
    output wire [WORD-2:0] half, output wire [WORD-2:0] whole
);
    assign busy = $anyseq;
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
