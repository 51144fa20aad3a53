// SPDX-License-Identifier: MIT
/*
 * Square root: restoring, four bits of the root a cycle.
 *
 * Format    radicand: 2 * WORD bits without sign; root: WORD + 1 bits without sign. An even number of fraction bits
 *           of the radicand gives half as many of the root.
 * Rounding  to nearest (a tie cannot occur); the error is below 0.5 ulp. The extra top bit is
 *           set only where the root rounds up to 2^WORD.
 * Latency   (WORD + 1) / 4, rounded up, and 1 cycle from start to done, whatever the radicand.
 * Flags     none: every radicand has a root.
 *
 * start is sampled while busy is low; the radicand is read with it. done is high for one cycle, never with busy;
 * the root holds until the next start.
 */
`default_nettype none

module square_root #(
    // Half the width of the radicand: odd, 5 to 63.
    parameter integer WORD = 35
) (
    input  wire              clk,
    input  wire              rst,
    input  wire              start,
    input  wire [2*WORD-1:0] radicand,
    output reg               busy,
    output reg               done,
    output wire [WORD:0]     root
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check
        square_root_WORD_must_be_odd_and_from_5_to_63 stop ();
    end endgenerate

    localparam [31:0] ROUNDS = (WORD + 4) / 4;
    localparam PAIRS = 4 * ((WORD + 4) / 4);
    wire [2*WORD+7:0] aligned = {6'b000000, radicand, 2'b00};

    reg [4:0]         rounds;    // still to do after this one
    reg [2*PAIRS-1:0] digits;    // pairs of bits of the radicand not yet used, at the top
    reg [WORD+1:0]    remainder; // radicand so far - partial^2, at most 2 * partial
    reg [WORD:0]      partial;   // bits of the root found so far; the last one decides the rounding

    // A step brings down two bits of the radicand and tries the next bit of the root by subtracting 4 * partial + 1.
    wire [WORD+1:0] rest [0:4];
    wire [WORD:0]   found [0:4];
    assign rest[0]  = remainder;
    assign found[0] = partial;
    genvar i;
    generate for (i = 0; i < 4; i = i + 1) begin : digit
        wire [WORD+3:0] trial = {rest[i], digits[2*PAIRS-1-2*i-:2]};
        wire [WORD+3:0] less  = trial - {1'b0, found[i], 2'b01};
        assign rest[i+1]      = less[WORD+3] ? trial[WORD+1:0] : less[WORD+1:0];
        assign found[i+1]     = {found[i][WORD-1:0], !less[WORD+3]};
    end endgenerate

    assign root = {1'b0, partial[WORD:1]} + {{WORD{1'b0}}, partial[0]};

    always @(posedge clk) begin
        done <= 1'b0;
        if (!busy) begin
            if (start) begin
                busy      <= 1'b1;
                rounds    <= ROUNDS[4:0] - 5'd1;
                digits    <= aligned[2*PAIRS-1:0];
                remainder <= {WORD+2{1'b0}};
                partial   <= {WORD+1{1'b0}};
            end
        end else begin
            rounds    <= rounds - 5'd1;
            digits    <= digits << 8;
            remainder <= rest[4];
            partial   <= found[4];
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
