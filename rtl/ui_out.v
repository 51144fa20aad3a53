// SPDX-License-Identifier: MIT
/*
 * The paper's module ui_out: the next parameter from four slopes.
 *
 * Format    u: WORD - 2 fraction bits, from 0 to 1. k_0 to k_3: WORD bits in two's complement, 8 more fraction bits,
 *           in 24ths of a period: the divisions by 24 and by 6 of Eqs. (17) and (20) are gone.
 *             ADAMS = 1   u + 55 k_0 - 59 k_1 + 37 k_2 - 9 k_3   k_0 the latest slope
 *             ADAMS = 0   u + 4 k_0 + 8 k_1 + 8 k_2 + 4 k_3      Runge-Kutta
 * Rounding  once, to nearest, halves up.
 * Latency   none: the result is registered by the caller.
 * Flags     none: a result beyond the ends is held at 0 or at the largest number, and the caller ends the curve.
 */
`default_nettype none

module ui_out #(
    // Width of a word: odd, 5 to 35.
    parameter integer WORD  = 35,
    // 1: Eq. (17), 0: Eq. (20).
    parameter integer ADAMS = 1
) (
    input  wire        [WORD-2:0] u,
    input  wire signed [WORD-1:0] k_0,
    input  wire signed [WORD-1:0] k_1,
    input  wire signed [WORD-1:0] k_2,
    input  wire signed [WORD-1:0] k_3,
    output wire        [WORD-2:0] u_next
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 35) begin : check_word
        ui_out_WORD_must_be_odd_and_from_5_to_35 stop ();
    end endgenerate

    wire signed [WORD+7:0] a = {{8{k_0[WORD-1]}}, k_0};
    wire signed [WORD+7:0] b = {{8{k_1[WORD-1]}}, k_1};
    wire signed [WORD+7:0] c = {{8{k_2[WORD-1]}}, k_2};
    wire signed [WORD+7:0] d = {{8{k_3[WORD-1]}}, k_3};
    wire signed [WORD+7:0] total;

    generate if (ADAMS != 0) begin : adams
        // 64 a - 9 a - 64 b + 32 c + 5 (b + c) - 9 d: nine adders; the latest slope, which comes late, passes three.
        wire signed [WORD+7:0] b_c   = b + c;
        wire signed [WORD+7:0] older = (((c <<< 5) - (b <<< 6)) + ((b_c <<< 2) + b_c)) - ((d <<< 3) + d);
        assign total = (older + (a <<< 6)) - ((a <<< 3) + a);
    end else begin : runge_kutta
        assign total = (a + d + ((b + c) <<< 1)) <<< 2;
    end endgenerate

    // The half that rounds stands below u.
    wire [WORD+8:0] sum = {2'b00, u, 8'h80} + {total[WORD+7], total};
    assign u_next = sum[WORD+8] ? {WORD-1{1'b0}} : sum[WORD+7] ? {WORD-1{1'b1}} : sum[WORD+6:8];
    wire unused = &{1'b0, sum[7:0]};
endmodule

`default_nettype wire
