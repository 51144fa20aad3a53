// SPDX-License-Identifier: MIT
/* exact_step, for any operands and any piece: what exact_step_inside.v says, for one step after a reset. */
module exact_step_proof #(
    parameter CUBIC = 0
) (
    input wire               clk,
    input wire signed [24:0] metric
);
    (* anyconst *) reg [36:0] t;
    (* anyconst *) reg [23:0] y, ds;
    (* anyconst *) reg [5:0]  shift;
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 2) age <= age + 1;
    exact_step #(.WORD(25)) dut (
        .clk(clk), .rst(age == 0), .start(age == 1), .cubic(CUBIC != 0), .t(t), .y(y), .ds(ds), .shift(shift),
        .metric(metric)
    );
endmodule

/* In place of multiply: both operands, three cycles later. */
module multiply #(
    parameter WORD = 35, parameter LATENCY = 3
) (
    input wire clk, input wire [WORD-1:0] a, input wire [WORD-1:0] b, output reg [2*WORD-1:0] product
);
    reg [2*WORD-1:0] first, second;
    always @(posedge clk) {product, second, first} <= {second, first, a, b};
endmodule
