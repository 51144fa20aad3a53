// SPDX-License-Identifier: MIT
/*
 * The paper's module Kout: the slope K = s * du / |chord|, the quotient that stands for v / |C'(u)|.
 *
 * Format    s: the distance of a period over 24, WORD - 1 bits without sign, 8 more fraction bits than a coordinate.
 *           du: WORD bits in two's complement, binary point of u. chord: DIM words, binary point of a coordinate.
 *           k: WORD bits in two's complement, 8 more fraction bits than u: what u moves in 1/24 of a period.
 * Rounding  the root and the quotient each to nearest.
 * Latency   DIM + 2 cycles, the root's and the division's: 24 in the plane for 35 bits.
 * Flags     by_zero: the chord is 0; overflow: k does not fit. k is then the largest number of du's
 *           sign; the largest above 0 where the chord and s are 0.
 *
 * One multiplier gives the squares and the product in turn, then square_root, then divide.
 * start is sampled while busy is low, and the chord with it; the caller holds s and du until done, which is high for
 * one cycle, never with busy.
 */
`default_nettype none

module kout #(
    // Width of a word: odd, 9 to 35.
    parameter integer WORD = 35,
    // Dimension of the chord: 2 or 3.
    parameter integer DIM  = 3
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   start,
    input  wire [WORD-2:0]        s,
    input  wire signed [WORD-1:0] du,
    input  wire [DIM*WORD-1:0]    chord,
    output wire                   busy,
    output wire                   done,
    output wire signed [WORD-1:0] k,
    output wire                   overflow,
    output wire                   by_zero
);
    generate if (DIM < 2 || DIM > 3) begin : check_dim
        kout_DIM_must_be_2_or_3 stop ();
    end endgenerate

    localparam [1:0] LAST_AXIS = DIM == 3 ? 2'd2 : 2'd1;

    // The multiplier takes an axis of the chord at every cycle from start on, and then s and du, which stay.
    reg [1:0]             axis;
    reg                   squaring;
    reg [2:0]             square_valid, square_last; // travel with the product
    reg [2*WORD-1:0]      radicand;
    reg                   working;
    reg [(DIM-1)*WORD-1:0] later; // axes of the chord that are still to be squared
    assign busy = working && !done;

    wire                     begins = start && !busy;
    wire                     square = begins || squaring;
    wire signed [WORD-1:0]   side = begins ? chord[WORD-1:0] : later[WORD-1:0];
    wire signed [WORD-1:0]   a = square ? side : {1'b0, s};
    wire signed [WORD-1:0]   b = square ? side : du;
    wire signed [2*WORD-1:0] product;
    wire                     root_busy, root_done, divide_busy;
    wire [WORD:0]            root;

    wire [2*WORD-1:0]        squares           = radicand + product;
    wire                     radicand_complete = square_valid[2] && square_last[2];

    multiply #(.WORD(WORD)) multiply_inst (.clk(clk), .a(a), .b(b), .product(product));
    square_root #(.WORD(WORD)) square_root_inst (
        .clk(clk), .rst(rst), .start(radicand_complete), .radicand(squares), .busy(root_busy), .done(root_done),
        .root(root)
    );
    // DIM squares of at most 2^(WORD-1) keep the root below 2^WORD.
    divide #(.WORD(WORD)) divide_inst (
        .clk(clk), .rst(rst), .start(root_done), .numerator(product), .denominator(root[WORD-1:0]),
        .busy(divide_busy), .done(done), .quotient(k), .overflow(overflow), .by_zero(by_zero)
    );

    always @(posedge clk) begin
        square_valid <= {square_valid[1:0], square};
        square_last  <= {square_last[1:0], axis == LAST_AXIS};
        squaring     <= square && axis != LAST_AXIS;
        axis         <= square && axis != LAST_AXIS ? axis + 2'd1 : 2'd0;
        if (square_valid[2]) radicand <= squares;
        later        <= begins ? chord[DIM*WORD-1:WORD] : later >> WORD;
        if (done) working <= 1'b0;
        if (begins) begin
            working  <= 1'b1;
            radicand <= {2*WORD{1'b0}};
        end
        if (rst) begin
            working      <= 1'b0;
            squaring     <= 1'b0;
            axis         <= 2'd0;
            square_valid <= 3'd0;
        end
    end

    wire unused = &{1'b0, root_busy, divide_busy, root[WORD]};
endmodule

`default_nettype wire
