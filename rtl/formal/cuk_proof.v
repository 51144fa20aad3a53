// SPDX-License-Identifier: MIT
/* cuk: cu is given u + factor * k, rounded once and held between the ends. */
module cuk_proof #(
    parameter WORD = 35
) (
    input wire                   clk,
    input wire                   start,
    input wire        [WORD-2:0] u,
    input wire signed [WORD-1:0] k,
    input wire                   half,
    input wire                   whole
);
    wire [2*WORD-1:0] point;
    cuk #(.WORD(WORD), .DIM(2)) dut (
        .clk(clk), .rst(1'b0), .load(1'b0), .load_space(2'd0), .load_index(10'd0), .load_data({WORD+3{1'b0}}),
        .start(start), .u(u), .k(k), .half(half), .whole(whole), .point(point)
    );

    localparam signed [63:0] LARGEST = (64'sd1 << (WORD - 1)) - 64'sd1;
    wire signed [63:0] begin_u = {1'b0, u};
    wire signed [63:0] factor  = whole ? 64'sd24 : half ? 64'sd12 : 64'sd0;
    wire signed [63:0] wide    = k;
    wire signed [63:0] exact   = begin_u + ((factor * wide + 64'sd128) >>> 8);
    wire signed [63:0] held    = exact < 64'sd0 ? 64'sd0 : exact > LARGEST ? LARGEST : exact;
    always @* begin
        assert (point[WORD-2:0] == held[WORD-2:0]);
        cover (exact < 64'sd0);
        cover (exact > LARGEST);
        cover (half && !whole && held != 64'sd0 && held != LARGEST && exact != begin_u);
    end
endmodule

/* In place of cu: hands back the parameter it was given. */
module cu #(
    parameter WORD = 35, parameter DIM = 2, parameter MAX_POINTS = 64, parameter RATIONAL = 1
) (
    input wire clk, input wire rst, input wire load, input wire [1:0] load_space, input wire [9:0] load_index,
    input wire [WORD+2:0] load_data, input wire start, input wire [WORD-2:0] u, output wire busy, output wire done,
    output wire [DIM*WORD-1:0] point, output wire out_of_range, output wire overflow, output wire by_zero
);
    assign point = u;
endmodule
