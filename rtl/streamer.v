// SPDX-License-Identifier: MIT
/*
 * Steps along polynomial pieces by arc length, with the exact |C'|: the machine beyond the paper's.
 *
 * The curve comes as pieces, t from 0 to 1, with their arc lengths; the feed as the distance of each period. A step
 * that passes the end of a piece begins anew at the start of the next one with the rest of its distance, so no step
 * is taken across a knot and no error is carried over it. The point of one step is evaluated while the next is on its
 * way.
 *
 * Format    points: WORD bits an axis in two's complement, binary point chosen by the loader, as all sums of Horner's
 *           scheme fit. position: {piece[5:0], t with WORD - 1 fraction bits}; of the last beat that of the beat
 *           before, as t is less than 1. Lengths: 64 bits without sign, 12 more fraction bits than a step. Distances
 *           of the feed: WORD + 27 bits, 28 more fraction bits than a step. |C'|^2 and its reciprocal root: WORD - 5
 *           fraction bits, as parts of a bound of the piece.
 * Rounding  products and the steps to nearest, halves up; a step errs by the fourth power of its length (README.md).
 * Latency   17 cycles a step up to degree 2, 24 for degree 3, whatever the dimension, if points are taken at once;
 *           with AHEAD a point up to 60 cycles after the one before is taken.
 * Flags     faults, of the latest run, unknown before the first: [0] overflow: a step turns too much (exact_step.v),
 *           or the feed goes on beyond the path by more than the largest step that fits, [1] and [2] never, [3]
 *           too_far: an axis would move by more than the largest step, [4] beyond: an axis would leave its limits. A
 *           point with or after a fault never leaves. outside: a bank was not closed, see banks.v.
 * outputs: bits that are loaded with a piece; those of a beat belong to the piece in which the period that leads to
 * its point ends. The first beat of a run and a void one have none.
 *
 * go is sampled while busy, stop, load and close are low and bank 0 is closed. Points leave by a valid/ready
 * handshake; last marks the final beat of a run, stopped a void one, which repeats the point before. done is high for
 * one cycle after the final beat has been taken, never with busy. A distance of 0 is legal: the tool rests. rate is
 * the feed override, 0 to 256; it is sampled once a period, while sampled is high (unknown before the first go), and
 * followed within the limits: feed_override.v. stop: the tool slows down on its path, and a void beat ends the run
 * where it rests; so it does when a bank is loaded whose curve would leave the limits or whose feed would exceed the
 * largest step. A fault ends the run at once: the next point is then unknown, or it contradicts the bounds of its
 * bank, so no motion on the path is known that could brake.
 * Load bus:
 *   space 0  {piece[5:0], word[2:0]}: 0 to 4 coefficients of |C'|^2, 5 the reciprocal root at t = 0, 6 length,
 *            7 {outputs[3:0], shift[5:0]}
 *   space 1  {bank, record[6:0], word[1:0]}: the feed, feed_table.v
 *   space 2  {piece[5:0], axis[1:0], power[1:0]}: coefficients of an axis
 *   space 3  0 and 8, of bank 0 and 1: {periods[31:0], 2'd0, final, cubic, last record[6:0], last piece[4:0]};
 *            1 to 3 the coordinates of the end of the job; {axis[1:0], side, bank, 3'd4} bounds of all points of a
 *            bank: the lowest (side 0) and the highest coordinate of each axis, after the limits; {3'd7, bank, 3'd4}
 *            the most that an axis moves in one of its periods at any rate
 *   space 5  4 and 8 to 13: soft_limits.v; 5, 7 and 14: feed_override.v; 6 the reserve
 *
 * A job of any length streams through two banks (banks.v), each of 32 pieces and 128 records; the upper bit of a
 * piece is its bank. close marks the bank of load_index[0] as loaded, and the run takes the banks in turn from bank 0
 * to the one that is final; a bank opens as the last point on it has been evaluated. The end of a period falls on
 * either side of a junction: what is left of its distance goes on in the next bank. starved: less than the reserve of
 * periods is there to run and more has to come, so the tool slows down, and goes on as soon as it is there. A job
 * that has left a bank and ended forgets both.
 */
`default_nettype none

module streamer #(
    // Width of a word: odd, 25 to 35.
    parameter integer WORD = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM  = 3,
    // 1: a point is computed as the one before is taken, so that rate and stop act on it; 0: as soon as possible.
    parameter integer AHEAD = 0
) (
    input  wire                clk,
    input  wire                rst,
    input  wire                load,
    input  wire [2:0]          load_space,
    input  wire [9:0]          load_index,
    input  wire [63:0]         load_data,
    input  wire                go,
    input  wire                stop,
    input  wire [8:0]          rate,
    output wire                sampled,
    output wire                resting,
    output wire                busy,
    output reg                 done,
    output wire [4:0]          faults,
    output reg                 valid,
    input  wire                ready,
    output reg  [WORD+4:0]     position,
    output reg  [DIM*WORD-1:0] point_out,
    output reg                 last,
    output reg                 stopped,
    output reg  [3:0]          outputs,
    output wire                writable,
    input  wire                close,
    output wire [1:0]          closed,
    output wire                outside,
    output wire                starved
);
    generate if (AHEAD < 0 || AHEAD > 1) begin : check_ahead
        streamer_AHEAD_must_be_0_or_1 stop ();
    end endgenerate

    localparam TW = WORD + 12;

    wire                   begins, planned_take, feed_bank;
    reg  [5:0]             point_piece, now_piece, ahead;
    reg  [2:0]             fetching;
    wire [2:0]             of_metric;
    wire [3:0]             of_point;
    wire signed [WORD-1:0] metric, coefficient;
    wire [WORD-1:0]        root_q;
    wire [63:0]            length_q;
    wire [1:0]             cubic, final_bank;
    wire [9:0]             last_piece;
    wire [13:0]            last_record;
    wire [DIM*WORD-1:0]    end_point;
    wire                   bound_beyond;
    banks #(.WORD(WORD), .DIM(DIM)) banks_inst (
        .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index), .load_data(load_data),
        .close(close), .bound_beyond(bound_beyond), .busy(busy), .begins(begins), .done(done),
        .period_taken(planned_take), .point_bank(point_piece[5]), .feed_bank(feed_bank),
        .metric_at({now_piece, of_metric}), .metric(metric), .root_at({ahead, fetching == 3'd1 ? 3'd5 : 3'd7}),
        .root(root_q), .length_at(ahead), .length(length_q), .coefficient_at({point_piece, of_point}),
        .coefficient(coefficient), .cubic(cubic), .last_piece(last_piece), .last_record(last_record),
        .final_bank(final_bank), .end_point(end_point), .writable(writable), .closed(closed), .outside(outside),
        .starved(starved)
    );

    // ---- The run: what leaves is evaluated, checked, offered.

    localparam [2:0] IDLE = 3'd0, RUN = 3'd1, EVALUATE = 3'd2, CHECK = 3'd3, OFFER = 3'd4, CLOSE = 3'd5, DRAIN = 3'd6;
    reg [2:0] state;
    assign busy = state != IDLE;
    wire clear  = rst || state == CLOSE;
    reg  stopping;
    assign begins = go && !busy && !stop && !load && !close && closed[0];
    wire free   = !valid || ready;
    wire idle   = state == RUN; // nothing on its way out
    reg  flying;                // a point is to come that has not been taken
    always @(posedge clk) flying <= !clear && (begins || sampled || (flying && !(valid && ready)));

    // ---- The distance of the next period, and the piece in which it ends.

    wire [WORD+26:0] planned, distance;
    wire             planned_valid, planned_last, fed, fed_last, fed_cut;
    reg              adding, comparing, settled;
    feed_table #(.WORD(WORD)) feed_table_inst (
        .clk(clk), .rst(clear), .load(load && load_space == 3'd1), .load_index(load_index),
        .load_data(load_data[WORD+26:0]), .last_record(last_record), .closed(closed), .final_bank(final_bank),
        .start(begins), .take(planned_take), .valid(planned_valid), .distance(planned), .is_last(planned_last),
        .bank(feed_bank)
    );
    feed_override #(.WORD(WORD)) feed_override_inst (
        .clk(clk), .rst(clear), .load(load && load_space == 3'd5), .load_index(load_index[3:0]), .load_data(load_data),
        .start(begins), .may(AHEAD == 0 || !flying), .rate(starved ? 9'd0 : rate), .stopping(stopping),
        .sampled(sampled), .resting(resting), .in_valid(planned_valid), .in_distance(planned),
        .in_last(planned_last), .in_take(planned_take), .valid(fed), .distance(distance), .is_last(fed_last),
        .cut(fed_cut), .take(adding && fed)
    );
    wire [WORD+26:0] rounding = {{WORD+11{1'b0}}, 1'b1, 15'd0};
    wire [WORD+26:0] rounded  = distance + rounding;
    // 12 fraction bits more than a step
    wire [63:0]      further  = {{53-WORD{rounded[WORD+26]}}, rounded[WORD+26:16]};

    reg [63:0]     along, moved, length, next_length;  // along the piece in which the period ends
    reg [WORD-2:0] root, next_root;
    reg [5:0]      shift, next_shift, piece;           // piece in which the period ends; ahead is the next one
    reg [3:0]      bits, next_bits;                    // its outputs
    reg            anew, is_last, is_cut;
    reg            past;                               // beyond the end, by more than fits a step
    reg            fetched;                            // all of the next piece; fetching is the cycle of that
    wire [4:0]     last_of   = ahead[5] ? last_piece[9:5] : last_piece[4:0];
    reg            no_more;                            // this piece is the last one of the job
    wire           reached   = along >= length;
    wire           passes    = reached && !no_more;
    wire [63:0]    rest      = along - length;

    // ---- The step.

    wire                   step_busy, step_done, unsettled;
    wire [TW-1:0]          t_next;
    wire [WORD-2:0]        y_next;
    reg                    waiting;                    // t_next is not yet with the evaluation
    reg                    over;                       // the last period has been taken
    wire                   arrived = step_done || waiting;
    wire                   passed  = !arrived || (idle && !over_now);
    wire                   step    = settled && !step_busy && !over && passed;
    reg                    now_anew, now_last, now_cut, now_past;
    reg  [WORD-2:0]        now_root, now_ds;
    reg  [5:0]             now_shift;
    reg  [3:0]             now_bits;
    wire                   over_now = now_last && arrived;
    wire [63:0]            ds_round = moved + 64'd2048;
    wire [WORD-2:0]        ds_new   = ds_round[12+:WORD-1];
    exact_step #(.WORD(WORD)) exact_step_inst (
        .clk(clk), .rst(clear), .start(step), .cubic(cubic[now_piece[5]]),
        .t((step ? anew : now_anew) ? {TW{1'b0}} : t_next),
        .y((step ? anew : now_anew) ? (step ? root : now_root) : y_next),
        .ds(step ? ds_new : now_ds), .shift(now_shift), .coefficient(of_metric), .metric(metric),
        .busy(step_busy), .done(step_done), .t_next(t_next), .y_next(y_next), .unsettled(unsettled)
    );

    always @(posedge clk) begin
        if (fetching != 3'd0) fetching <= fetching == 3'd3 ? 3'd0 : fetching + 3'd1;
        else if (busy && !fetched && closed[ahead[5]]) fetching <= 3'd1;
        if (fetching == 3'd3) fetched <= 1'b1;
        if (fetching == 3'd2) {next_root, next_length} <= {root_q[WORD-2:0], length_q};
        if (fetching == 3'd3) {next_bits, next_shift} <= root_q[9:0];
        if (adding && fed) begin
            adding    <= 1'b0;
            comparing <= 1'b1;
            along     <= along + further;
            moved     <= further;
            is_last   <= fed_last;
            is_cut    <= fed_cut;
            anew      <= 1'b0;
        end
        if (comparing) begin
            past <= reached && no_more && !is_last && |rest[63:WORD+10];
            if (!passes) {comparing, settled} <= 2'b01;
            else if (fetched) begin
                along     <= rest;
                moved     <= rest;
                length    <= next_length;
                root      <= next_root;
                shift     <= next_shift;
                bits      <= next_bits;
                piece     <= ahead;
                ahead     <= ahead[4:0] == last_of ? {!ahead[5], 5'd0} : ahead + 6'd1;
                no_more   <= ahead[4:0] == last_of && final_bank[ahead[5]];
                anew      <= 1'b1;
                fetched   <= 1'b0;
            end
        end
        if (step) begin
            settled   <= 1'b0;
            adding    <= !is_last && !is_cut;
            now_anew  <= anew;
            now_root  <= root;
            now_ds    <= ds_new;
            now_piece <= piece;
            now_shift <= shift;
            now_bits  <= bits;
            now_last  <= is_last;
            now_cut   <= is_cut;
            now_past  <= past;
        end
        waiting <= arrived && !idle;
        if (over_now) over <= 1'b1;
        if (begins) begin
            adding    <= 1'b1;
            along     <= 64'd0;
            length    <= 64'd0;
            ahead     <= 6'd0;
            fetched   <= 1'b0;
            no_more   <= 1'b0;
            over      <= 1'b0;
            now_last  <= 1'b0;
        end
        if (clear || begins) {comparing, settled, waiting} <= 3'd0;
        if (clear || begins) fetching <= 3'd0;
        if (clear) adding <= 1'b0;
    end

    // ---- The point, and its check.

    reg                compared;
    reg  [WORD-2:0]    point_t;
    reg  [3:0]         point_bits;
    wire               ends, pending;
    wire [DIM*WORD-1:0] point;
    horner #(.WORD(WORD), .DIM(DIM)) horner_inst (
        .clk(clk), .clear(state == IDLE || state == RUN), .run(state == EVALUATE), .t(point_t), .asks_for(of_point),
        .coefficient(coefficient), .ends(ends), .pending(pending), .jump(state == RUN && over), .target(end_point),
        .point(point)
    );

    reg  overflow, too_far, beyond, sent, final_point, cut_point;
    wire far_now, beyond_now;
    soft_limits #(.WORD(WORD), .DIM(DIM)) soft_limits_inst (
        .clk(clk), .load(load && load_space == 3'd5), .load_index(load_index[3:0]), .load_data(load_data[WORD-1:0]),
        .bound({load_index[6:5], load_index[4]}), .bound_beyond(bound_beyond),
        .point(point), .point_before(point_out), .too_far(far_now), .beyond(beyond_now)
    );
    assign faults = {beyond, too_far, 2'b00, overflow};
    wire failed   = overflow || beyond_now || (far_now && sent);

    always @(posedge clk) begin
        done <= 1'b0;
        if (ready) valid <= 1'b0;
        if ((stop || outside) && busy) stopping <= 1'b1;
        case (state)
            IDLE: if (begins) begin
                state       <= EVALUATE; // the start
                point_t     <= {WORD-1{1'b0}};
                point_piece <= 6'd0;
                point_bits  <= 4'd0;
                {overflow, too_far, beyond, sent, stopped, final_point, cut_point, compared} <= 8'd0;
                position    <= {WORD+5{1'b0}};
                point_out   <= {DIM*WORD{1'b0}};
            end
            RUN: if (over) begin
                state       <= CHECK;
                final_point <= 1'b1;
                point_bits  <= now_bits;
            end else if (arrived && !over_now) begin
                state         <= EVALUATE;
                overflow      <= unsettled || now_past;
                point_t       <= t_next[TW-1] ? {WORD-1{1'b1}} : t_next[12+:WORD-1];
                point_piece   <= now_piece;
                point_bits    <= now_bits;
                cut_point     <= now_cut;
            end
            EVALUATE: if (ends) state <= CHECK;
            // The last axis is stored, then compared in two cycles.
            CHECK: begin
                compared <= !pending && !compared;
                if (compared) state <= OFFER;
            end
            OFFER: if (failed) begin
                state   <= CLOSE;
                too_far <= !overflow && far_now && sent;
                beyond  <= !overflow && beyond_now;
            end else if (free) begin
                valid     <= 1'b1;
                sent      <= 1'b1;
                position  <= {point_piece, point_t};
                outputs   <= point_bits;
                point_out <= point;
                last      <= final_point;
                state     <= final_point ? DRAIN : cut_point ? CLOSE : RUN;
            end
            CLOSE: if (free) begin
                valid   <= 1'b1;
                last    <= 1'b1;
                stopped <= 1'b1;
                outputs <= 4'd0;
                state   <= DRAIN;
            end
            DRAIN: if (ready) begin
                state <= IDLE;
                done  <= 1'b1;
            end
            default: ;
        endcase
        if (rst || state == IDLE) stopping <= 1'b0;
        if (rst) begin
            state    <= IDLE;
            valid    <= 1'b0;
            done     <= 1'b0;
            compared <= 1'b0;
        end
    end

    wire unused = &{1'b0, root_q[WORD-1], ds_round, rounded[15:0], t_next[11:0]};
endmodule

`default_nettype wire
