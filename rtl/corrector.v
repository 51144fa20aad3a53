// SPDX-License-Identifier: MIT
/*
 * The chord corrector: a predicted u is moved so that the chord of the step is as long as commanded.
 *
 * Each trial evaluates C at the present guess and takes the straight line through no step and this one:
 *   u + (guess - u) * s / |C(guess) - C(u)|,   s = (s_now + 4 s_half + s_whole) / 6
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction. s: distances of a period over 24, WORD - 1 bits
 *           without sign, 8 more fraction bits than a coordinate. K: WORD bits in two's complement, 8 more fraction
 *           bits than u. trials: from 0 (the guess is left alone) to 7.
 * Rounding  once a trial, to nearest, halves up.
 * Latency   2 cycles, and one order of one point and 3 cycles for each trial.
 * Flags     the row's, and overflow if the sum of the speeds does not fit.
 *
 * start is sampled while busy is low; the caller holds the operands until done, which is high for one cycle.
 */
`default_nettype none

module corrector #(
    // Width of a coordinate: odd, 5 to 35.
    parameter WORD = 35
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   start,
    input  wire [2:0]             trials,
    input  wire [WORD-2:0]        u,
    input  wire [WORD-2:0]        last_u,
    input  wire [WORD-2:0]        predicted,
    input  wire [WORD-2:0]        s_now,
    input  wire [WORD-2:0]        s_half,
    input  wire [WORD-2:0]        s_whole,
    output wire                   busy,
    output reg                    done,
    output reg  [WORD-2:0]        guess,
    output reg                    overflow,
    output reg                    by_zero,
    // To the row, which evaluates C(guess) and takes the chord from C(u).
    output reg                    row_start,
    output wire [WORD-2:0]        row_s,
    output wire signed [WORD-1:0] row_du,
    // From the row.
    input  wire                   row_done,
    input  wire signed [WORD-1:0] row_k,
    input  wire                   row_overflow,
    input  wire                   row_by_zero
);
    reg       working;
    reg [2:0] left; // trials
    assign busy = working;

    wire [WORD+1:0] speeds = {3'b000, s_now} + {1'b0, s_half, 2'b00} + {3'b000, s_whole};
    assign row_s  = speeds[WORD-2:0];
    assign row_du = {1'b0, guess} - {1'b0, u};

    // ui_out's Runge-Kutta sum of one slope: u + 4 k, as s has six times the sixth that it stands for.
    wire [WORD-2:0] corrected;
    ui_out #(.WORD(WORD), .ADAMS(0)) ui_out_inst (
        .u(u), .k_0(row_k), .k_1({WORD{1'b0}}), .k_2({WORD{1'b0}}), .k_3({WORD{1'b0}}), .u_next(corrected)
    );

    // The guess is registered first and judged in the cycle after: two additions and a comparison would be one too
    // many.
    reg  judging;
    // At the end of the curve, and where the tool rests, there is nothing to correct.
    wire settled = left == 3'd0 || guess >= last_u || guess <= u;

    always @(posedge clk) begin
        done      <= 1'b0;
        row_start <= 1'b0;
        judging   <= working ? row_done : start;
        if (working ? row_done : start) begin
            working  <= 1'b1;
            guess    <= working ? corrected : predicted;
            left     <= working ? left - 3'd1 : trials;
            overflow <= working && (overflow || row_overflow || |speeds[WORD+1:WORD-1]);
            by_zero  <= working && (by_zero || row_by_zero);
        end
        if (judging) begin
            working   <= !settled;
            row_start <= !settled;
            done      <= settled;
        end
        if (rst) begin
            working   <= 1'b0;
            judging   <= 1'b0;
            done      <= 1'b0;
            row_start <= 1'b0;
        end
    end
endmodule

`default_nettype wire
