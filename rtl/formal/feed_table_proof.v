// SPDX-License-Identifier: MIT
/*
 * feed_table, for any table and any loader that leaves a closed bank alone: what feed_table_inside.v says holds in
 * runs of any length.
 */
module feed_table_proof (
    input wire        clk,
    input wire        again,
    input wire        load,
    input wire [9:0]  load_index,
    input wire [35:0] load_data,
    input wire [13:0] last_record,
    input wire [1:0]  closed,
    input wire [1:0]  final_bank,
    input wire        start,
    input wire        take
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    feed_table #(.WORD(9)) dut (
        .clk(clk), .rst(!started || again), .load(load), .load_index(load_index), .load_data(load_data),
        .last_record(last_record), .closed(closed), .final_bank(final_bank), .start(start), .take(take)
    );
endmodule
