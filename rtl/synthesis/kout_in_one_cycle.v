// SPDX-License-Identifier: MIT
// Kout in one clock cycle: two squares, a root, a product and a quotient between two registers.
module kout_in_one_cycle #(parameter integer W = 20) (
    input  wire                  clk,
    input  wire signed [W-1:0]   x, y, du,
    input  wire [W-2:0]          s,
    output reg  [W-1:0]          k
);
    reg signed [W-1:0] x0, y0, du0;
    reg [W-2:0] s0;
    wire [2*W-1:0] squares = x0 * x0 + y0 * y0;
    wire [2*W-1:0] product = s0 * $unsigned(du0[W-2:0]);
    reg [W-1:0] root; reg [W+1:0] rest;
    reg [W-1:0] quotient; reg [W:0] left;
    integer i;
    always @* begin
        root = 0; rest = 0;
        for (i = W - 1; i >= 0; i = i - 1) begin
            rest = {rest[W-1:0], squares[2*i +: 2]};
            if (rest >= {root, 2'b01}) begin
                rest = rest - {root, 2'b01};
                root = {root[W-2:0], 1'b1};
            end else root = {root[W-2:0], 1'b0};
        end
        left = product[2*W-1:W]; quotient = 0;
        for (i = W - 1; i >= 0; i = i - 1) begin
            left = {left[W-1:0], product[i]};
            if (left >= root) begin left = left - root; quotient[i] = 1'b1; end
        end
    end
    always @(posedge clk) begin x0 <= x; y0 <= y; du0 <= du; s0 <= s; k <= quotient; end
endmodule
