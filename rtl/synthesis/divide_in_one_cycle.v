// SPDX-License-Identifier: MIT
// The division of Kout alone, between two registers, as if its product and the length of the chord were given.
// Two bits at a time: three differences side by side tell whether a pair is 3, 2, 1 or 0. W is even, and the high half
// of the product is below the length, so that the quotient has W bits.
module divide_in_one_cycle #(parameter integer W = 8) (
    input  wire           clk,
    input  wire [2*W-1:0] product,
    input  wire [W-1:0]   length,
    output reg  [W-1:0]   k
);
    reg [2*W-1:0] product0;
    reg [W-1:0] length0;
    wire [W-1:0] quotient;
    two_bits_at_a_time #(W) inside (product0, length0, quotient);
    always @(posedge clk) begin product0 <= product; length0 <= length; k <= quotient; end
endmodule

module two_bits_at_a_time #(parameter integer W = 8) (
    input wire [2*W-1:0] product, input wire [W-1:0] length, output reg [W-1:0] quotient
);
    wire [W+1:0] three = length + {length, 1'b0};
    reg [W+1:0] left;
    reg [W+2:0] less1, less2, less3; // the highest bit is a sign
    integer i;
    always @* begin
        left = product[2*W-1:W];
        for (i = W - 2; i >= 0; i = i - 2) begin
            left = {left[W-1:0], product[i +: 2]};
            less1 = {1'b0, left} - length; less2 = {1'b0, left} - {length, 1'b0}; less3 = {1'b0, left} - three;
            quotient[i +: 2] = !less3[W+2] ? 3 : !less2[W+2] ? 2 : !less1[W+2] ? 1 : 0;
            left = !less3[W+2] ? less3[W+1:0] : !less2[W+2] ? less2[W+1:0] : !less1[W+2] ? less1[W+1:0] : left;
        end
    end
endmodule
