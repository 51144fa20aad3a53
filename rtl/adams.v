// SPDX-License-Identifier: MIT
/*
 * The paper's Adams module (Fig. 6): the next u by Eq. (17), from four slopes. Three arrangements, the same bits:
 *   0  serial    one row gives four quotients in turn, the oldest first: eight points a step, as the paper counts
 *                them; the points of a quotient are evaluated while the slope of the one before is still on its way
 *   1  parallel  four rows at once, as drawn in Fig. 6
 *   2  cached    one row gives the newest slope from one new point; what came before stays in registers
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction. Points: WORD bits an axis in two's complement.
 *           s: the distance of a period over 24, WORD - 1 bits without sign, 8 more fraction bits than a coordinate.
 *           K: WORD bits in two's complement, 8 more fraction bits than u: what u moves in 1/24 of a period.
 * Rounding  the next u once, to nearest, halves up; it is kept between the ends of the knot range.
 * Latency   one order (four that overlap if serial), and 1 cycle if cached, else 2.
 * Flags     the rows'.
 *
 * push stores the step that ends, and may come at any time while busy is low. start is sampled while busy is low; the
 * caller holds the operands until done, which is high for one cycle. The point of the first row is then C(u).
 */
`default_nettype none

module adams #(
    // Width of a coordinate: odd, 5 to 35.
    parameter integer WORD        = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM         = 3,
    // 0 serial, 1 parallel, 2 cached.
    parameter integer ARRANGEMENT = 2,
    // 4 for parallel, else 1.
    parameter integer ROWS        = 1
) (
    input  wire                     clk,
    input  wire                     rst,
    input  wire                     push,
    input  wire [DIM*WORD-1:0]      push_point,
    input  wire signed [WORD-1:0]   push_k,
    output wire [WORD-2:0]          u_before,
    output wire [DIM*WORD-1:0]      point_before,
    input  wire                     start,
    input  wire [WORD-2:0]          u,
    input  wire [WORD-2:0]          s,
    output wire                     busy,
    output wire                     done,
    output wire signed [WORD-1:0]   k,
    output wire [WORD-2:0]          u_next,
    output wire                     overflow,
    output wire                     by_zero,
    // To the rows.
    output reg                      row_start,
    output wire [ROWS*(WORD-1)-1:0] row_u_a,
    output wire [ROWS*(WORD-1)-1:0] row_u_b,
    output wire [ROWS*(WORD-1)-1:0] row_s,
    output wire [ROWS*WORD-1:0]     row_du,
    output wire [DIM*WORD-1:0]      row_base,
    // From the rows.
    input  wire                     row_taken,
    input  wire [ROWS-1:0]          row_done,
    input  wire [ROWS*WORD-1:0]     row_k,
    input  wire                     row_overflow,
    input  wire                     row_by_zero
);
    generate if (ARRANGEMENT < 0 || ARRANGEMENT > 2) begin : check_arrangement
        adams_ARRANGEMENT_must_be_0_serial_1_parallel_or_2_cached stop ();
    end
    if (DIM != 2 && DIM != 3) begin : check_dim
        adams_DIM_must_be_2_or_3 stop ();
    end
    if (ROWS != (ARRANGEMENT == 1 ? 4 : 1)) begin : check_rows
        adams_ROWS_must_be_4_for_parallel_and_1_otherwise stop ();
    end endgenerate

    reg            working;
    reg [1:0]      turn;  // of the answers; serial: 3 - which quotient
    wire           turn_done, last_turn, ask_again;
    reg [WORD-2:0] u_1;   // of the step before
    wire signed [WORD-1:0] k_1, k_2, k_3;
    reg            any_overflow, any_by_zero; // of the turns before
    wire           overflow_now = any_overflow | row_overflow;
    wire           by_zero_now  = any_by_zero | row_by_zero;
    wire           ends         = working && turn_done && last_turn;

    // A quotient of the one row answers at once, without a register.
    localparam DIRECT = ARRANGEMENT == 2;
    reg ended;
    always @(posedge clk) ended <= ends && !rst;
    assign done     = DIRECT ? ends : ended;
    assign overflow = DIRECT ? overflow_now : any_overflow;
    assign by_zero  = DIRECT ? by_zero_now : any_by_zero;

    assign busy     = working && !done;
    assign u_before = u_1;

    ui_out #(.WORD(WORD), .ADAMS(1)) ui_out_inst (.u(u), .k_0(k), .k_1(k_1), .k_2(k_2), .k_3(k_3), .u_next(u_next));

    always @(posedge clk) begin
        row_start <= 1'b0;
        if (push) u_1 <= u;
        if (!working && start) begin
            working      <= 1'b1;
            turn         <= 2'd0;
            row_start    <= 1'b1;
            any_overflow <= 1'b0;
            any_by_zero  <= 1'b0;
        end
        if (working && turn_done) begin
            turn         <= turn + 2'd1;
            any_overflow <= overflow_now;
            any_by_zero  <= by_zero_now;
            working      <= !last_turn;
        end
        if (working && ask_again) row_start <= 1'b1;
        if (rst) begin
            working   <= 1'b0;
            row_start <= 1'b0;
        end
    end

    genvar i;
    generate if (ARRANGEMENT == 2) begin : cached
        reg [DIM*WORD-1:0]    point_1;
        reg signed [WORD-1:0] old_1, old_2, old_3;
        always @(posedge clk) if (push) begin
            point_1               <= push_point;
            {old_3, old_2, old_1} <= {old_2, old_1, push_k};
        end
        assign {k_3, k_2, k_1} = {old_3, old_2, old_1};
        assign k               = row_k;
        assign turn_done       = row_done;
        assign point_before    = point_1;
        assign row_u_a         = u;
        assign row_u_b         = u;
        assign row_s           = s;
        assign row_du          = {1'b0, u} - {1'b0, u_1};
        assign row_base        = point_1;
        assign last_turn       = 1'b1;
        assign ask_again       = 1'b0;
        wire unused_taken      = &{1'b0, row_taken};
    end else begin : anew
        reg [WORD-2:0] u_2, u_3, u_4, s_1, s_2, s_3;
        always @(posedge clk) if (push) begin
            {u_4, u_3, u_2} <= {u_3, u_2, u_1};
            {s_3, s_2, s_1} <= {s_2, s_1, s};
        end
        wire [4*(WORD-1)-1:0] newer = {u_3, u_2, u_1, u};
        wire [4*(WORD-1)-1:0] older = {u_4, u_3, u_2, u_1};
        wire [4*(WORD-1)-1:0] all_s = {s_3, s_2, s_1, s};
        reg  [4*WORD-1:0]     all_k;
        assign {k_3, k_2, k_1, k} = all_k;
        assign point_before = {DIM*WORD{1'b0}};
        assign row_base     = {DIM*WORD{1'b0}};
        wire unused_kept    = &{1'b0, push_point, push_k};

        wire [1:0] asked; // serial: orders given before this one
        for (i = 0; i < ROWS; i = i + 1) begin : row
            wire [1:0] ends_of  = ARRANGEMENT == 1 ? i : ~asked;
            wire [1:0] slope_of = ARRANGEMENT == 1 ? i : ~turn;
            assign row_u_a[i*(WORD-1)+:WORD-1] = newer[ends_of*(WORD-1)+:WORD-1];
            assign row_u_b[i*(WORD-1)+:WORD-1] = older[ends_of*(WORD-1)+:WORD-1];
            assign row_s[i*(WORD-1)+:WORD-1]   = all_s[slope_of*(WORD-1)+:WORD-1];
            assign row_du[i*WORD+:WORD]        = {1'b0, newer[slope_of*(WORD-1)+:WORD-1]}
                                               - {1'b0, older[slope_of*(WORD-1)+:WORD-1]};
            // The parallel rows write their parts by constants: a synthesizer takes a variable index for all of it.
            if (ARRANGEMENT == 1) begin : own
                always @(posedge clk) if (row_done[i]) all_k[i*WORD+:WORD] <= row_k[i*WORD+:WORD];
            end else begin : in_turn
                always @(posedge clk) if (row_done[i]) all_k[slope_of*WORD+:WORD] <= row_k[i*WORD+:WORD];
            end
        end

        if (ARRANGEMENT == 1) begin : parallel
            // The rows finish together or a search apart.
            reg [3:0] finished;
            always @(posedge clk) finished <= working ? finished | row_done : 4'd0;
            assign turn_done = &(finished | row_done);
            assign last_turn = 1'b1;
            assign ask_again = 1'b0;
            assign asked     = 2'd0;
            wire unused      = &{1'b0, row_taken};
        end else begin : serial
            assign turn_done = row_done;
            assign last_turn = turn == 2'd3;
            assign ask_again = row_taken && asked != 2'd3;
            reg [1:0] orders;
            assign asked     = orders;
            always @(posedge clk) orders <= working ? orders + {1'b0, row_taken} : 2'd0;
        end
    end endgenerate
endmodule

`default_nettype wire
