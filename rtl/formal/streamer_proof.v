// SPDX-License-Identifier: MIT
/*
 * streamer, with anything at all in place of its arithmetic, its tables and its limits: a beat that is offered holds
 * still until it is taken; no run begins with a write or a close; exactly one beat of a run is the last, done comes
 * once, after it; no point leaves that raised a flag, or that was not compared for two cycles as it is; a void beat
 * repeats the point before; each distance is moved once, in its turn, and none is taken after the last; outputs are
 * those loaded with the piece of the beat. In runs of any length.
 */
module streamer_proof #(
    parameter AHEAD = 0
) (
    input wire       clk,
    input wire       again,
    input wire       go,
    input wire       stop,
    input wire       load,
    input wire       close,
    input wire [8:0] rate,
    input wire       ready
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    streamer #(.WORD(25), .DIM(2), .AHEAD(AHEAD)) dut (
        .clk(clk), .rst(!started || again), .load(load), .load_space(3'd0), .load_index(10'd0), .load_data(64'd0),
        .go(go), .stop(stop), .rate(rate), .ready(ready), .close(close)
    );
endmodule

/* Stand-ins: each answers what it likes. */

module banks #(parameter WORD = 35, parameter DIM = 3) (
    input wire clk, input wire rst, input wire load, input wire [2:0] load_space, input wire [9:0] load_index,
    input wire [63:0] load_data, input wire close, input wire bound_beyond, input wire busy, input wire begins,
    input wire done, input wire period_taken, input wire point_bank, input wire feed_bank, input wire [8:0] metric_at,
    output wire [WORD-1:0] metric, input wire [8:0] root_at, output wire [WORD-1:0] root, input wire [5:0] length_at,
    output wire [63:0] length, input wire [9:0] coefficient_at, output wire [WORD-1:0] coefficient,
    output wire [1:0] cubic, output wire [9:0] last_piece, output wire [13:0] last_record,
    output wire [1:0] final_bank,
    output wire [DIM*WORD-1:0] end_point, output wire writable, output wire [1:0] closed, output wire outside,
    output wire starved
);
    wire [WORD-11:0] top = $anyseq;
    wire [9:0]       low = $anyseq;
    reg  [8:0]       at;
    always @(posedge clk) at <= root_at; // the outputs of a piece are some function of it
    assign root = {top, at[2:0] == 7 ? at[6:3] ^ {2{at[8:7]}} : low[9:6], low[5:0]};
    assign {metric, length, coefficient, end_point} = $anyseq;
    assign {cubic, last_piece, last_record, final_bank, writable, closed, outside, starved} = $anyseq;
endmodule

module feed_table #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire load, input wire [9:0] load_index, input wire [WORD+26:0] load_data,
    input wire [13:0] last_record, input wire [1:0] closed, input wire [1:0] final_bank, input wire start,
    input wire take, output wire valid, output wire [WORD+26:0] distance, output wire is_last, output wire bank
);
    assign {valid, distance, is_last, bank} = $anyseq;
endmodule

module feed_override #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire load, input wire [3:0] load_index, input wire [63:0] load_data,
    input wire start, input wire may, input wire [8:0] rate, input wire stopping, output wire sampled,
    output wire resting, input wire in_valid, input wire [WORD+26:0] in_distance, input wire in_last,
    output wire in_take, output wire valid, output wire [WORD+26:0] distance, output wire is_last, output wire cut,
    input wire take
);
    assign {sampled, resting, in_take, valid, distance, is_last, cut} = $anyseq;
endmodule

module exact_step #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire start, input wire cubic, input wire [WORD+11:0] t,
    input wire [WORD-2:0] y, input wire [WORD-2:0] ds, input wire [5:0] shift, output wire [2:0] coefficient,
    input wire [WORD-1:0] metric, output wire busy, output wire done, output wire [WORD+11:0] t_next,
    output wire [WORD-2:0] y_next, output wire unsettled
);
    reg  working = 0, finished = 0;
    wire now = $anyseq;
    always @(posedge clk) {working, finished} <= rst ? 2'b00 : {working ? !now : start, working && now};
    assign {busy, done} = {working, finished};
    assign {coefficient, t_next, y_next, unsettled} = $anyseq;
endmodule

module horner #(parameter WORD = 35, parameter DIM = 3) (
    input wire clk, input wire clear, input wire run, input wire [WORD-2:0] t, output wire [3:0] asks_for,
    input wire [WORD-1:0] coefficient, output wire ends, output reg pending, input wire jump,
    input wire [DIM*WORD-1:0] target, output reg [DIM*WORD-1:0] point
);
    assign {asks_for, ends} = $anyseq;
    wire [DIM*WORD-1:0] other = $anyseq;
    always @(posedge clk) begin
        pending <= run;
        if (pending) point <= other;
        if (jump) point <= target;
    end
endmodule

module soft_limits #(parameter WORD = 35, parameter DIM = 3) (
    input wire clk, input wire load, input wire [3:0] load_index, input wire [WORD-1:0] load_data,
    input wire [2:0] bound, output wire bound_beyond, input wire [DIM*WORD-1:0] point,
    input wire [DIM*WORD-1:0] point_before, output wire too_far, output wire beyond
);
    assign {bound_beyond, too_far, beyond} = $anyseq;
endmodule
