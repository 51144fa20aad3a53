/*
 * Signed multiplier, built of four 18 x 18 blocks.
 *
 * Format    a, b: WORD bits, two's complement; product: 2 * WORD bits, exact.
 * Rounding  none.
 * Latency   3 cycles (operands, partial products, sum); a new pair may enter at every cycle.
 * Flags     none: the product always fits.
 *
 * Each operand is split as high * 2^LOW + low. With WORD = 35 the high part is 18 bits signed and the low part
 * 17 bits unsigned, so that every partial product is one 18 x 18 signed block of the chip.
 */
`default_nettype none

module multiply #(
    // Width of an operand: odd, 9 to 35.
    parameter WORD = 35
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
    end endgenerate

    reg signed [WORD-1:0] a_reg, b_reg;
    wire signed [HIGH-1:0] a_high = a_reg[WORD-1:LOW];
    wire signed [HIGH-1:0] b_high = b_reg[WORD-1:LOW];
    wire signed [HIGH-1:0] a_low  = {1'b0, a_reg[LOW-1:0]};
    wire signed [HIGH-1:0] b_low  = {1'b0, b_reg[LOW-1:0]};

    reg signed [2*HIGH-1:0] high_high, high_low, low_high, low_low;
    wire signed [2*HIGH:0] middle = high_low + low_high;

    always @(posedge clk) begin
        a_reg     <= a;
        b_reg     <= b;
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
