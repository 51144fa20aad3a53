// SPDX-License-Identifier: MIT
/*
 * divide: from any idle state, whatever came before, an accepted start is answered by one done after exactly the
 * stated latency, and the quotient is the nearest one; a start while busy changes nothing.
 */
module divide_proof #(
    parameter WORD = 5
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
        .done(done), .quotient(quotient), .overflow(overflow), .by_zero(by_zero)
    );
    wire first;
    latency_proof #(.LATENCY((WORD + 3) / 4 + 1)) latency (
        .clk(clk), .rst(rst), .start(start), .busy(busy), .done(done), .first_answer(first)
    );

    reg signed [2*WORD-1:0] n;
    reg        [WORD-1:0]   d;
    reg                     later = 0;
    always @(posedge clk) begin
        later <= 1;
        if (!later) {n, d} <= {numerator, denominator};
    end

    // Nearest, halves away from 0: 2 |q| d <= 2 |n| + d < 2 (|q| + 1) d.
    localparam [2*WORD+1:0] LARGEST = (1 << (WORD - 1)) - 1;
    wire [2*WORD-1:0] magnitude = n < 0 ? -n : n;
    wire [WORD-1:0]   q         = n < 0 ? -quotient : quotient;
    wire [2*WORD+1:0] shifted   = {magnitude, 1'b0} + d;
    wire [2*WORD+1:0] product   = q * d;
    wire              too_large = shifted >= 2 * (LARGEST + 1) * d;
    always @* if (first) begin
        cover (overflow);
        cover (!overflow && !by_zero && n < 0 && quotient != 0);
        assert (by_zero == (d == 0));
        assert (overflow == (d != 0 && too_large));
        assert (q <= LARGEST);
        if (too_large) assert (q == LARGEST);
        else assert (2 * product <= shifted && shifted < 2 * product + 2 * d);
    end
endmodule
