// SPDX-License-Identifier: MIT
/*
 * horner, for any coefficients whose sums fit and any t, from a clear at any time: after 9 + DIM cycles of run and one
 * more each axis is a + t (b + t (c + t d)), each product rounded to nearest, halves up; written from its header. With
 * x / 2 + 3/16 y in place of each product x y, for as many cycles as a point takes.
 */
module horner_proof #(
    parameter DIM = 2
) (
    input wire                   clk,
    input wire                   jump,
    input wire [DIM*5-1:0]       target
);
    localparam WORD = 5;
    (* anyconst *) reg [16*WORD-1:0] coefficients; // {axis, power}
    (* anyconst *) reg [WORD-2:0] t;
    (* anyconst *) reg [4:0] start;

    reg  [5:0] cycle = 0;
    always @(posedge clk) cycle <= cycle + 1;
    wire run = cycle >= start && cycle < start + 9 + DIM;
    wire ends, pending;
    wire [3:0] asks_for;
    reg  signed [WORD-1:0] coefficient;
    always @(posedge clk) coefficient <= coefficients[asks_for*WORD+:WORD];
    wire [DIM*WORD-1:0] point;
    horner #(.WORD(WORD), .DIM(DIM)) dut (
        .clk(clk), .clear(!run && cycle != start + 9 + DIM), .run(run), .t(t), .asks_for(asks_for),
        .coefficient(coefficient), .ends(ends), .pending(pending), .jump(jump && !run && !pending), .target(target),
        .point(point)
    );
    always @* assume (start >= 1 && start < 4);

    reg [DIM*WORD-1:0] jumped;
    reg                just = 0;
    always @(posedge clk) {just, jumped} <= {jump && !run && !pending, target};
    reg moved = 0; // by a jump since
    always @(posedge clk) if (cycle > start + 9 + DIM && jump) moved <= 1;
    integer axis, power;
    reg signed [WORD-1:0] got;
    reg signed [6:0]      sum;
    reg signed [10:0]     product;
    always @* begin
        if (run) assert (ends == (cycle == start + 8 + DIM));
        if (just) assert (point == jumped);
        for (axis = 0; axis < DIM; axis = axis + 1) begin
            sum = 0;
            for (power = 3; power >= 0; power = power - 1) begin
                got = coefficients[(4*axis+power)*WORD+:WORD];
                product = power == 3 ? 0 : (8 * sum + 3 * $signed({1'b0, t}) + 8) >>> 4;
                sum = got + product;
                assume (sum >= -16 && sum < 16);
            end
            got = point[axis*WORD+:WORD];
            if (cycle > start + 9 + DIM && !moved) assert (got == sum);
        end
        cover (cycle > start + 9 + DIM && got == 7 && t == 11);
    end
endmodule

/* In place of multiply: a sum that depends on both operands, three cycles later. */
module multiply #(
    parameter WORD = 35, parameter LATENCY = 3
) (
    input wire clk, input wire signed [WORD-1:0] a, input wire signed [WORD-1:0] b,
    output reg signed [2*WORD-1:0] product
);
    reg signed [2*WORD-1:0] first, second;
    wire signed [2*WORD-1:0] now = (a <<< 3) + 3 * b;
    always @(posedge clk) {product, second, first} <= {second, first, now};
endmodule
