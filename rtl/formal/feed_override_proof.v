// SPDX-License-Identifier: MIT
/*
 * feed_override with its program, for any feed, any commands and any numbers: what feed_override_inside.v says holds
 * in runs of any length.
 */
module feed_override_proof (
    input wire        clk,
    input wire        again,
    input wire        start,
    input wire        may,
    input wire [8:0]  rate,
    input wire        stopping,
    input wire        in_valid,
    input wire [35:0] in_distance,
    input wire        in_last,
    input wire        take
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    feed_override #(.WORD(9)) dut (
        .clk(clk), .rst(!started || again), .load(1'b0), .load_index(4'd0), .load_data(64'd0), .start(start),
        .may(may), .rate(rate),
        .stopping(stopping), .in_valid(in_valid), .in_distance(in_distance), .in_last(in_last), .take(take)
    );
endmodule
