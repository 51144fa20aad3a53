// SPDX-License-Identifier: MIT
/*
 * A row of Figs. 5 and 6: the points at both ends of a quotient, then its slope. cu, cuk -> Kout.
 *
 * An order says what to do: evaluate A = C(u_a + shift); evaluate B = C(u_b + shift); take the slope. The chord of the
 * slope is A - B where B is evaluated, A - base where a point is kept from before, and base itself if `given`.
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction. shift: a slope K, WORD bits in two's
 *           complement, 8 more fraction bits than u, times 12 (half) or 24 (whole) or 0. Points: WORD bits an axis in
 *           two's complement. s: the distance of a period over 24, WORD - 1 bits without sign, 8 more fraction bits
 *           than a coordinate. k: as shift.
 * Rounding  none of its own.
 * Latency   that of the evaluations, 1 cycle, and that of kout. Both points at once with PAIR = 1; with PAIR = 0 the
 *           second starts while the sums of the first are on their way.
 * Flags     of the order that is done. overflow: a chord, a quotient by the weight or k does not fit a word; by_zero:
 *           a weight or the chord is 0.
 *
 * start is sampled while busy is low; done is high for one cycle for each order, in their turn. taken tells that the
 * chord of an order is with kout: then busy is low from the next cycle on, and the points of the next order may be
 * evaluated while kout still works. The points come in the order of their starts, as is proved of cu (formal/). The
 * caller holds the operands until taken, s and du until done, and gives an order without a slope only when no slope
 * is on its way.
 */
`default_nettype none

module slope #(
    // Width of a coordinate: odd, 17 to 35.
    parameter integer WORD       = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM        = 3,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL   = 1,
    // 1: two modules cuk side by side.
    parameter integer PAIR       = 0
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   load,
    input  wire [1:0]             load_space,
    input  wire [9:0]             load_index,
    input  wire [WORD+2:0]        load_data,
    input  wire                   start,
    input  wire                   want_a,
    input  wire                   want_b,
    input  wire                   want_k,
    input  wire                   given,
    input  wire [WORD-2:0]        u_a,
    input  wire [WORD-2:0]        u_b,
    input  wire signed [WORD-1:0] shift,
    input  wire                   shift_half,
    input  wire                   shift_whole,
    input  wire [WORD-2:0]        s,
    input  wire signed [WORD-1:0] du,
    input  wire [DIM*WORD-1:0]    base,
    output wire                   busy,
    output wire                   taken,
    output wire                   done,
    output reg  [DIM*WORD-1:0]    point,
    output wire signed [WORD-1:0] k,
    output wire                   overflow,
    output wire                   by_zero
);
    localparam [1:0] IDLE = 2'd0, POINTS = 2'd1, SECOND = 2'd2, CHORD = 2'd3;
    reg [1:0] state;
    reg       a_ready, b_ready; // evaluated

    wire [DIM*WORD-1:0] a_point, b_point;
    wire                a_done, a_overflow, a_by_zero, a_busy, b_done, b_overflow, b_by_zero, b_busy;
    wire                a_outside, b_outside; // the nearer end is what is wanted there
    wire                go = state == IDLE && start;
    wire                turn_of_b = PAIR == 0 && state == POINTS; // u is chosen before it is known if B starts
    wire                second_start = turn_of_b && want_b && !a_busy;

    cuk #(.WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL)) cuk_a (
        .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index), .load_data(load_data),
        .start((go && want_a) || second_start), .u(turn_of_b ? u_b : u_a), .k(shift), .half(shift_half),
        .whole(shift_whole), .busy(a_busy), .done(a_done), .point(a_point), .out_of_range(a_outside),
        .overflow(a_overflow), .by_zero(a_by_zero)
    );

    generate if (PAIR != 0) begin : pair
        cuk #(.WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL)) cuk_b (
            .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index),
            .load_data(load_data), .start(go && want_b), .u(u_b), .k(shift), .half(shift_half), .whole(shift_whole),
            .busy(b_busy), .done(b_done), .point(b_point), .out_of_range(b_outside), .overflow(b_overflow),
            .by_zero(b_by_zero)
        );
    end else begin : single // the point A moves to its register before B is made
        assign {b_busy, b_point, b_outside, b_overflow, b_by_zero} =
            {a_busy, a_point, a_outside, a_overflow, a_by_zero};
        assign b_done = a_ready && a_done;
    end endgenerate

    // ---- The chord, an axis at a time: a difference of two words fits if its two top bits agree.

    wire [DIM*WORD-1:0] chord;
    wire [DIM-1:0]      too_long;
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : axis
        wire signed [WORD-1:0] from = want_b ? b_point[i*WORD+:WORD] : base[i*WORD+:WORD];
        wire signed [WORD-1:0] to   = point[i*WORD+:WORD];
        wire        [WORD:0]   step = {to[WORD-1], to} - {from[WORD-1], from};
        assign too_long[i] = !given && step[WORD] != step[WORD-1];
        assign chord[i*WORD+:WORD] = given ? base[i*WORD+:WORD] : step[WORD-1:0];
    end endgenerate

    wire kout_busy, kout_done, kout_overflow, kout_by_zero;
    assign taken = state == CHORD && !kout_busy;
    kout #(.WORD(WORD), .DIM(DIM)) kout_inst (
        .clk(clk), .rst(rst), .start(taken), .s(s), .du(du), .chord(chord), .busy(kout_busy),
        .done(kout_done), .k(k), .overflow(kout_overflow), .by_zero(kout_by_zero)
    );

    wire a_now = a_done && !a_ready;
    wire ready = (a_ready || a_now) && (b_ready || b_done || !want_b);

    reg points_done, points_overflow, points_by_zero; // of the order whose points are evaluated
    reg chord_overflow, chord_by_zero;                // of the order that kout has
    assign busy     = state != IDLE;
    assign done     = points_done || kout_done;
    assign overflow = want_k ? chord_overflow || kout_overflow : points_overflow;
    assign by_zero  = want_k ? chord_by_zero || kout_by_zero : points_by_zero;

    always @(posedge clk) begin
        points_done <= 1'b0;
        if (a_now) begin
            point           <= a_point;
            a_ready         <= 1'b1;
            points_overflow <= a_overflow;
            points_by_zero  <= a_by_zero;
        end
        if (b_done) b_ready <= 1'b1;
        if (taken) begin
            chord_overflow <= points_overflow || |too_long || (want_b && b_overflow);
            chord_by_zero  <= points_by_zero || (want_b && b_by_zero);
        end
        case (state)
            IDLE: if (start) begin
                state           <= want_a ? POINTS : CHORD;
                a_ready         <= 1'b0;
                b_ready         <= 1'b0;
                points_overflow <= 1'b0;
                points_by_zero  <= 1'b0;
            end
            POINTS, SECOND: if (ready) begin
                state       <= want_k ? CHORD : IDLE;
                points_done <= !want_k;
            end else if (second_start) begin
                state <= SECOND;
            end
            CHORD: if (taken) state <= IDLE;
        endcase
        if (rst) begin
            state       <= IDLE;
            points_done <= 1'b0;
        end
    end

    wire unused = &{1'b0, b_busy, a_outside, b_outside};
endmodule

`default_nettype wire
