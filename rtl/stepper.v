// SPDX-License-Identifier: MIT
/*
 * Steps along the loaded curve: four steps by Runge-Kutta, the rest by Adams-Bashforth; the last parameter is exactly
 * the end of the curve.
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction. Points: WORD bits an axis in two's complement,
 *           binary point chosen by the loader. A slope K is what u moves in 1/24 of a period: it overflows where a
 *           period would move u by more than 3/16 of the knot range.
 * Rounding  none of its own.
 * Latency   at WORD = 35, DIM = 2, degree 2, without weights: 41 cycles a step by Adams, 195 by
 *           Runge-Kutta (cached arrangement), once the next point is taken at once.
 * Flags     faults, of the latest run: [0] overflow and [1] by_zero of any unit, [2] backward: u decreased,
 *           [3] too_far: an axis would move by more than the largest step, [4] beyond: an axis would leave its limits.
 *           A point that raises a flag, or comes after one, never leaves.
 *
 * go is sampled while busy and stop are low. Points leave by a valid/ready handshake; last marks the final beat. A run
 * that a fault or a stop has ended ends with a beat marked void: it repeats the point before (zeros if there was
 * none), and nothing is to move. done is high for one cycle after the final beat has been taken, never with busy.
 * stop is sampled in every cycle of a run: no point that was not yet offered leaves after it.
 * Load bus, while busy is low: spaces 0 to 3 as in cu.v, 4 as in vt.v; space 5: 0 number of periods, after which the
 * curve ends at the latest; 2 and 3 du and chord of the first slope, whose quotient is |C'|
 * at the start; 4 and above the limits, as in soft_limits.v.
 */
`default_nettype none

module stepper #(
    // Width of a coordinate: odd, 17 to 35.
    parameter integer WORD        = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM         = 3,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS  = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL    = 1,
    // Of the Adams step: 0 serial, 1 parallel, 2 cached.
    parameter integer ARRANGEMENT = 2
) (
    input  wire                clk,
    input  wire                rst,
    input  wire                load,
    input  wire [2:0]          load_space,
    input  wire [9:0]          load_index,
    input  wire [WORD+26:0]    load_data,
    input  wire                go,
    input  wire                stop,
    output wire                busy,
    output reg                 done,
    output wire [4:0]          faults,
    output reg                 valid,
    input  wire                ready,
    output reg  [WORD-2:0]     u_out,
    output reg  [DIM*WORD-1:0] point_out,
    output reg                 last,
    output reg                 stopped
);
    localparam ROWS = ARRANGEMENT == 1 ? 4 : 1;

    reg [31:0]     periods;
    reg [WORD-2:0] first_du, first_chord, first_u, last_u;
    always @(posedge clk) if (load) case ({load_space, load_index[3:0]})
        {3'd3, 4'd1}: first_u     <= load_data[WORD-2:0];
        {3'd3, 4'd2}: last_u      <= load_data[WORD-2:0];
        {3'd5, 4'd0}: periods     <= load_data[31:0];
        {3'd5, 4'd2}: first_du    <= load_data[WORD-2:0];
        {3'd5, 4'd3}: first_chord <= load_data[WORD-2:0];
        default: ;
    endcase

    localparam [3:0] IDLE = 4'd0, STEP = 4'd1, OFFER = 4'd2, END_POINT = 4'd3, END_WAIT = 4'd4,
                     END_CHECK = 4'd5, END_OFFER = 4'd6, CLOSE = 4'd7, DRAIN = 4'd8;
    reg [3:0]             state;
    reg [31:0]            step;
    reg [WORD-2:0]        u, u_next;
    reg [DIM*WORD-1:0]    point;
    reg signed [WORD-1:0] k;
    reg                   end_start;
    reg                   starting; // by Runge-Kutta: step is below 4
    reg                   first;    // step is 0
    assign busy = state != IDLE;
    wire                  clear    = rst || (stop && state != DRAIN); // of all units below

    // ---- Speed.

    wire            vt_busy; // shorter than a step, so nobody waits for it
    wire            vt_overflow;
    wire [WORD-2:0] s_now, s_half, s_whole;
    wire            finish_step; // the point has been handed over
    vt #(.WORD(WORD)) vt_inst (
        .clk(clk), .rst(clear), .load(load && load_space == 3'd4), .load_index(load_index),
        .load_data(load_data), .start(go && !busy), .advance(finish_step), .busy(vt_busy), .now(s_now),
        .half(s_half), .whole(s_whole), .overflow(vt_overflow)
    );

    // ---- The two methods, and the rows they share: one of them works at a time.

    wire                  arrived;
    wire                  begin_rk = (go && !busy && !stop) || (finish_step && !arrived && step < 32'd3);
    wire                  begin_ab = finish_step && !arrived && step >= 32'd3;
    wire [WORD-2:0]       u_before;
    wire [DIM*WORD-1:0]   point_before;

    wire [ROWS-1:0]       row_taken, row_done, row_overflow, row_by_zero;
    wire [DIM*WORD-1:0]   row_point;
    wire [ROWS*WORD-1:0]  row_k;

    wire                  rk_busy, rk_done, rk_overflow, rk_by_zero;
    wire                  rk_point_done;
    wire signed [WORD-1:0] rk_k;
    wire [WORD-2:0]       rk_next;
    wire                  rk_start, rk_want_a, rk_want_b, rk_given, rk_half, rk_whole;
    wire [WORD-2:0]       rk_s;
    wire signed [WORD-1:0] rk_du;
    wire [DIM*WORD-1:0]   rk_base;
    wire signed [WORD-1:0] rk_shift;
    runge_kutta #(.WORD(WORD), .DIM(DIM), .CACHED(ARRANGEMENT / 2)) runge_kutta_inst (
        .clk(clk), .rst(clear), .start(begin_rk), .first(first), .u(u), .u_before(u_before),
        .point_before(point_before), .s_now(s_now), .s_half(s_half), .s_whole(s_whole), .first_du(first_du),
        .first_chord(first_chord), .busy(rk_busy), .done(rk_done), .point_done(rk_point_done), .k(rk_k),
        .u_next(rk_next),
        .overflow(rk_overflow), .by_zero(rk_by_zero), .row_start(rk_start), .row_want_a(rk_want_a),
        .row_want_b(rk_want_b), .row_given(rk_given), .row_half(rk_half), .row_whole(rk_whole), .row_s(rk_s),
        .row_du(rk_du), .row_base(rk_base), .row_shift(rk_shift), .row_done(row_done[0]), .row_k(row_k[WORD-1:0]),
        .row_overflow(row_overflow[0]), .row_by_zero(row_by_zero[0])
    );

    wire                  ab_busy, ab_done, ab_overflow, ab_by_zero;
    wire signed [WORD-1:0] ab_k;
    wire [WORD-2:0]       ab_next;
    wire                  ab_start;
    wire [ROWS*(WORD-1)-1:0] ab_u_a, ab_u_b, ab_s;
    wire [ROWS*WORD-1:0]  ab_du;
    wire [DIM*WORD-1:0]   ab_base;
    adams #(.WORD(WORD), .DIM(DIM), .ARRANGEMENT(ARRANGEMENT), .ROWS(ROWS)) adams_inst (
        .clk(clk), .rst(clear), .push(finish_step), .push_point(point), .push_k(k), .u_before(u_before),
        .point_before(point_before), .start(begin_ab), .u(u), .s(s_now), .busy(ab_busy),
        .done(ab_done), .k(ab_k), .u_next(ab_next), .overflow(ab_overflow), .by_zero(ab_by_zero),
        .row_start(ab_start), .row_u_a(ab_u_a), .row_u_b(ab_u_b), .row_s(ab_s), .row_du(ab_du), .row_base(ab_base),
        .row_taken(row_taken[0]), .row_done(row_done), .row_k(row_k),
        .row_overflow(|row_overflow), .row_by_zero(|row_by_zero)
    );

    wire                  step_done = rk_done || ab_done;

    // The choice of the points is on the longest path, so registers make it.
    wire by_rk   = rk_busy;
    reg  by_ab;
    genvar i;
    generate for (i = 0; i < ROWS; i = i + 1) begin : row
        wire [DIM*WORD-1:0] a_point;
        wire                row_busy;
        // Only adams knows more rows than the first, and it shifts nothing.
        wire here = i == 0;
        wire rk   = here && by_rk;
        wire ab   = !here || by_ab;
        slope #(
            .WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL), .PAIR(ARRANGEMENT % 2)
        ) slope_inst (
            .clk(clk), .rst(clear), .load(load && !load_space[2]), .load_space(load_space[1:0]),
            .load_index(load_index), .load_data(load_data[WORD+2:0]),
            .start(ab_start || (here && (rk_start || end_start))),
            .want_a(!rk || rk_want_a),
            .want_b(rk ? rk_want_b : ab && ARRANGEMENT != 2),
            .want_k(ab || rk),
            .given(rk && rk_given),
            .u_a(ab ? ab_u_a[i*(WORD-1)+:WORD-1] : rk ? u : last_u),
            .u_b(ab ? ab_u_b[i*(WORD-1)+:WORD-1] : u_before),
            .shift(rk_shift), .shift_half(here && rk_half), .shift_whole(here && rk_whole),
            .s(rk ? rk_s : ab_s[i*(WORD-1)+:WORD-1]),
            .du(rk ? rk_du : ab_du[i*WORD+:WORD]),
            .base(rk ? rk_base : ab_base),
            .busy(row_busy), .taken(row_taken[i]), .done(row_done[i]), .point(a_point), .k(row_k[i*WORD+:WORD]),
            .overflow(row_overflow[i]), .by_zero(row_by_zero[i])
        );
        if (i == 0) begin : newest
            assign row_point = a_point;
        end else begin : older
            wire unused = &{1'b0, a_point, row_taken[i]};
        end
        wire unused = &{1'b0, row_busy};
    end endgenerate

    // ---- The run.

    reg  overflow, by_zero, backward, too_far, beyond;
    reg  sent; // a point of this run
    wire far_now, beyond_now, bound_beyond;
    soft_limits #(.WORD(WORD), .DIM(DIM)) soft_limits_inst (
        .clk(clk), .load(load && load_space == 3'd5), .load_index(load_index[3:0]), .load_data(load_data[WORD-1:0]),
        .bound(3'd0), .bound_beyond(bound_beyond), .point(point), .point_before(point_out), .too_far(far_now),
        .beyond(beyond_now)
    );
    assign faults = {beyond, too_far, backward, by_zero, overflow};

    wire free    = !valid || ready;
    wire back_now = state == OFFER && u_next < u;
    wire computed = overflow || by_zero || back_now; // a fault of the arithmetic: its point means nothing
    wire failed  = computed || beyond_now || (far_now && sent);
    assign arrived = u_next >= last_u || step + 32'd1 == periods;
    assign finish_step = state == OFFER && free && !failed && !stop;

    always @(posedge clk) begin
        done      <= 1'b0;
        end_start <= 1'b0;
        if (ready) valid <= 1'b0;
        by_ab <= !clear && (begin_ab || (by_ab && !step_done));
        // By Adams the row's latest point is C(u), long before the slope is there.
        if (rk_point_done || by_ab || state == END_POINT) point <= row_point;
        if (stop && busy && state != CLOSE && state != DRAIN) begin
            state <= CLOSE;
        end else case (state)
            IDLE: if (go && !stop) begin
                state    <= STEP;
                step     <= 32'd0;
                starting <= 1'b1;
                first    <= 1'b1;
                u        <= first_u;
                overflow <= 1'b0;
                by_zero  <= 1'b0;
                backward <= 1'b0;
                too_far  <= 1'b0;
                beyond   <= 1'b0;
                sent     <= 1'b0;
                stopped  <= 1'b0;
                u_out    <= {WORD-1{1'b0}};
                point_out <= {DIM*WORD{1'b0}};
            end
            STEP: if (step_done) begin
                state    <= OFFER;
                k        <= starting ? rk_k : ab_k;
                u_next   <= starting ? rk_next : ab_next;
                overflow <= vt_overflow || (starting ? rk_overflow : ab_overflow);
                by_zero  <= starting ? rk_by_zero : ab_by_zero;
            end
            OFFER: if (failed) begin
                state    <= CLOSE;
                backward <= back_now;
                too_far  <= !computed && far_now && sent;
                beyond   <= !computed && beyond_now;
            end
            END_POINT: if (row_done[0]) begin
                state    <= END_WAIT;
                overflow <= row_overflow[0];
                by_zero  <= row_by_zero[0];
            end
            END_WAIT: state <= END_CHECK;
            END_CHECK: state <= END_OFFER;
            END_OFFER: if (failed) begin
                state   <= CLOSE;
                too_far <= !computed && far_now;
                beyond  <= !computed && beyond_now;
            end else if (free) begin
                valid     <= 1'b1;
                u_out     <= last_u;
                point_out <= point;
                last      <= 1'b1;
                state     <= DRAIN;
            end
            CLOSE: if (free) begin
                valid <= 1'b1;
                last  <= 1'b1;
                stopped  <= 1'b1;
                state <= DRAIN;
            end
            DRAIN: if (ready) begin
                state <= IDLE;
                done  <= 1'b1;
            end
            default: ;
        endcase
        if (finish_step) begin
            valid     <= 1'b1;
            sent      <= 1'b1;
            u_out     <= u;
            point_out <= point;
            last      <= 1'b0;
            step      <= step + 32'd1;
            starting  <= step < 32'd3;
            first     <= 1'b0;
            u         <= u_next;
            end_start <= arrived;
            state     <= arrived ? END_POINT : STEP;
        end
        if (rst) begin
            state     <= IDLE;
            valid     <= 1'b0;
            done      <= 1'b0;
            end_start <= 1'b0;
        end
    end

    wire unused = &{1'b0, bound_beyond, vt_busy, ab_busy};
endmodule

`default_nettype wire
