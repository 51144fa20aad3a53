// SPDX-License-Identifier: MIT
/*
 * The paper's module cuk: the point C(u + shift), a module cu behind an adder.
 *
 * Format    u: WORD - 2 fraction bits, from 0 to 1. k: a slope, WORD bits in two's complement with 8 more fraction
 *           bits than u, in 24ths of a period; shift = factor * k, with factor 0, 12 (half a period) or 24.
 * Rounding  the shift to nearest, halves up; the sum is kept inside the curve's domain by cu.
 * Latency   from start to done, while u stays in its span: 2 + max(p (p + 1) / 2, 3) + p (p + 1) / 2 + (p + 1) per
 *           coordinate for degree p; with weights (p + 1) for the weight and the first coordinate each, and a
 *           division per coordinate. A change of span costs 3 cycles and 2 for each halving of the spans.
 * Flags     out_of_range: u + shift lay outside the domain, the point is that of the nearer end; a sum below 0 is
 *           taken as 0, which is no flag where the domain begins there. overflow and by_zero: of the division by the
 *           weight. All three are of the latest point.
 *
 * start is sampled while busy is low, and the operands with it; done is high for one cycle for each start, in their
 * order, and the point holds until another is on its way. The load bus is that of cu.
 */
`default_nettype none

module cuk #(
    // Width of a coordinate: odd, 17 to 35.
    parameter integer WORD       = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM        = 3,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL   = 1
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   load,
    input  wire [1:0]             load_space,
    input  wire [9:0]             load_index,
    input  wire [WORD+2:0]        load_data,
    input  wire                   start,
    input  wire [WORD-2:0]        u,
    input  wire signed [WORD-1:0] k,
    input  wire                   half,  // factor 12
    input  wire                   whole, // factor 24
    output wire                   busy,
    output wire                   done,
    output wire [DIM*WORD-1:0]    point,
    output wire                   out_of_range,
    output wire                   overflow,
    output wire                   by_zero
);
    wire signed [WORD+5:0] k_wide = {{6{k[WORD-1]}}, k};
    wire signed [WORD+5:0] twelve = (k_wide <<< 3) + (k_wide <<< 2);
    wire signed [WORD+5:0] scaled = whole ? twelve <<< 1 : half ? twelve : {WORD+6{1'b0}};
    // The half that rounds stands below u. Below 0 and beyond the widest u, cu takes the end of the domain.
    wire        [WORD+8:0] sum    = {2'b00, u, 8'h80} + {{3{scaled[WORD+5]}}, scaled};
    wire        [WORD-2:0] moved  = sum[WORD+8] ? {WORD-1{1'b0}} : sum[WORD+7] ? {WORD-1{1'b1}} : sum[WORD+6:8];

    cu #(.WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL)) cu_inst (
        .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index), .load_data(load_data),
        .start(start), .u(moved), .busy(busy), .done(done), .point(point), .out_of_range(out_of_range),
        .overflow(overflow), .by_zero(by_zero)
    );

    wire unused = &{1'b0, sum[7:0]};
endmodule

`default_nettype wire
