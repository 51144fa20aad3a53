// SPDX-License-Identifier: MIT
/*
 * slope, with cuk and kout that answer when they like, at any values: what slope_inside.v says holds in runs of any
 * length, for a caller that holds its operands.
 */
module slope_proof #(
    parameter PAIR = 0
) (
    input wire        clk,
    input wire        again,
    input wire        start,
    input wire        want_a,
    input wire        want_b,
    input wire        want_k,
    input wire        given,
    input wire [33:0] base
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire busy, done;
    slope #(.WORD(17), .DIM(2), .PAIR(PAIR)) dut (
        .clk(clk), .rst(!started || again), .load(1'b0), .start(start), .want_a(want_a), .want_b(want_b),
        .want_k(want_k),
        .given(given), .base(base), .busy(busy), .done(done)
    );
endmodule

module cuk #(parameter WORD = 35, parameter DIM = 3, parameter MAX_POINTS = 64, parameter RATIONAL = 1) (
    input wire clk, input wire rst, input wire load, input wire [1:0] load_space, input wire [9:0] load_index,
    input wire [WORD+2:0] load_data, input wire start, input wire [WORD-2:0] u, input wire signed [WORD-1:0] k,
    input wire half, input wire whole, output wire busy, output wire done, output wire [DIM*WORD-1:0] point,
    output wire out_of_range, output wire overflow, output wire by_zero
);
    assign {busy, done, out_of_range, overflow, by_zero} = $anyseq;
    assign point = $anyseq;
endmodule

module kout #(parameter WORD = 35, parameter DIM = 3) (
    input wire clk, input wire rst, input wire start, input wire [WORD-2:0] s, input wire signed [WORD-1:0] du,
    input wire [DIM*WORD-1:0] chord, output wire busy, output wire done, output wire signed [WORD-1:0] k,
    output wire overflow, output wire by_zero
);
    assign {busy, done, overflow, by_zero} = $anyseq;
    assign k = $anyseq;
endmodule
