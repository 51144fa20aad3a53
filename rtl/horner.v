// SPDX-License-Identifier: MIT
/*
 * The point of a polynomial piece, by Horner's scheme: every axis in its turn, a level in three cycles, as long as a
 * product takes, all with one multiplier.
 *
 * Format    t: WORD - 1 fraction bits, from 0, less than 1. coefficients, point: WORD bits in two's complement, one
 *           binary point; all sums have to fit. asks_for: {axis, power}.
 * Rounding  products to nearest, halves up, each of which t brings on: at most (1 + t + t^2) / 2 in the last bit, so
 *           below 1.5 for degree 3, below 1 for degree 2.
 * Latency   9 + DIM cycles of run, then the last axis is stored with pending.
 * Flags     none.
 *
 * clear goes back to the first axis of the highest level. While run is high each cycle asks for a coefficient, which
 * is to be on coefficient in the next one; ends marks the last. jump puts there the given point instead.
 */
`default_nettype none

module horner #(
    // Width of a word: odd, 9 to 35.
    parameter integer WORD = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM  = 3
) (
    input  wire                   clk,
    input  wire                   clear,
    input  wire                   run,
    input  wire [WORD-2:0]        t,
    output wire [3:0]             asks_for,
    input  wire signed [WORD-1:0] coefficient,
    output wire                   ends,
    output reg                    pending,
    input  wire                   jump,
    input  wire [DIM*WORD-1:0]    target,
    output reg  [DIM*WORD-1:0]    point
);
    generate if (DIM != 2 && DIM != 3) begin : check_dim
        horner_DIM_must_be_2_or_3 stop ();
    end endgenerate

    localparam [1:0] LAST_AXIS = DIM == 3 ? 2'd2 : 2'd1;

    reg  [1:0]               axis, level, axis_q, level_q; // of what is asked for, and of what is there
    wire signed [2*WORD-1:0] product;
    wire signed [2*WORD-1:0] rounded = product + {{WORD+1{1'b0}}, 1'b1, {WORD-2{1'b0}}};
    wire signed [WORD-1:0]   value   = coefficient + (level_q == 2'd0 ? {WORD{1'b0}} : rounded[WORD-1+:WORD]);
    multiply #(.WORD(WORD)) multiply_inst (.clk(clk), .a(value), .b({1'b0, t}), .product(product));
    assign asks_for = {axis, 2'd3 - level};
    assign ends     = level == 2'd3 && axis == LAST_AXIS;

    always @(posedge clk) begin
        pending           <= run;
        {level_q, axis_q} <= {level, axis};
        if (run) begin
            axis <= axis == 2'd2 ? 2'd0 : axis + 2'd1;
            if (axis == 2'd2) level <= level + 2'd1;
        end
        if (clear) {level, axis} <= 4'd0;
    end
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : axis_of
        localparam [1:0] AXIS = i;
        always @(posedge clk) begin
            if (pending && level_q == 2'd3 && axis_q == AXIS) point[i*WORD+:WORD] <= value;
            if (jump) point[i*WORD+:WORD] <= target[i*WORD+:WORD];
        end
    end endgenerate

    wire unused = &{1'b0, rounded};
endmodule

`default_nettype wire
