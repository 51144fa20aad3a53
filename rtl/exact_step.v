// SPDX-License-Identifier: MIT
/*
 * A step of a given arc length on one polynomial piece, by the exact |C'|: t and y = 1 / |C'| go in, both after the
 * step come out.
 *
 * The midpoint of the step is foreseen from y. There |C'|^2 and its two derivatives are evaluated by Horner's scheme,
 * and the reciprocal root is corrected instead of computed: with h = 1 - |C'|^2 y^2 the step of t is
 *   p (1 + h/2 + h (3 h - x) / 8 - c),  p = ds y,  x = (|C'|^2)' y^2 p,  c = ((|C'|^2)'' y^2 p^2) / 48 - x^2 / 96,
 * in which c is the third-order term of the arc length about the midpoint. The error is of fourth order in the step.
 *
 * Format    t: from 0 to 1, WORD + 11 fraction bits; below, "t word" is its upper WORD - 1. ds: WORD - 1 bits without
 *           sign. y, |C'|^2 and what is relative: WORD - 5 fraction bits, below 16. shift brings ds y to the bits of
 *           t. By the loader's scale |C'|^2 is from 1/15 to 1, and its derivatives are below 15.
 * Rounding  products to nearest, halves up; p, h / 2 and the small correction downwards.
 * Latency   17 cycles from start to done for degree 2 (cubic low), 24 for degree 3.
 * Flags     unsettled: h is 1/16 or more, or less than -1/16, so the step turns too much for one correction.
 *
 * start is sampled while busy is low; the caller holds the operands until done, which is high for one cycle.
 * coefficient asks for the coefficients of |C'|^2, which are to be on metric in the next cycle.
 */
`default_nettype none

module exact_step #(
    // Width of a word: odd, 25 to 35.
    parameter integer WORD = 35
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   start,
    input  wire                   cubic,
    input  wire [WORD+11:0]       t,
    input  wire [WORD-2:0]        y,
    input  wire [WORD-2:0]        ds,
    input  wire [5:0]             shift,
    output reg  [2:0]             coefficient,
    input  wire signed [WORD-1:0] metric,
    output wire                   busy,
    output reg                    done,
    output reg  [WORD+11:0]       t_next,
    output reg  [WORD-2:0]        y_next,
    output reg                    unsettled
);
    generate if (WORD % 2 == 0 || WORD < 25 || WORD > 35) begin : check_word
        exact_step_WORD_must_be_odd_and_from_25_to_35 stop ();
    end endgenerate

    localparam TF = WORD - 1;  // fraction bits of a t word
    localparam EF = WORD - 5;  // of all that is relative
    localparam TW = WORD + 12; // bits of t
    localparam signed [WORD-1:0] ONE = {5'b00001, {EF{1'b0}}};

    reg        working;
    reg  [4:0] cycle; // of the step
    wire [4:0] now  = working ? cycle : 5'd0;
    wire [4:0] last = cubic ? 5'd23 : 5'd16;
    assign busy = working;

    // ---- Two multipliers, and their products rounded to the two formats in use.

    reg  signed [WORD-1:0]   a_1, a_2, b_1, b_2;
    wire signed [2*WORD-1:0] a, b;
    multiply #(.WORD(WORD)) multiply_a (.clk(clk), .a(a_1), .b(a_2), .product(a));
    multiply #(.WORD(WORD)) multiply_b (.clk(clk), .a(b_1), .b(b_2), .product(b));

    localparam signed [2*WORD-1:0] HALF_TF = {{WORD+1{1'b0}}, 1'b1, {TF-1{1'b0}}};
    localparam signed [2*WORD-1:0] HALF_EF = {{WORD+5{1'b0}}, 1'b1, {EF-1{1'b0}}};
    localparam signed [2*WORD-1:0] HALF_T  = {{WORD+17{1'b0}}, 1'b1, {EF-13{1'b0}}};
    wire signed [2*WORD-1:0] round_a_tf = a + HALF_TF, round_a_ef = a + HALF_EF, round_a_t = a + HALF_T,
                             round_b_tf = b + HALF_TF, round_b_ef = b + HALF_EF;
    wire signed [WORD-1:0]   a_tf = round_a_tf[TF+:WORD], a_ef = round_a_ef[EF+:WORD],
                             b_tf = round_b_tf[TF+:WORD], b_ef = round_b_ef[EF+:WORD];
    wire signed [TW-1:0]     a_t  = round_a_t[EF-12+:TW];

    // ---- The first-order step, and the midpoint foreseen.

    wire [2*WORD-1:0]      moved  = a >> shift;
    wire [TW-1:0]          middle = t + {1'b0, moved[TW-1:1]};
    wire signed [WORD-1:0] m_now  = middle[TW-1] ? {1'b0, {TF{1'b1}}} : {1'b0, middle[12+:TF]};
    wire signed [WORD-1:0] p_now  = moved[12+:WORD];

    reg         [TW-1:0]   p;
    wire signed [WORD-1:0] p_word = p[12+:WORD];
    reg  signed [WORD-1:0] m, lead, yy, w, ty, d0yy;      // names as in the twin
    reg  signed [WORD-1:0] b1, b2, c2, c3, e3, h, x, v, xx, h_more;

    // ---- What is correct in the cycle that uses it.

    wire signed [WORD-1:0] horner  = a_tf + metric;
    wire signed [WORD-1:0] h_now   = ONE - d0yy - a_ef;
    wire signed [WORD-1:0] x_now   = cubic ? b_ef : x;
    wire signed [WORD-1:0] h_used  = cubic ? h : h_now;
    wire signed [WORD-1:0] more    = cubic ? h_more : a_ef >>> 3;
    wire signed [WORD-1:0] spread  = (v <<< 2) - xx;
    wire signed [WORD-1:0] part    = spread >>> 7;        // times 4/3 makes 1/96
    wire signed [WORD-1:0] part_2  = part + (part >>> 2);
    wire signed [WORD-1:0] part_3  = part_2 + (part_2 >>> 4);
    wire signed [WORD-1:0] third   = part_3 + (part_3 >>> 8);
    wire signed [WORD-1:0] both    = (h >>> 1) + more;
    wire signed [WORD-1:0] of_t    = both - third;
    wire signed [WORD-1:0] of_y    = both - (x >>> 1) + (((xx <<< 1) + xx) >>> 3) - (v >>> 1);

    always @* begin
        {a_1, a_2, b_1, b_2} = {4*WORD{1'b0}};
        case (now)
            5'd0: {a_1, a_2, b_1, b_2} = {1'b0, ds, 1'b0, y, 1'b0, y, 1'b0, y};
            5'd3: {a_1, a_2, b_1, b_2} = {metric, m_now, p_now, b_ef};
            5'd4: {b_1, b_2} = {m, yy};
            5'd5: {b_1, b_2} = {metric, yy};
            default: if (cubic) case (now)
                5'd6:  {a_1, a_2} = {horner, m};
                5'd7:  {a_1, a_2} = {c3, m};
                5'd8:  {a_1, a_2} = {e3, m};
                5'd9:  {a_1, a_2} = {horner, m};
                5'd10: {a_1, a_2} = {a_tf + b2, m};
                5'd11: {b_1, b_2} = {a_tf + c2, p_word};
                5'd12: {a_1, a_2} = {horner, ty};
                5'd13: {b_1, b_2} = {a_tf + b1, w};
                5'd14: {b_1, b_2} = {b_tf, w};
                5'd16: {a_1, a_2, b_1, b_2} = {h_used, (h_used <<< 1) + h_used - x_now, b_ef, b_ef};
                5'd20: {a_1, a_2, b_1, b_2} = {p_word, of_t, 1'b0, y, of_y};
                default: ;
            endcase else case (now)
                5'd6:  {a_1, a_2, b_1, b_2} = {lead, p_word, horner + a_tf, b_tf};
                5'd7:  {a_1, a_2} = {b1, b_tf};
                5'd9:  {a_1, a_2, b_1, b_2} = {a_tf, w, b_ef, b_ef};
                5'd10: {a_1, a_2} = {h_used, (h_used <<< 1) + h_used - x_now};
                5'd13: {a_1, a_2, b_1, b_2} = {p_word, of_t, 1'b0, y, of_y};
                default: ;
            endcase
        endcase
        case (now) // one cycle ahead
            5'd2:    coefficient = cubic ? 3'd4 : 3'd2;
            5'd4:    coefficient = 3'd0;
            5'd5:    coefficient = cubic ? 3'd3 : 3'd1;
            5'd8:    coefficient = 3'd2;
            default: coefficient = 3'd1;
        endcase
    end

    always @(posedge clk) begin
        done  <= 1'b0;
        cycle <= now + 5'd1;
        if (!working && start) working <= 1'b1;
        case (now)
            5'd3: begin
                p    <= moved[TW-1:0];
                m    <= m_now;
                lead <= metric;
                yy   <= b_ef;
            end
            5'd6: begin
                w  <= b_tf;
                b1 <= horner;
                c3 <= horner + a_tf;
                e3 <= horner + (a_tf <<< 1);
            end
            5'd7:  ty   <= b_tf;
            5'd8:  d0yy <= b_ef;
            5'd9: begin
                x  <= b_ef;
                b2 <= horner;
            end
            5'd10: begin
                h  <= h_now;
                c2 <= a_tf + b2;
            end
            5'd12: begin
                v  <= a_ef;
                xx <= b_ef;
                if (cubic) b1 <= horner;
            end
            5'd15: if (cubic) h <= h_now;
            5'd16: if (cubic) x <= b_ef;
            5'd17: v <= b_ef;
            5'd19: begin
                xx     <= b_ef;
                h_more <= a_ef >>> 3;
            end
            default: ;
        endcase
        if (working && now == last) begin
            working   <= 1'b0;
            done      <= 1'b1;
            t_next    <= t + p + a_t;
            y_next    <= y + b_ef[WORD-2:0];
            unsettled <= h[WORD-1:EF-4] != {9{h[WORD-1]}};
        end
        if (rst) begin
            working <= 1'b0;
            done    <= 1'b0;
        end
    end

    wire unused = &{1'b0, moved[2*WORD-1:TW], round_a_tf, round_a_ef, round_a_t, round_b_tf, round_b_ef, middle[11:0]};
endmodule

`default_nettype wire
