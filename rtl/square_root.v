/*
 * Square root: restoring, two bits of the root a clock.
 *
 * Format    radicand: 2 * WORD bits without sign; root: WORD + 1 bits without sign. An even number of fraction bits
 *           of the radicand gives half as many of the root.
 * Rounding  to nearest (a tie cannot occur); the error is below half a unit in the last place. The extra top bit is
 *           set only where the root rounds up to 2^WORD.
 * Latency   (WORD + 1) / 2 + 2 clocks from start to done, whatever the radicand.
 * Flags     none: every radicand has a root.
 *
 * start is heeded while busy is low; the radicand is read with it. done is high for one clock, never with busy.
 */
`default_nettype none

module square_root #(
    // Half the width of the radicand: odd, 5 to 63.
    parameter WORD = 35
) (
    input  wire              clk,
    input  wire              rst,
    input  wire              start,
    input  wire [2*WORD-1:0] radicand,
    output reg               busy,
    output reg               done,
    output reg  [WORD:0]     root
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check
        square_root_WORD_must_be_odd_and_from_5_to_63 stop ();
    end endgenerate

    localparam [31:0] ROUNDS = (WORD + 1) / 2;
    reg [5:0]        rounds;    // rounds of two bits still to do
    reg [2*WORD+1:0] digits;    // pairs of the radicand not yet used, at the top
    reg [WORD+1:0]   remainder; // radicand so far - partial^2, at most 2 * partial
    reg [WORD:0]     partial;   // bits of the root found so far

    // One step brings down two bits of the radicand and tries the next bit of the root: 4 * partial + 1.
    wire [WORD+3:0] first_trial   = {remainder, digits[2*WORD+1-:2]};
    wire [WORD+3:0] first_test    = {1'b0, partial, 2'b01};
    wire            first_bit     = first_trial >= first_test;
    wire [WORD+1:0] first_rest    = first_trial[WORD+1:0] - (first_bit ? first_test[WORD+1:0] : {WORD+2{1'b0}});
    wire [WORD:0]   first_partial = {partial[WORD-1:0], first_bit};
    wire [WORD+3:0] second_trial  = {first_rest, digits[2*WORD-1-:2]};
    wire [WORD+3:0] second_test   = {1'b0, first_partial, 2'b01};
    wire            second_bit    = second_trial >= second_test;
    wire [WORD+1:0] second_rest   = second_trial[WORD+1:0] - (second_bit ? second_test[WORD+1:0] : {WORD+2{1'b0}});

    // root + 1/2 squared is root^2 + root + 1/4: a larger remainder means rounding up.
    wire            round_up      = remainder > {1'b0, partial};

    always @(posedge clk) begin
        done <= 1'b0;
        if (!busy) begin
            if (start) begin
                busy      <= 1'b1;
                rounds    <= ROUNDS[5:0];
                digits    <= {2'b00, radicand};
                remainder <= {WORD+2{1'b0}};
                partial   <= {WORD+1{1'b0}};
            end
        end else if (rounds != 6'd0) begin
            rounds    <= rounds - 6'd1;
            digits    <= {digits[2*WORD-3:0], 4'b0000};
            remainder <= second_rest;
            partial   <= {first_partial[WORD-1:0], second_bit};
        end else begin
            busy <= 1'b0;
            done <= 1'b1;
            root <= partial + {{WORD{1'b0}}, round_up};
        end
        if (rst) begin
            busy <= 1'b0;
            done <= 1'b0;
        end
    end
endmodule

`default_nettype wire
