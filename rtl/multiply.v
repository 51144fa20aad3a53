// SPDX-License-Identifier: MIT
/*
 * Signed multiplier, built of four 18 x 18 blocks.
 *
 * Format    a, b: WORD bits, two's complement; product: 2 * WORD bits, exact.
 * Rounding  none.
 * Latency   LATENCY cycles: 2 (partial products, sum), or 3 with operands registered before; a new pair may enter at
 *           every cycle.
 * Flags     none: the product always fits.
 *
 * Each operand is split as high * 2^LOW + low. With WORD = 35 the high part is 18 bits signed and the low part
 * 17 bits unsigned, so that every partial product is one 18 x 18 signed block of the chip.
 */
`default_nettype none

module multiply #(
    // Width of an operand: odd, 9 to 35.
    parameter integer WORD    = 35,
    // 2 or 3.
    parameter integer LATENCY = 3
) (
    input  wire                       clk,
    input  wire signed [WORD-1:0]     a,
    input  wire signed [WORD-1:0]     b,
    output reg  signed [2*WORD-1:0]   product
);
    localparam LOW  = (WORD - 1) / 2;
    localparam HIGH = WORD - LOW;

    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check
        multiply_WORD_must_be_odd_and_from_9_to_35 stop ();
    end
    if (LATENCY != 2 && LATENCY != 3) begin : check_latency
        multiply_LATENCY_must_be_2_or_3 stop ();
    end endgenerate

    wire signed [WORD-1:0] a_in, b_in;
    generate if (LATENCY == 3) begin : operands
        reg signed [WORD-1:0] a_reg, b_reg;
        always @(posedge clk) {a_reg, b_reg} <= {a, b};
        assign {a_in, b_in} = {a_reg, b_reg};
    end else begin : straight
        assign {a_in, b_in} = {a, b};
    end endgenerate
    wire signed [HIGH-1:0] a_high = a_in[WORD-1:LOW];
    wire signed [HIGH-1:0] b_high = b_in[WORD-1:LOW];
    wire signed [HIGH-1:0] a_low  = {1'b0, a_in[LOW-1:0]};
    wire signed [HIGH-1:0] b_low  = {1'b0, b_in[LOW-1:0]};

    reg signed [2*HIGH-1:0] high_high, high_low, low_high, low_low;
    wire signed [2*HIGH:0] middle = high_low + low_high;

    always @(posedge clk) begin
        high_high <= a_high * b_high;
        high_low  <= a_high * b_low;
        low_high  <= a_low * b_high;
        low_low   <= a_low * b_low;
        // The outer partial products do not overlap, and the lowest bits are those of low_low.
        product   <= {{high_high, low_low[2*LOW-1:LOW]} + {{LOW-1{middle[2*HIGH]}}, middle}, low_low[LOW-1:0]};
    end

    wire unused = &{1'b0, low_low[2*HIGH-1:2*LOW]};
endmodule

`default_nettype wire
