// SPDX-License-Identifier: MIT
/*
 * kout, with a multiplier that answers anything, and a root and a division that take as long as they like: what
 * kout_inside.v says holds in runs of any length, if the caller holds s and du until done.
 */
module kout_proof #(
    parameter DIM = 2
) (
    input wire             clk,
    input wire             again,
    input wire             start,
    input wire [7:0]       s,
    input wire [8:0]       du,
    input wire [DIM*9-1:0] chord
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire busy, done;
    kout #(.WORD(9), .DIM(DIM)) dut (
        .clk(clk), .rst(!started || again), .start(start), .s(s), .du(du), .chord(chord), .busy(busy), .done(done)
    );
endmodule

module multiply #(parameter WORD = 35, parameter LATENCY = 3) (
    input wire clk, input wire signed [WORD-1:0] a, input wire signed [WORD-1:0] b,
    output wire signed [2*WORD-1:0] product
);
    assign product = $anyseq;
endmodule

/* start is sampled while busy is low; done comes once, at any later time, never with busy. */
module answers (input wire clk, input wire rst, input wire start, output reg busy, output reg done);
    initial {busy, done} = 0;
    wire ends = $anyseq;
    always @(posedge clk) begin
        done <= !rst && busy && ends;
        busy <= !rst && (busy ? !ends : start);
    end
endmodule

module square_root #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire start, input wire [2*WORD-1:0] radicand, output wire busy,
    output wire done, output wire [WORD:0] root
);
    answers answers_inst (.clk(clk), .rst(rst), .start(start), .busy(busy), .done(done));
    assign root = $anyseq;
endmodule

module divide #(parameter WORD = 35) (
    input wire clk, input wire rst, input wire start, input wire signed [2*WORD-1:0] numerator,
    input wire [WORD-1:0] denominator, output wire busy, output wire done, output wire signed [WORD-1:0] quotient,
    output wire overflow, output wire by_zero
);
    answers answers_inst (.clk(clk), .rst(rst), .start(start), .busy(busy), .done(done));
    assign quotient = $anyseq;
    assign overflow = $anyseq;
    assign by_zero = $anyseq;
endmodule
