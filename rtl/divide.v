// SPDX-License-Identifier: MIT
/*
 * Signed divider: restoring, four quotient bits a cycle.
 *
 * Format    quotient = numerator / denominator. The numerator has 2 * WORD bits in two's complement, the
 *           denominator WORD bits without sign, the quotient WORD bits in two's complement. Binary points are the
 *           caller's: fraction bits of the quotient = those of the numerator - those of the denominator.
 * Rounding  to nearest, halves away from zero; the error is at most 0.5 ulp.
 * Latency   WORD / 4, rounded up, and 1 cycle from start to done, whatever the operands.
 * Flags     by_zero: the denominator is 0; overflow: its size is 2^(WORD-1) or more. Either way the quotient is the
 *           largest one of the numerator's sign. All results hold from done until the next start.
 *
 * start is sampled while busy is low; operands are read with it. done is high for one cycle, never with busy.
 */
`default_nettype none

module divide #(
    // Width of quotient and denominator: odd, 5 to 63.
    parameter integer WORD = 35
) (
    input  wire                     clk,
    input  wire                     rst,
    input  wire                     start,
    input  wire signed [2*WORD-1:0] numerator,
    input  wire        [WORD-1:0]   denominator,
    output reg                      busy,
    output reg                      done,
    output wire signed [WORD-1:0]   quotient,
    output wire                     overflow,
    output reg                      by_zero
);
    localparam BITS = WORD - 1; // of the quotient's magnitude; one more decides the rounding
    localparam [31:0] ROUNDS = (WORD + 3) / 4;
    localparam DIGITS = 4 * ((WORD + 3) / 4);

    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check
        divide_WORD_must_be_odd_and_from_5_to_63 stop ();
    end endgenerate

    wire [2*WORD-1:0] magnitude = numerator[2*WORD-1] ? -numerator : numerator;
    wire [2*WORD+2:0] aligned   = {2'b00, magnitude, 1'b0};

    reg              negative;
    reg [4:0]        rounds;    // still to do after this one
    reg              too_large; // at the start
    reg [WORD-1:0]   divisor;
    reg [WORD-1:0]   remainder; // below the divisor, unless a flag is up
    reg [DIGITS-1:0] digits;    // the numerator's low bits leave at the top, the quotient's enter at the bottom

    // Four restoring steps: what is left after a subtraction stands if it is not negative.
    wire [WORD-1:0] rest [0:4];
    wire [3:0]      bits;
    assign rest[0] = remainder;
    genvar i;
    generate for (i = 0; i < 4; i = i + 1) begin : digit
        wire [WORD:0] trial = {rest[i], digits[DIGITS-1-i]};
        wire [WORD:0] less  = trial - {1'b0, divisor};
        assign bits[3-i]    = !less[WORD];
        assign rest[i+1]    = less[WORD] ? trial[WORD-1:0] : less[WORD-1:0];
    end endgenerate

    // The digits rounded, with their sign: the negative of d + half is ~d + 1 - half.
    wire [BITS-1:0] whole = digits[WORD-1:1];
    wire [WORD-1:0] value = {negative, whole ^ {BITS{negative}}} + {{BITS{1'b0}}, digits[0] ^ negative};
    wire            held  = too_large || by_zero || &digits[WORD-1:0]; // rounds up beyond the largest
    assign overflow = held && !by_zero;
    assign quotient = held ? {negative, {BITS-1{!negative}}, 1'b1} : value;

    always @(posedge clk) begin
        done <= 1'b0;
        if (!busy) begin
            if (start) begin
                busy      <= 1'b1;
                rounds    <= ROUNDS[4:0] - 5'd1;
                negative  <= numerator[2*WORD-1];
                divisor   <= denominator;
                remainder <= aligned[DIGITS+:WORD];
                digits    <= aligned[DIGITS-1:0];
                by_zero   <= denominator == {WORD{1'b0}};
                too_large <= denominator != {WORD{1'b0}} && magnitude[2*WORD-1:BITS] >= {1'b0, denominator};
            end
        end else begin
            rounds    <= rounds - 5'd1;
            remainder <= rest[4];
            digits    <= {digits[DIGITS-5:0], bits};
            busy      <= rounds != 5'd0;
            done      <= rounds == 5'd0;
        end
        if (rst) begin
            busy <= 1'b0;
            done <= 1'b0;
        end
    end

    wire unused = &{1'b0, aligned};
endmodule

`default_nettype wire
