// SPDX-License-Identifier: MIT
/*
 * adams, for any rows that answer what they were asked, in their time, and any caller that holds the operands: what
 * adams_inside.v says, in runs of any length.
 */
module adams_proof #(
    parameter ARRANGEMENT = 2
) (
    input wire        clk,
    input wire        again,
    input wire        push,
    input wire [9:0]  push_point,
    input wire [4:0]  push_k,
    input wire        start,
    input wire [3:0]  u,
    input wire [3:0]  s,
    input wire        row_taken,
    input wire [3:0]  row_done,
    input wire [19:0] row_k,
    input wire        row_overflow,
    input wire        row_by_zero
);
    localparam ROWS = ARRANGEMENT == 1 ? 4 : 1;
    reg started = 0;
    always @(posedge clk) started <= 1;
    adams #(.WORD(5), .DIM(2), .ARRANGEMENT(ARRANGEMENT), .ROWS(ROWS)) dut (
        .clk(clk), .rst(!started || again), .push(push), .push_point(push_point), .push_k(push_k), .start(start),
        .u(u),
        .s(s), .row_taken(row_taken), .row_done(row_done[ROWS-1:0]), .row_k(row_k[ROWS*5-1:0]),
        .row_overflow(row_overflow), .row_by_zero(row_by_zero)
    );
endmodule

/* In place of ui_out, which has a proof of its own: tells which slope is where. */
module ui_out #(parameter WORD = 5, parameter ADAMS = 1) (
    input wire [WORD-2:0] u, input wire [WORD-1:0] k_0, k_1, k_2, k_3, output wire [WORD-2:0] u_next
);
    assign u_next = u ^ k_0 ^ {k_1[0], k_1[3:1]} ^ {k_2[1:0], k_2[3:2]} ^ {k_3[2:0], k_3[3]} ^ (ADAMS != 0);
endmodule
