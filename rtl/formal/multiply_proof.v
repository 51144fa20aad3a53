// SPDX-License-Identifier: MIT
/*
 * multiply, at the width that is built: the product is that of the operands LATENCY cycles before, for a new pair in
 * every cycle. With a = A 2^LOW + a' and b = B 2^LOW + b' it is A B 2^(2 LOW) + (A b' + a' B) 2^LOW + a' b'. The four
 * products are those of the language, the last one is below 2^(2 LOW); that they are added in their places is proved
 * for all operands.
 */
module multiply_proof #(
    parameter WORD    = 35,
    parameter LATENCY = 3
) (
    input wire                   clk,
    input wire signed [WORD-1:0] a,
    input wire signed [WORD-1:0] b
);
    localparam LOW  = (WORD - 1) / 2;
    localparam HIGH = WORD - LOW;
    wire signed [2*WORD-1:0] product;
    multiply #(.WORD(WORD), .LATENCY(LATENCY)) dut (.clk(clk), .a(a), .b(b), .product(product));

    reg [1:0]      age = 0;
    reg [WORD-1:0] a_1, a_2, a_3, b_1, b_2, b_3;
    always @(posedge clk) begin
        if (age != LATENCY) age <= age + 1;
        {a_3, a_2, a_1} <= {a_2, a_1, a};
        {b_3, b_2, b_1} <= {b_2, b_1, b};
    end
    wire        [WORD-1:0]   a_then = LATENCY == 3 ? a_3 : a_2, b_then = LATENCY == 3 ? b_3 : b_2;
    wire signed [HIGH-1:0]   a_high = a_then[WORD-1:LOW], b_high = b_then[WORD-1:LOW];
    wire signed [HIGH-1:0]   a_low  = {1'b0, a_then[LOW-1:0]}, b_low = {1'b0, b_then[LOW-1:0]};
    wire signed [2*HIGH-1:0] high_high = a_high * b_high, high_low = a_high * b_low, low_high = a_low * b_high,
                             low_low = a_low * b_low;
    wire signed [2*WORD-1:0] upper = high_high, one = high_low, other = low_high, lower = low_low;
    always @* begin
        assume (low_low[2*HIGH-1:2*LOW] == 0);
        if (age == LATENCY) assert (product == (upper <<< 2 * LOW) + ((one + other) <<< LOW) + lower);
        cover (age == LATENCY && product < 0);
    end
endmodule
