/*
 * Signed divider: restoring, two quotient bits a clock.
 *
 * Format    quotient = numerator / denominator. The numerator has 2 * WORD bits in two's complement, the
 *           denominator WORD bits without sign, the quotient WORD bits in two's complement. Binary points are the
 *           caller's: fraction bits of the quotient = those of the numerator - those of the denominator.
 * Rounding  to nearest, halves away from zero; the error is at most half a unit in the last place.
 * Latency   (WORD - 1) / 2 + 2 clocks from start to done, whatever the operands.
 * Flags     by_zero: the denominator is 0; overflow: the quotient does not fit. Either way the quotient is the
 *           largest one of the numerator's sign. Both hold until the next start.
 *
 * start is heeded while busy is low; operands are read with it. done is high for one clock, never with busy.
 */
`default_nettype none

module divide #(
    // Width of quotient and denominator: odd, 5 to 63.
    parameter WORD = 35
) (
    input  wire                     clk,
    input  wire                     rst,
    input  wire                     start,
    input  wire signed [2*WORD-1:0] numerator,
    input  wire        [WORD-1:0]   denominator,
    output reg                      busy,
    output reg                      done,
    output reg  signed [WORD-1:0]   quotient,
    output reg                      overflow,
    output reg                      by_zero
);
    localparam BITS = WORD - 1; // of the quotient's magnitude
    localparam [31:0] ROUNDS = BITS / 2;

    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check
        divide_WORD_must_be_odd_and_from_5_to_63 stop ();
    end endgenerate

    wire [2*WORD-1:0] magnitude = numerator[2*WORD-1] ? -numerator : numerator;

    reg            negative;
    reg [5:0]      rounds;    // rounds of two bits still to do
    reg [WORD-1:0] divisor;
    reg [WORD-1:0] remainder; // below the divisor, unless a flag is up
    reg [BITS-1:0] digits;    // the numerator's low bits leave at the top, the quotient's enter at the bottom

    // Two restoring steps. A rest is below the divisor, so its top bit need not be kept.
    wire [WORD:0]   first_trial  = {remainder, digits[BITS-1]};
    wire            first_bit    = first_trial >= {1'b0, divisor};
    wire [WORD-1:0] first_rest   = first_trial[WORD-1:0] - (first_bit ? divisor : {WORD{1'b0}});
    wire [WORD:0]   second_trial = {first_rest, digits[BITS-2]};
    wire            second_bit   = second_trial >= {1'b0, divisor};
    wire [WORD-1:0] second_rest  = second_trial[WORD-1:0] - (second_bit ? divisor : {WORD{1'b0}});

    // The half is added to the magnitude, the sign comes last.
    wire            round_up     = {remainder, 1'b0} >= {1'b0, divisor};
    wire [BITS:0]   rounded      = {1'b0, digits} + {{BITS{1'b0}}, round_up};
    wire            too_big      = overflow | by_zero | rounded[BITS];
    wire [WORD-1:0] value        = too_big ? {1'b0, {BITS{1'b1}}} : rounded;

    always @(posedge clk) begin
        done <= 1'b0;
        if (!busy) begin
            if (start) begin
                busy      <= 1'b1;
                rounds    <= ROUNDS[5:0];
                negative  <= numerator[2*WORD-1];
                divisor   <= denominator;
                remainder <= magnitude[BITS+:WORD];
                digits    <= magnitude[BITS-1:0];
                by_zero   <= denominator == {WORD{1'b0}};
                overflow  <= denominator != {WORD{1'b0}} && magnitude[2*WORD-1:BITS] >= {1'b0, denominator};
            end
        end else if (rounds != 6'd0) begin
            rounds    <= rounds - 6'd1;
            remainder <= second_rest;
            digits    <= {digits[BITS-3:0], first_bit, second_bit};
        end else begin
            busy     <= 1'b0;
            done     <= 1'b1;
            overflow <= too_big & ~by_zero;
            quotient <= negative ? -value : value;
        end
        if (rst) begin
            busy <= 1'b0;
            done <= 1'b0;
        end
    end
endmodule

`default_nettype wire
