// SPDX-License-Identifier: MIT
/*
 * runge_kutta, for any row that answers each order once and any caller that holds the operands: what
 * runge_kutta_inside.v says, in runs of any length.
 */
module runge_kutta_proof #(
    parameter CACHED = 1
) (
    input wire       clk,
    input wire       again,
    input wire       start,
    input wire       first,
    input wire [3:0] u, u_before, s_now, s_half, s_whole, first_du, first_chord,
    input wire [9:0] point_before,
    input wire       row_done,
    input wire [4:0] row_k,
    input wire       row_overflow,
    input wire       row_by_zero
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    runge_kutta #(.WORD(5), .DIM(2), .CACHED(CACHED)) dut (
        .clk(clk), .rst(!started || again), .start(start), .first(first), .u(u), .u_before(u_before),
        .point_before(point_before), .s_now(s_now), .s_half(s_half), .s_whole(s_whole), .first_du(first_du),
        .first_chord(first_chord), .row_done(row_done), .row_k(row_k), .row_overflow(row_overflow),
        .row_by_zero(row_by_zero)
    );
endmodule

/* In place of ui_out, which has a proof of its own: tells which slope is where. */
module ui_out #(parameter WORD = 5, parameter ADAMS = 1) (
    input wire [WORD-2:0] u, input wire [WORD-1:0] k_0, k_1, k_2, k_3, output wire [WORD-2:0] u_next
);
    assign u_next = u ^ k_0 ^ {k_1[0], k_1[3:1]} ^ {k_2[1:0], k_2[3:2]} ^ {k_3[2:0], k_3[3]} ^ (ADAMS != 0);
endmodule
