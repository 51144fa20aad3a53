/*
 * Steps along the loaded curve: four steps by runge_kutta, the rest by adams, each corrected if asked to; the last
 * parameter is exactly the end of the curve.
 *
 * Format    u, points and speeds as in cu.v and vt.v.
 * Rounding  none of its own.
 * Latency   counted in the benches and listed in README.md.
 * Flags     overflow, by_zero: of any unit; backward: a step would go back. The run stops there with a last point.
 *           They are of the latest run.
 *
 * go is heeded while busy is low. Points leave by valid and ready; last marks the final one. done is high for one
 * clock after it has been taken, never with busy. Load bus, while busy is low: spaces 0 to 3 as in cu.v, 4 as in
 * vt.v; space 5: 0 number of periods, after which the curve ends at the latest; 1 trials of the corrector; 2 and 3 du
 * and chord of the first slope, whose quotient is |C'| at the start.
 */
`default_nettype none

module stepper #(
    // As in cu.v.
    parameter WORD        = 35,
    parameter DIM         = 3,
    parameter MAX_POINTS  = 64,
    parameter RATIONAL    = 1,
    // As in adams.v.
    parameter ARRANGEMENT = 2,
    parameter HISTORY     = 0
) (
    input  wire                clk,
    input  wire                rst,
    input  wire                load,
    input  wire [2:0]          load_space,
    input  wire [9:0]          load_index,
    input  wire [WORD+14:0]    load_data,
    input  wire                go,
    output wire                busy,
    output reg                 done,
    output reg                 overflow,
    output reg                 by_zero,
    output reg                 backward,
    output reg                 valid,
    input  wire                ready,
    output reg  [WORD-2:0]     u_out,
    output reg  [DIM*WORD-1:0] point_out,
    output reg                 last
);
    localparam ROWS = ARRANGEMENT == 1 ? 4 : 1;

    reg [31:0]     periods;
    reg [2:0]      trials;
    reg [WORD-2:0] first_du, first_chord, first_u, last_u;
    always @(posedge clk) if (load) case ({load_space, load_index[1:0]})
        {3'd3, 2'd1}: first_u     <= load_data[WORD-2:0];
        {3'd3, 2'd2}: last_u      <= load_data[WORD-2:0];
        {3'd5, 2'd0}: periods     <= load_data[31:0];
        {3'd5, 2'd1}: trials      <= load_data[2:0];
        {3'd5, 2'd2}: first_du    <= load_data[WORD-2:0];
        {3'd5, 2'd3}: first_chord <= load_data[WORD-2:0];
        default: ;
    endcase

    localparam [2:0] IDLE = 3'd0, SPEED = 3'd1, STEP = 3'd2, CORRECT = 3'd3, OFFER = 3'd4, END_POINT = 3'd5,
                     END_OFFER = 3'd6, DRAIN = 3'd7;
    reg [2:0]             state;
    reg [31:0]            step;
    reg [WORD-2:0]        u;
    reg [DIM*WORD-1:0]    point;
    reg signed [WORD-1:0] k;
    reg                   end_start;
    wire                  starting = step < 32'd4; // by Runge-Kutta
    assign busy = state != IDLE;

    // ---- Speed.

    wire            vt_busy;
    wire [WORD-2:0] s_now, s_half, s_whole;
    wire            finish_step; // the point has been handed over
    vt #(.WORD(WORD)) vt_inst (
        .clk(clk), .rst(rst), .load(load && load_space == 3'd4), .load_index(load_index[2:0]),
        .load_data(load_data), .start(go && !busy), .advance(finish_step), .busy(vt_busy), .now(s_now),
        .half(s_half), .whole(s_whole)
    );

    // ---- The two methods, the corrector, and the rows they share: one of them works at a time.

    wire                  begin_step = state == SPEED && !vt_busy;
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
    runge_kutta #(.WORD(WORD), .DIM(DIM), .CACHED(ARRANGEMENT == 2)) runge_kutta_inst (
        .clk(clk), .rst(rst), .start(begin_step && starting), .first(step == 32'd0), .u(u), .u_before(u_before),
        .point_before(point_before), .s_now(s_now), .s_half(s_half), .s_whole(s_whole), .first_du(first_du),
        .first_chord(first_chord), .busy(rk_busy), .done(rk_done), .point_done(rk_point_done), .k(rk_k), .u_next(rk_next),
        .overflow(rk_overflow), .by_zero(rk_by_zero), .row_start(rk_start), .row_want_a(rk_want_a),
        .row_want_b(rk_want_b), .row_given(rk_given), .row_half(rk_half), .row_whole(rk_whole), .row_s(rk_s),
        .row_du(rk_du), .row_base(rk_base), .row_done(row_done[0]), .row_k(row_k[WORD-1:0]),
        .row_overflow(row_overflow[0]), .row_by_zero(row_by_zero[0])
    );

    wire                  ab_busy, ab_done, ab_overflow, ab_by_zero;
    wire signed [WORD-1:0] ab_k;
    wire [WORD-2:0]       ab_next;
    wire                  ab_start, ab_want_a, ab_want_b, ab_want_k, ab_given;
    wire [ROWS*(WORD-1)-1:0] ab_u_a, ab_u_b, ab_s;
    wire [ROWS*WORD-1:0]  ab_du;
    wire [DIM*WORD-1:0]   ab_base;
    adams #(.WORD(WORD), .DIM(DIM), .ARRANGEMENT(ARRANGEMENT), .HISTORY(HISTORY), .ROWS(ROWS)) adams_inst (
        .clk(clk), .rst(rst), .push(finish_step), .push_point(point), .push_k(k), .u_before(u_before),
        .point_before(point_before), .start(begin_step && !starting), .u(u), .s(s_now), .busy(ab_busy),
        .done(ab_done), .k(ab_k), .u_next(ab_next), .overflow(ab_overflow), .by_zero(ab_by_zero),
        .row_start(ab_start), .row_want_a(ab_want_a), .row_want_b(ab_want_b), .row_want_k(ab_want_k),
        .row_given(ab_given), .row_u_a(ab_u_a), .row_u_b(ab_u_b), .row_s(ab_s), .row_du(ab_du), .row_base(ab_base),
        .row_taken(row_taken[0]), .row_done(row_done), .row_point(row_point), .row_k(row_k),
        .row_overflow(|row_overflow),
        .row_by_zero(|row_by_zero)
    );

    wire                  step_done = rk_done || ab_done;
    wire                  co_busy, co_done, co_overflow, co_by_zero;
    wire [WORD-2:0]       u_next;
    wire                  co_start;
    wire [WORD-2:0]       co_s;
    wire signed [WORD-1:0] co_du;
    corrector #(.WORD(WORD)) corrector_inst (
        .clk(clk), .rst(rst), .start(step_done), .trials(trials), .u(u), .last_u(last_u),
        .predicted(starting ? rk_next : ab_next), .s_now(s_now), .s_half(s_half), .s_whole(s_whole), .busy(co_busy),
        .done(co_done), .guess(u_next), .overflow(co_overflow), .by_zero(co_by_zero), .row_start(co_start),
        .row_s(co_s), .row_du(co_du), .row_done(row_done[0]), .row_k(row_k[WORD-1:0]),
        .row_overflow(row_overflow[0]), .row_by_zero(row_by_zero[0])
    );

    wire stepping = state == STEP;
    wire by_rk    = stepping && starting;
    wire by_ab    = stepping && !starting;
    wire correct  = state == CORRECT;
    genvar i;
    generate for (i = 0; i < ROWS; i = i + 1) begin : row
        wire [DIM*WORD-1:0] a_point;
        wire                row_busy;
        // Only adams knows more rows than the first.
        wire here = i == 0;
        slope #(
            .WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL), .PAIR(ARRANGEMENT == 1)
        ) slope_inst (
            .clk(clk), .rst(rst), .load(load && !load_space[2]), .load_space(load_space[1:0]),
            .load_index(load_index), .load_data(load_data[WORD+2:0]),
            .start(ab_start || (here && (rk_start || co_start || end_start))),
            .want_a(by_rk ? rk_want_a : by_ab ? ab_want_a : 1'b1),
            .want_b(by_rk ? rk_want_b : by_ab && ab_want_b),
            .want_k(by_ab ? ab_want_k : by_rk || correct),
            .given(by_rk ? rk_given : by_ab && ab_given),
            .u_a(by_ab ? ab_u_a[i*(WORD-1)+:WORD-1] : by_rk ? u : correct ? u_next : last_u),
            .u_b(by_ab ? ab_u_b[i*(WORD-1)+:WORD-1] : u_before),
            .shift(row_k[i*WORD+:WORD]), .shift_half(by_rk && rk_half), .shift_whole(by_rk && rk_whole),
            .s(by_rk ? rk_s : by_ab ? ab_s[i*(WORD-1)+:WORD-1] : co_s),
            .du(by_rk ? rk_du : by_ab ? ab_du[i*WORD+:WORD] : co_du),
            .base(by_rk ? rk_base : by_ab ? ab_base : point),
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

    wire free    = !valid || ready;
    wire failed  = overflow || by_zero || backward;
    wire arrived = u_next >= last_u || step + 32'd1 == periods;
    assign finish_step = state == OFFER && free && !failed;

    always @(posedge clk) begin
        done      <= 1'b0;
        end_start <= 1'b0;
        if (ready) valid <= 1'b0;
        if (rk_point_done || ab_done) point <= row_point;
        case (state)
            IDLE: if (go) begin
                state    <= SPEED;
                step     <= 32'd0;
                u        <= first_u;
                overflow <= 1'b0;
                by_zero  <= 1'b0;
                backward <= 1'b0;
            end
            SPEED: if (!vt_busy) state <= STEP;
            STEP: if (step_done) begin
                state    <= CORRECT;
                k        <= starting ? rk_k : ab_k;
                overflow <= starting ? rk_overflow : ab_overflow;
                by_zero  <= starting ? rk_by_zero : ab_by_zero;
            end
            CORRECT: if (co_done) begin
                state    <= OFFER;
                overflow <= overflow || co_overflow;
                by_zero  <= by_zero || co_by_zero;
                backward <= u_next < u;
            end
            OFFER: if (free) begin
                valid     <= 1'b1;
                u_out     <= u;
                point_out <= point;
                last      <= failed;
                step      <= step + 32'd1;
                u         <= u_next;
                end_start <= arrived && !failed;
                state     <= failed ? DRAIN : arrived ? END_POINT : SPEED;
            end
            END_POINT: if (row_done[0]) begin
                state    <= END_OFFER;
                overflow <= row_overflow[0];
                by_zero  <= row_by_zero[0];
            end
            END_OFFER: if (free) begin
                valid     <= 1'b1;
                u_out     <= last_u;
                point_out <= row_point;
                last      <= 1'b1;
                state     <= DRAIN;
            end
            DRAIN: if (ready) begin
                state <= IDLE;
                done  <= 1'b1;
            end
        endcase
        if (rst) begin
            state     <= IDLE;
            valid     <= 1'b0;
            done      <= 1'b0;
            end_start <= 1'b0;
        end
    end

    wire unused = &{1'b0, rk_busy, ab_busy, co_busy};
endmodule

`default_nettype wire
