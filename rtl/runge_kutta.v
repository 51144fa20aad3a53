// SPDX-License-Identifier: MIT
/*
 * The paper's Runge-Kutta module (Fig. 5): the next u by Eq. (20), both ends of each quotient shifted.
 *
 * Four orders to one row (slope.v), one after the other: at u, at u shifted by half a period of K1 and of K2, at u
 * shifted by a whole period of K3. In the first step there is no point before: the exact end derivative, loaded as a
 * chord and its du, stands for every quotient, and C(u) alone is evaluated.
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction. Points: WORD bits an axis in two's complement.
 *           s: the distance of a period over 24, WORD - 1 bits without sign, 8 more fraction bits than a coordinate.
 *           K: WORD bits in two's complement, 8 more fraction bits than u: what u moves in 1/24 of a period.
 * Rounding  the next u once, to nearest, halves up; it is kept between the ends of the knot range.
 * Latency   four orders and 5 cycles.
 * Flags     the row's, gathered over the step.
 *
 * start is sampled while busy is low; the caller holds the operands until done, which is high for one cycle. Before
 * that, once, point_done tells that the row's point is C(u).
 */
`default_nettype none

module runge_kutta #(
    // Width of a coordinate: odd, 5 to 35.
    parameter integer WORD   = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM    = 3,
    // 1: the point before is at hand, K1 evaluates one point instead of two.
    parameter integer CACHED = 1
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   start,
    input  wire                   first,
    input  wire [WORD-2:0]        u,
    input  wire [WORD-2:0]        u_before,
    input  wire [DIM*WORD-1:0]    point_before,
    input  wire [WORD-2:0]        s_now,
    input  wire [WORD-2:0]        s_half,
    input  wire [WORD-2:0]        s_whole,
    input  wire [WORD-2:0]        first_du,
    input  wire [WORD-2:0]        first_chord,
    output wire                   busy,
    output reg                    done,
    output wire                   point_done,
    output reg  signed [WORD-1:0] k,
    output reg  [WORD-2:0]        u_next,
    output reg                    overflow,
    output reg                    by_zero,
    // To the row.
    output reg                    row_start,
    output wire                   row_want_a,
    output wire                   row_want_b,
    output wire                   row_given,
    output wire                   row_half,
    output wire                   row_whole,
    output wire [WORD-2:0]        row_s,
    output wire signed [WORD-1:0] row_du,
    output wire [DIM*WORD-1:0]    row_base,
    output reg signed [WORD-1:0]  row_shift,
    // From the row.
    input  wire                   row_done,
    input  wire signed [WORD-1:0] row_k,
    input  wire                   row_overflow,
    input  wire                   row_by_zero
);
    generate if (DIM != 2 && DIM != 3) begin : check_dim
        runge_kutta_DIM_must_be_2_or_3 stop ();
    end endgenerate

    reg       working;
    reg [1:0] stage;
    assign busy       = working;
    assign point_done = working && row_done && stage == 2'd0;

    assign row_want_a = stage == 2'd0 || !first;
    assign row_want_b = !first && !(CACHED != 0 && stage == 2'd0);
    assign row_given  = first;
    assign row_half   = stage == 2'd1 || stage == 2'd2;
    assign row_whole  = stage == 2'd3;
    assign row_s      = stage == 2'd0 ? s_now : stage == 2'd3 ? s_whole : s_half;
    assign row_du     = first ? {1'b0, first_du} : {1'b0, u} - {1'b0, u_before};
    assign row_base   = first ? {{(DIM-1)*WORD+1{1'b0}}, first_chord} : point_before;

    reg signed [WORD-1:0] k_2; // row_shift is the latest slope
    wire [WORD-2:0] sum;
    ui_out #(.WORD(WORD), .ADAMS(0)) ui_out_inst (
        .u(u), .k_0(k), .k_1(k_2), .k_2(row_shift), .k_3(row_k), .u_next(sum)
    );

    always @(posedge clk) begin
        done      <= 1'b0;
        row_start <= 1'b0;
        if (!working && start) begin
            working   <= 1'b1;
            stage     <= 2'd0;
            row_start <= 1'b1;
            overflow  <= 1'b0;
            by_zero   <= 1'b0;
        end
        if (working && row_done) begin
            stage     <= stage + 2'd1;
            overflow  <= overflow | row_overflow;
            by_zero   <= by_zero | row_by_zero;
            row_shift <= row_k;
            if (stage == 2'd0) k <= row_k;
            if (stage == 2'd1) k_2 <= row_k;
            if (stage == 2'd3) u_next <= sum;
            row_start <= stage != 2'd3;
            working   <= stage != 2'd3;
            done      <= stage == 2'd3;
        end
        if (rst) begin
            working   <= 1'b0;
            done      <= 1'b0;
            row_start <= 1'b0;
        end
    end
endmodule

`default_nettype wire
