// SPDX-License-Identifier: MIT
/*
 * Twelve times the slope of five equally spaced samples at the newest, to fourth order.
 *
 * Format    x_0 (newest) to x_4, difference: WORD bits in two's complement, one binary point.
 * Rounding  none.
 * Latency   none: combinational.
 * Flags     overflow: the difference does not fit a word.
 */
`default_nettype none

module differences #(
    // Width of a word: odd, 5 to 35.
    parameter WORD = 35
) (
    input  wire signed [WORD-1:0] x_0,
    input  wire signed [WORD-1:0] x_1,
    input  wire signed [WORD-1:0] x_2,
    input  wire signed [WORD-1:0] x_3,
    input  wire signed [WORD-1:0] x_4,
    output wire signed [WORD-1:0] difference,
    output wire                   overflow
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 35) begin : check_word
        differences_WORD_must_be_odd_and_from_5_to_35 stop ();
    end endgenerate

    // The factors 25, -48, 36, -16, 3 add up to nothing, their sizes to 128.
    wire signed [WORD+6:0] a = {{7{x_0[WORD-1]}}, x_0};
    wire signed [WORD+6:0] b = {{7{x_1[WORD-1]}}, x_1};
    wire signed [WORD+6:0] c = {{7{x_2[WORD-1]}}, x_2};
    wire signed [WORD+6:0] d = {{7{x_3[WORD-1]}}, x_3};
    wire signed [WORD+6:0] e = {{7{x_4[WORD-1]}}, x_4};
    wire signed [WORD+6:0] sum = ((a <<< 4) + (a <<< 3) + a) - ((b <<< 5) + (b <<< 4))
                               + ((c <<< 5) + (c <<< 2)) - (d <<< 4) + ((e <<< 1) + e);

    assign difference = sum[WORD-1:0];
    assign overflow   = sum[WORD+6:WORD-1] != {8{sum[WORD-1]}};
endmodule

`default_nettype wire
