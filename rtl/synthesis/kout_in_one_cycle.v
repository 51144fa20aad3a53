// SPDX-License-Identifier: MIT
// Kout in one clock cycle: s * du over the root of x * x + y * y between two registers, by five methods.
// METHOD 0: root and quotient bit by bit, one sum for each; 1: a table of 1 / root, and a product for the quotient;
// 2: a table of 1 / root for every x and y, in memories that register their address, and two products;
// 3: the root bit by bit, the quotient two bits at a time (divide_in_one_cycle.v); 4: so too, where x is the length.
// Table 1 is read from inverse_roots.hex, which synthesis.py writes; it errs by up to 0.15 %, a unit of its
// words (0.8 % if W is 8) and two units of k. Table 2 has 4^W words, so W is small; it errs by up to half a unit of
// its words (0.4 % if W is 8) and one unit of k. Its bits a, b, ... are read from inverse_lengths_a.hex, ...
module kout_in_one_cycle #(parameter integer W = 20, METHOD = 0) (
    input  wire                  clk,
    input  wire signed [W-1:0]   x, y, du,
    input  wire [W-2:0]          s,
    output reg  [W-1:0]          k
);
    reg signed [W-1:0] x0, y0, du0;
    reg [W-2:0] s0;
    wire [2*W-1:0] squares = x0 * x0 + y0 * y0;
    wire [2*W-1:0] product = s0 * $unsigned(du0[W-2:0]);
    wire [W-1:0] quotient;
    generate
        if (METHOD == 0) bit_by_bit #(W) inside (squares, product, quotient);
        else if (METHOD == 1) table_of_roots #(W) inside (squares, product, quotient);
        else if (METHOD == 2) table_of_lengths #(W) inside (clk, {x, y}, product, quotient);
        else begin : divided
            wire [W-1:0] root, given, length;
            assign given = x0;
            assign length = METHOD == 3 ? root : given;
            root_bit_by_bit #(W) inside (squares, root);
            two_bits_at_a_time #(W) faster (product, length, quotient);
        end
    endgenerate
    always @(posedge clk) begin x0 <= x; y0 <= y; du0 <= du; s0 <= s; k <= quotient; end
endmodule

module bit_by_bit #(parameter integer W = 20) (
    input wire [2*W-1:0] squares, product, output reg [W-1:0] quotient
);
    wire [W-1:0] root; reg [W+1:0] left; // its highest bit is a sign
    root_bit_by_bit #(W) inside (squares, root);
    integer i;
    always @* begin
        left = product[2*W-1:W]; quotient = 0;
        for (i = W - 1; i >= 0; i = i - 1) begin
            left = {left[W:0], product[i]} + ({2'b0, root} ^ {W+2{!left[W+1]}}) + !left[W+1];
            quotient[i] = !left[W+1];
        end
    end
endmodule

module root_bit_by_bit #(parameter integer W = 20) (input wire [2*W-1:0] squares, output reg [W-1:0] root);
    reg [W+2:0] rest; // its highest bit is a sign
    integer i;
    always @* begin
        root = 0; rest = 0;
        for (i = W - 1; i >= 0; i = i - 1) begin // root ends in 1 where a bit of it was found, rest >= 0
            rest = {rest[W:0], squares[2*i +: 2]}
                 + ({1'b0, root, rest[W+2], 1'b1} ^ {W+3{!rest[W+2]}}) + !rest[W+2];
            root = {root[W-2:0], !rest[W+2]};
        end
    end
endmodule

module table_of_roots #(parameter integer W = 20) (
    input wire [2*W-1:0] squares, product, output wire [W-1:0] quotient
);
    reg [W-1:0] inverse [0:1023]; // 2^(W-1) / root((index + 1/2) / 1024), from 256 on
    initial $readmemh("inverse_roots.hex", inverse);
    // Both shifted up together, squares by pairs of bits, until one of its two highest bits is 1.
    reg [2*W-1:0] high, shifted;
    integer j;
    always @* begin
        high = squares; shifted = product;
        for (j = 4; j >= 0; j = j - 1)
            if ((1 << j) < W && high >> (2 * W - (2 << j)) == 0) begin
                high = high << (2 << j); shifted = shifted << (1 << j);
            end
    end
    wire [2*W-1:0] scaled = shifted[2*W-1:W] * inverse[high[2*W-1 -: 10]];
    assign quotient = scaled[2*W-2:W-1];
endmodule

module table_of_lengths #(parameter integer W = 8) (
    input wire clk, input wire [2*W-1:0] x_and_y, input wire [2*W-1:0] product, output wire [W-1:0] quotient
);
    wire [W+2:0] inverse; // of the length: an exponent of 3 bits, and W bits that begin with a 1
    genvar i;
    generate for (i = 0; i < W + 3; i = i + 1) begin : bits // a memory for each, as those are deep and narrow
        bit_of_table #(.DEPTH(1 << 2*W), .LETTER(97 + i)) one (clk, x_and_y, inverse[i]);
    end endgenerate
    wire [3*W-1:0] scaled = product * inverse[W-1:0];
    wire [2*W-1:0] shifted = scaled[3*W-1:W] >> inverse[W+2:W];
    assign quotient = shifted[W-1:0];
endmodule

module bit_of_table #(parameter integer DEPTH = 65536, parameter [7:0] LETTER = "a") (
    input wire clk, input wire [$clog2(DEPTH)-1:0] place, output reg found
);
    reg bits [0:DEPTH-1];
    initial $readmemh({"inverse_lengths_", LETTER, ".hex"}, bits);
    always @(posedge clk) found <= bits[place];
endmodule
