// SPDX-License-Identifier: MIT
/*
 * cu, for any curve, any products and any loader that leaves a curve in use alone: what cu_inside.v says holds in
 * runs of any length. So slope, which relies on the order of the answers (slope_inside.v), may do so.
 */
module cu_proof #(
    parameter DIM      = 3,
    parameter RATIONAL = 1
) (
    input wire        clk,
    input wire        again,
    input wire        load,
    input wire [1:0]  load_space,
    input wire [9:0]  load_index,
    input wire [19:0] load_data,
    input wire        start,
    input wire [15:0] u
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    cu #(.WORD(17), .DIM(DIM), .MAX_POINTS(4), .RATIONAL(RATIONAL)) dut (
        .clk(clk), .rst(!started || again), .load(load), .load_space(load_space), .load_index(load_index),
        .load_data(load_data), .start(start), .u(u)
    );
endmodule

module multiply #(parameter WORD = 35, parameter LATENCY = 2) (
    input wire clk, input wire signed [WORD-1:0] a, input wire signed [WORD-1:0] b, output wire [2*WORD-1:0] product
);
    assign product = $anyseq;
endmodule

/* In place of divide: any quotient, after one cycle; it holds until the next start. */
module divide #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire start, input wire signed [2*WORD-1:0] numerator,
    input wire [WORD-1:0] denominator, output reg busy, output reg done, output reg signed [WORD-1:0] quotient,
    output reg overflow, output reg by_zero
);
    wire [WORD+1:0] any = $anyseq;
    initial {busy, done} = 0;
    always @(posedge clk) begin
        busy <= !rst && start && !busy;
        done <= !rst && busy;
        if (busy) {quotient, overflow, by_zero} <= any;
    end
endmodule
