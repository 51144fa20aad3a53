// SPDX-License-Identifier: MIT
/* divide: the lemma of one round, for any numbers of the width that is built. */
module divide_round_proof #(
    parameter WORD = 35
) (
    input wire                     clk,
    input wire                     rst,
    input wire                     start,
    input wire signed [2*WORD-1:0] numerator,
    input wire        [WORD-1:0]   denominator
);
    wire                   busy, done, overflow, by_zero;
    wire signed [WORD-1:0] quotient;
    divide #(.WORD(WORD)) dut (
        .clk(clk), .rst(rst), .start(start), .numerator(numerator), .denominator(denominator), .busy(busy),
        .done(done),
        .quotient(quotient), .overflow(overflow), .by_zero(by_zero)
    );
endmodule
