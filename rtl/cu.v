// SPDX-License-Identifier: MIT
/*
 * The paper's module cu: the point C(u) of a loaded NURBS curve, by the Cox-de Boor recurrence.
 *
 * Every ratio of the recurrence is (u - knot) * reciprocal: the reciprocals of the knot differences are loaded with
 * the curve, so one multiplier does all the work and only weights need a division. A level of the recurrence splits
 * each N into a share N * ratio and the rest, so the N add up to exactly 1 at every level.
 *
 * Format    u, knots, N, weights: WORD - 2 fraction bits, from 0 to 1. Coordinates: WORD bits in two's complement,
 *           binary point chosen by the loader. Control points are loaded as (w x, w y, w z, w), weights at most 1.
 * Rounding  to nearest after each product and each sum of products, halves up; the division as in divide.v.
 * Latency   from start to done, while u stays in the span of the point before: 2 + max(p (p + 1) / 2, 3) + p (p + 1)
 *           / 2 + (p + 1) per coordinate: 14 cycles for degree 2 in the plane. With weights the sum of the weight
 *           comes first, and each coordinate is divided while the next is summed: 2 + max(p (p + 1) / 2, 3) + p (p +
 *           1) / 2 + 2 (p + 1), and a division per coordinate: 52 for degree 3 in space. The multiplier never waits,
 *           but for degree 1. A change of span costs 3 cycles and 2 for each halving of the spans. Without weights
 *           busy is low 3 cycles before done.
 * Flags     out_of_range: u lay outside the domain, the point is that of the nearer end; overflow and by_zero: of the
 *           division by the weight. All three are of the latest point.
 *
 * start is sampled while busy is low; u is read with it. The next point may start while the last sums of this one are
 * still on their way; done is high for one cycle for each, in their order, and a point holds until the sums of the
 * next. The load bus may write while nothing is on its way:
 *   space 0  knot, at index
 *   space 1  1 / (knot[index + level] - knot[index]) at {level - 1, index[6:0]}, as {exponent[3:0], mantissa}: it is
 *            mantissa * 2^(exponent - WORD + 2) with the mantissa from 2^(WORD-2) to 2^(WORD-1) - 1
 *   space 2  coordinate of a control point, at {index[5:0], coordinate[1:0]}; coordinate 3 is the weight
 *   space 3  shape: {rational, last point[6:0], degree[2:0]} at 0, first u at 1, last u at 2
 *
 * What is loaded has to keep these limits, which no flag tells: degree 1 to 5, knots from 0 to 1 that never decrease,
 * first and last span not empty, no other shorter than 2^-15, weights from 1/1024, the largest 1. Room is left for
 * rounding: the largest coordinate times 1 + 2^(3-WORD) / (smallest weight) fits. Reciprocals are rounded to nearest;
 * where the difference is 0 nothing is loaded, as it is not read.
 */
`default_nettype none

module cu #(
    // Width of a coordinate: odd, 17 to 35.
    parameter integer WORD       = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM        = 3,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL   = 1
) (
    input  wire                clk,
    input  wire                rst,
    input  wire                load,
    input  wire [1:0]          load_space,
    input  wire [9:0]          load_index,
    input  wire [WORD+2:0]     load_data,
    input  wire                start,
    input  wire [WORD-2:0]     u,
    output wire                busy,
    output wire                done,
    output wire [DIM*WORD-1:0] point,
    output reg                 out_of_range,
    output wire                overflow,
    output wire                by_zero
);
    localparam FRACTION = WORD - 2;
    localparam [WORD-2:0] ONE = {1'b1, {FRACTION{1'b0}}};
    localparam [1:0] LAST_AXIS = DIM == 3 ? 2'd2 : 2'd1;
    localparam [1:0] WEIGHT = 2'd3;

    generate if (WORD % 2 == 0 || WORD < 17 || WORD > 35) begin : check_word
        cu_WORD_must_be_odd_and_from_17_to_35 stop ();
    end
    if (DIM < 2 || DIM > 3) begin : check_dim
        cu_DIM_must_be_2_or_3 stop ();
    end
    if (MAX_POINTS < 2 || MAX_POINTS > 64) begin : check_points
        cu_MAX_POINTS_must_be_from_2_to_64 stop ();
    end endgenerate

    // ---- The curve.

    reg [WORD-2:0] knots [0:MAX_POINTS+5];
    reg [WORD+2:0] reciprocals [0:639];
    reg [WORD-1:0] points [0:4*MAX_POINTS-1];
    reg [2:0]      degree;
    reg [6:0]      last_point;
    reg            weighted;
    reg [WORD-2:0] first_u, last_u;
    wire           rational = RATIONAL != 0 && weighted;

    always @(posedge clk) begin
        if (load && load_space == 2'd0) knots[load_index[6:0]] <= load_data[WORD-2:0];
        if (load && load_space == 2'd1) reciprocals[load_index] <= load_data;
        if (load && load_space == 2'd2) points[load_index[7:0]] <= load_data[WORD-1:0];
        if (load && load_space == 2'd3) begin
            if (load_index[1:0] == 2'd0) {weighted, last_point, degree} <= load_data[10:0];
            if (load_index[1:0] == 2'd1) first_u <= load_data[WORD-2:0];
            if (load_index[1:0] == 2'd2) last_u <= load_data[WORD-2:0];
        end
    end

    // ---- Stage 0: find the span, then issue one product a cycle in the order of the recurrence.

    localparam [2:0] IDLE = 3'd0, CHECK = 3'd1, READ = 3'd2, COMPARE = 3'd3, RATIO = 3'd4, LEVEL = 3'd5, SUM = 3'd6,
                     DIVIDE = 3'd7;
    reg [2:0]      state;
    reg [WORD-2:0] u_reg;
    reg [6:0]      span, span_limit; // candidates of the search; then span is the answer
    reg [WORD-2:0] lower, upper;     // its knots; 0 and the largest number at the ends of the curve
    reg            span_known;
    reg            outside;          // the u that is being worked on
    wire           span_holds = span_known && lower <= u_reg && u_reg < upper;
    wire [7:0]     middle     = ({1'b0, span} + {1'b0, span_limit} + 8'd1) >> 1;

    reg [2:0] level;  // of the recurrence
    reg [2:0] r;      // which N
    reg [3:0] number; // of the ratio
    reg [1:0] axis;
    reg [1:0] slot;   // ratios asked for, up to 3

    // The first ratio is asked for with the start, as if the span were that of the point before.
    wire begins        = start && !busy;
    wire lost          = state == CHECK && !span_holds;
    wire issue_ratio   = begins || ((state == RATIO || state == CHECK) && !lost && level <= degree);
    wire issue_level   = state == LEVEL;
    wire issue_sum     = state == SUM;
    wire last_r        = issue_sum ? r == degree : r + 3'd1 == level;
    wire last_axis     = axis == LAST_AXIS;

    // The knot and reciprocal of a ratio take two cycles: while one ratio is issued the next one is read, and those of
    // the first ratio stand ready at any other time. At the end of the search middle is span, as the first ratio
    // needs.
    wire       read_next     = begins || state == RATIO || state == CHECK;
    wire [6:0] next_address  = span - {4'd0, level} + (last_r ? 7'd0 : {4'd0, r} + 7'd2);
    wire [6:0] knot_address  = state == READ ? middle[6:0] : read_next ? next_address : span;
    wire [2:0] level_address = !read_next ? 3'd0 : last_r ? level : level - 3'd1;
    wire [5:0] point_address = span[5:0] - {3'd0, degree} + {3'd0, r};

    assign busy = state != IDLE && !(state == DIVIDE && done);

    // ---- Stage 1: what the memories answer meets N at the multiplier.

    // N but the last of its level, which has a register: so each has one place to be written and one to be read.
    reg [WORD-2:0] n [0:4];
    reg [WORD-2:0] n_last;
    reg [WORD-2:0] ratios [0:15];
    reg [WORD-2:0] knot_read, knot_q, ratio_q;
    reg [WORD+2:0] reciprocal_read, reciprocal_q;
    reg [WORD-1:0] point_q;
    reg [14:0]     tag_1, tag_2, tag_3; // what a product is, travelling with it
    reg [WORD-2:0] held_2, held_3;      // the N that a share is taken from, travelling too; ONE at the first ratio

    wire            ratio_1, level_1, last_1;
    wire [2:0]      r_1;
    wire [3:0]      number_1;
    wire [4:0]      unused_1;
    assign {ratio_1, level_1, r_1, unused_1[4], last_1, unused_1[3:2], number_1, unused_1[1:0]} = tag_1;

    // ---- Stage 3, after the multiplier's stages: where a product goes.

    wire       ratio_3, level_3, sum_3, last_3, final_3, outside_3;
    wire [2:0] r_3;
    wire [3:0] number_3;
    wire [1:0] axis_3;
    assign {ratio_3, level_3, r_3, sum_3, last_3, final_3, outside_3, number_3, axis_3} = tag_3;
    wire [2*WORD-1:0] product;

    localparam [2*WORD-1:0] HALF = {{WORD+2{1'b0}}, 1'b1, {FRACTION-1{1'b0}}};
    wire [WORD-2:0]   share = product[FRACTION+:WORD-1] + {{WORD-2{1'b0}}, product[FRACTION-1]};
    reg  [WORD-2:0]   carried; // share of the N before; 0 at the first of a level
    reg  [2*WORD-1:0] total;   // begins with the half that rounds it

    // The N less its share, rounded in the same addition: to add ~x + 1 is to subtract x, and the 1 falls away if x
    // rounds up.
    wire              made_n   = level_3 || (ratio_3 && number_3 == 4'd0);
    wire [WORD-2:0]   n_before = held_3 + carried;
    wire [WORD-1:0]   less     = {n_before, 1'b1} + {~product[FRACTION+:WORD-1], !product[FRACTION-1]};
    wire [WORD-2:0]   n_new    = less[WORD-1:1];

    wire [2*WORD-1:0] total_next = product + total;
    reg  [WORD-1:0]   sums [0:3];
    reg               summed;  // all of them

    // A ratio or an N that has just been made goes to the multiplier at once.
    wire [WORD-2:0] distance = u_reg - knot_q;
    wire [WORD-2:0] ratio_now = ratio_3 && number_3 == number_1 ? share : ratio_q;
    wire [WORD-2:0] n_now     = last_1 ? n_last : level_3 && r_3 == r_1 ? n_new : n[r_1];
    wire [WORD-1:0] a = {1'b0, ratio_1 ? distance << reciprocal_q[WORD+2:WORD-1] : n_now};
    wire [WORD-1:0] b = ratio_1 ? {1'b0, reciprocal_q[WORD-2:0]} : level_1 ? {1'b0, ratio_now} : point_q;
    multiply #(.WORD(WORD), .LATENCY(2)) multiply_inst (.clk(clk), .a(a), .b(b), .product(product));

    always @(posedge clk) begin
        knot_read       <= knots[knot_address];
        reciprocal_read <= reciprocals[{level_address, knot_address}];
        knot_q          <= knot_read;
        reciprocal_q    <= reciprocal_read;
        ratio_q         <= ratios[number];
        point_q         <= points[{point_address, axis}];
        tag_1 <= {issue_ratio, issue_level, r, issue_sum, last_r, last_r && last_axis, outside, number, axis};
        tag_2 <= lost ? 15'd0 : tag_1;
        tag_3 <= tag_2;

        held_2 <= ratio_1 ? ONE : n_now;
        held_3 <= held_2;
        if (ratio_3) ratios[number_3] <= share;
        if (made_n) n[r_3] <= n_new;
        if (made_n && last_3) n_last <= share;
        carried <= level_3 && !last_3 ? share : {WORD-1{1'b0}};
        if (sum_3) total <= total_next;
        if (rst || (sum_3 && last_3)) total <= HALF;
        if (sum_3 && last_3) sums[axis_3] <= total_next[FRACTION+:WORD];
        summed <= sum_3 && final_3;
        if (sum_3 && final_3) out_of_range <= outside_3;
        if (rst) {tag_1, tag_2, tag_3, summed} <= 46'd0;
    end

    // ---- The weight, whose sum comes first, divides: one divider takes the axes in turn.

    wire [DIM*WORD-1:0] plain;
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : sum
        assign plain[i*WORD+:WORD] = sums[i];
    end
    if (RATIONAL == 0) begin : polynomial
        assign done                = summed;
        assign point               = plain;
        assign {overflow, by_zero} = 2'b00;
    end else begin : weights
        reg  [1:0]      made, taken;  // axes whose sum is there, and those that the divider has got
        reg             earlier_overflow, earlier_by_zero;
        wire            divider_busy, divider_done, divider_overflow, divider_by_zero;
        wire [WORD-1:0] quotient;
        wire            next  = made != taken && !divider_busy;
        wire            whole = taken == LAST_AXIS + 2'd1; // the divider has the last axis
        divide #(.WORD(WORD)) divide_inst (
            .clk(clk), .rst(rst), .start(next),
            .numerator({{2{sums[taken][WORD-1]}}, sums[taken], {FRACTION{1'b0}}}), .denominator(sums[WEIGHT]),
            .busy(divider_busy), .done(divider_done), .quotient(quotient), .overflow(divider_overflow),
            .by_zero(divider_by_zero)
        );
        always @(posedge clk) begin
            if (sum_3 && last_3 && rational && axis_3 != WEIGHT) made <= axis_3 + 2'd1;
            if (next) begin
                taken <= taken + 2'd1;
                {earlier_overflow, earlier_by_zero} <=
                    taken == 2'd0 ? 2'b00 : {earlier_overflow || divider_overflow, earlier_by_zero || divider_by_zero};
            end
            if (begins || rst) {made, taken} <= 4'd0;
        end
        assign done     = rational ? divider_done && whole : summed;
        assign overflow = rational && (earlier_overflow || divider_overflow);
        assign by_zero  = rational && (earlier_by_zero || divider_by_zero);

        // A quotient stays with the divider until it takes the next axis.
        reg  [(DIM-1)*WORD-1:0] quotients;
        for (i = 0; i < DIM - 1; i = i + 1) begin : axis_of
            localparam [1:0] NEXT = i + 1;
            always @(posedge clk) if (next && taken == NEXT) quotients[i*WORD+:WORD] <= quotient;
        end
        assign point = rational ? {quotient, quotients} : plain;
    end endgenerate

    always @(posedge clk) begin
        if (!busy) begin
            state <= IDLE;
            if (begins) begin
                state        <= CHECK;
                u_reg        <= u < first_u ? first_u : u > last_u ? last_u : u;
                outside      <= u < first_u || u > last_u;
                slot         <= 2'd1;
                number       <= 4'd1;
                level        <= 3'd2;
            end
        end else case (state)
            READ: begin
                span_known <= 1'b1;
                state      <= span == span_limit ? RATIO : COMPARE;
            end
            COMPARE: begin
                state <= READ;
                if (knot_read <= u_reg) begin
                    span  <= middle[6:0];
                    lower <= knot_read;
                end else begin
                    span_limit <= middle[6:0] - 7'd1;
                    upper      <= knot_read;
                end
            end
            CHECK, RATIO: begin
                state <= RATIO;
                if (slot != 2'd2) slot <= slot + 2'd1;
                if (issue_ratio) begin
                    number <= number + 4'd1;
                    r      <= last_r ? 3'd0 : r + 3'd1;
                    level  <= last_r ? level + 3'd1 : level;
                end
                // The first N is there three cycles after its ratio was asked for.
                if (slot == 2'd2 && (level > degree || (last_r && level == degree))) begin
                    state  <= degree == 3'd1 ? SUM : LEVEL;
                    level  <= 3'd2;
                    r      <= 3'd0;
                    number <= 4'd1;
                    axis   <= rational ? WEIGHT : 2'd0;
                end
                if (lost) begin
                    state      <= READ;
                    slot       <= 2'd0;
                    level      <= 3'd1;
                    number     <= 4'd0;
                    span       <= {4'd0, degree};
                    span_limit <= last_point;
                    lower      <= {WORD-1{1'b0}};
                    upper      <= {WORD-1{1'b1}};
                end
            end
            LEVEL: begin
                r      <= last_r ? 3'd0 : r + 3'd1;
                number <= number + 4'd1;
                if (last_r) begin
                    state <= level == degree ? SUM : LEVEL;
                    level <= level + 3'd1;
                end
            end
            SUM: begin
                r <= last_r ? 3'd0 : r + 3'd1;
                if (last_r) axis <= axis + 2'd1;
                if (last_r && last_axis) begin
                    state  <= rational ? DIVIDE : IDLE;
                    level  <= 3'd1;
                    r      <= 3'd0;
                    number <= 4'd0;
                end
            end
            default: ; // DIVIDE
        endcase
        if (load) span_known <= 1'b0;
        if (rst) begin
            state      <= IDLE;
            span_known <= 1'b0;
            level      <= 3'd1;
            r          <= 3'd0;
            number     <= 4'd0;
        end
    end

    wire unused = &{1'b0, unused_1, middle[7], less[0]};
endmodule

`default_nettype wire
