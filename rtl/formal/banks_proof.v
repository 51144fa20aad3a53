// SPDX-License-Identifier: MIT
/*
 * banks, for any loader that asks whether a number is writable, and any path that goes on to a bank only once it is
 * closed; what banks_inside.v says holds in runs of any length.
 */
module banks_proof (
    input wire        clk,
    input wire        again,
    input wire        wants_load,
    input wire [2:0]  load_space,
    input wire [9:0]  load_index,
    input wire [63:0] load_data,
    input wire        wants_close,
    input wire        bound_beyond,
    input wire        go,
    input wire        ends,
    input wire        feed_goes_on,
    input wire        point_goes_on,
    input wire        period_taken
);
    reg        started = 0, busy = 0, done = 0;
    wire       rst = !started || again;
    wire       writable, outside, starved;
    wire [1:0] closed, final_bank;
    wire       load = wants_load && writable && load_space != 7, close = wants_close && load_space == 7 && writable;
    wire       begins = go && !busy && !load && !close && closed[0];
    // The path: the feed is at most a bank ahead of the points.
    reg        feed_bank = 0, point_bank = 0;
    wire       ahead = feed_bank != point_bank;
    wire       feeds = !rst && busy && feed_goes_on && !ahead;
    wire       points = !rst && busy && point_goes_on && ahead && closed[feed_bank];
    // After the last point of a bank has been evaluated it takes some cycles to the end of the run.
    reg        moved = 0;
    wire       over = ends && !points && !moved;
    always @(posedge clk) begin
        started <= 1;
        moved   <= points;
        busy    <= !rst && (busy ? !over : begins);
        done    <= !rst && busy && over;
        if (begins) {feed_bank, point_bank} <= 0;
        if (feeds) feed_bank <= !feed_bank;
        if (points) point_bank <= !point_bank;
    end
    banks #(.WORD(5), .DIM(2)) dut (
        .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index), .load_data(load_data),
        .close(close), .bound_beyond(bound_beyond), .busy(busy), .begins(begins), .done(done),
        .period_taken(period_taken),
        .point_bank(point_bank), .feed_bank(feed_bank), .metric_at(9'd0), .root_at(9'd0), .length_at(6'd0),
        .coefficient_at(10'd0), .final_bank(final_bank), .writable(writable), .closed(closed), .outside(outside),
        .starved(starved)
    );
endmodule
