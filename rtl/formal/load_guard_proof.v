// SPDX-License-Identifier: MIT
/*
 * load_guard, for any writes: what load_guard_inside.v says holds in runs of any length.
 */
module load_guard_proof #(
    parameter EXACT = 0
) (
    input wire        clk,
    input wire        again,
    input wire        clear,
    input wire        load,
    input wire [2:0]  space,
    input wire [9:0]  index,
    input wire [63:0] data
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    load_guard #(.WORD(17), .DIM(2), .RATIONAL(0), .EXACT(EXACT)) dut (
        .clk(clk), .rst(!started || again), .clear(clear), .load(load), .space(space), .index(index), .data(data)
    );
endmodule
