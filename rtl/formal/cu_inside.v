// SPDX-License-Identifier: MIT
    // Read inside cu, by its proof: every start while busy is low is answered by one done, in the order of the
    // starts, at most two are owed, and two only while busy; at done, point and out_of_range are those of its own u:
    // its products, and no others, made the sums, from its own N; the point and the flags then hold until another
    // point is on its way or another curve is loaded.
    reg              fresh = 0, calm = 0;                 // a reset was; none, nor a load, in the cycle before
    reg  [1:0]       accepted = 0, finished = 0;          // starts and dones, modulo 4: a point is known by its number
    reg  [1:0]       of_1 = 0, of_2 = 0, of_3 = 0, of_n = 0; // whose the products in the stages and the N are
    reg  [1:0]       outside_of = 0;                      // whether u lay outside, for the latest even and odd number
    reg  [2:0]       age = 7;                             // cycles since the latest start, at most 7
    reg  [1:0]       summing = 0;                         // sums that this point has asked for, at most 3
    reg              dividing = 0;                        // all sums are there, not yet all quotients
    reg [DIM*WORD+2:0] answer_was;
    wire [1:0]       owed   = accepted - finished;
    wire [1:0]       oldest = finished + 2'd1;
    wire [1:0]       axis_0 = rational ? WEIGHT : 0;      // whose sum comes first
    wire             ends_1 = tag_1[9] && tag_1[7], ends_2 = tag_2[9] && tag_2[7], ends_3 = sum_3 && final_3;
    wire             first_1 = tag_1[14] && tag_1[5:2] == 0, first_2 = tag_2[14] && tag_2[5:2] == 0,
                     first_ratio_3 = ratio_3 && number_3 == 0;
    always @(posedge clk) begin
        fresh      <= 1;
        calm       <= fresh && !rst && !load;
        answer_was <= {point, out_of_range, overflow, by_zero};
        of_1       <= accepted + begins;
        of_2       <= of_1;
        of_3       <= of_2;
        age        <= begins ? 1 : age == 7 ? 7 : age + 1;
        summing    <= begins ? 0 : summing == 3 ? 3 : summing + issue_sum;
        dividing   <= (summed && rational) || (dividing && !done);
        if (first_ratio_3) of_n <= of_3;
        if (begins) begin
            accepted <= accepted + 1;
            outside_of[!accepted[0]] <= u < first_u || u > last_u;
        end
        if (done) finished <= finished + 1;
        if (rst) {accepted, finished, of_1, of_2, of_3} <= 0;
        if (rst) {age, dividing} <= 4'b111_0;
    end
    always @* begin
        // Of the loader: it writes while nothing is on its way, and a degree that load_guard accepts.
        assume (!load || (owed == 0 && !start));
        assume (!begins || (degree >= 1 && degree <= 5));
    end
    always @* if (fresh && !rst) begin
        assert (owed <= 2);
        if (done) assert (owed != 0);
        if (owed == 2) assert (busy);
        if (owed == 0) assert (!busy && (!calm || {point, out_of_range, overflow, by_zero} == answer_was));
        if (done) assert (out_of_range == outside_of[oldest[0]]);
        if (sum_3) assert (of_3 == oldest);
        if (ratio_1) assert (of_1 == accepted);
        if (tag_1[13] || tag_1[9]) assert (of_n == of_1);
        // What makes these inductive: where the last sum of each point is.
        if (owed != 0) assert (degree >= 1 && degree <= 5);
        assert (rational || state != DIVIDE);
        if (!rational) assert (owed == (state != IDLE) + ends_1 + ends_2 + ends_3 + summed);
        if (rational) assert (owed == (state != IDLE));
        if (rational) assert ((state == DIVIDE) == ends_1 + ends_2 + ends_3 + summed + dividing);
        if (rational) assert (ends_1 + ends_2 + ends_3 + summed + dividing <= 1);
        if (!rational) assert (!dividing);
        if (summed || dividing) assert (out_of_range == outside_of[oldest[0]]);
        if (ends_1) assert (state == IDLE || state == DIVIDE);
        if (ends_2) assert (state == IDLE || state == DIVIDE || age == 1);
        if (ends_3) assert (state == IDLE || state == DIVIDE || age <= 2);
        if (summed) assert (state == IDLE || state == DIVIDE || age <= 3);
        if (ends_2 || ends_3 || summed || dividing || owed == 0) assert (!tag_1[9]);
        if (ends_3 || summed || dividing || owed == 0) assert (!tag_2[9]);
        if (summed || dividing || owed == 0) assert (!sum_3);
        // The stages hold this point's products, and sums of the one before until it is 3 cycles old.
        assert (of_1 == accepted && of_2 == accepted - (age < 2) && of_3 == accepted - (age < 3));
        if (age < 2 || state == IDLE || state == DIVIDE) assert (tag_2[14:13] == 0);
        if (age < 3 || state == IDLE || state == DIVIDE) assert (tag_3[14:13] == 0);
        if (state == IDLE || state == DIVIDE) assert (tag_1[14:13] == 0 && age >= 4);
        if (state == IDLE && owed != 0) assert (age >= 5);
        assert (age != 0);
        if (state == IDLE || state == DIVIDE) assert (r == 0 && level == 1 && number == 0);
        if (tag_1[9]) assert (age >= 4 && tag_1[6] == outside_of[of_1[0]]);
        if (tag_2[9]) assert ((age >= 5 || age < 2) && tag_2[6] == outside_of[of_2[0]]);
        if (sum_3) assert ((age >= 6 || age < 3) && outside_3 == outside_of[of_3[0]]);
        if (state != IDLE) assert (outside == outside_of[accepted[0]]);
        // The way through the states, and where the first ratio is, from which the N begin.
        assert ((age == 1) == (state == CHECK));
        if (state == CHECK) assert (first_1 && slot == 1 && number == 1 && level == 2 && r == 0 && !tag_1[9]);
        if (state == READ || state == COMPARE) assert (slot == 0 && number == 0 && level == 1 && r == 0 && age >= 2);
        if (state == READ || state == COMPARE) assert (!tag_1[14] && !tag_1[13] && !tag_1[9]);
        if (state == RATIO) assert (slot <= 2 && age >= 2 && !tag_1[13] && !tag_1[9]);
        if (state == RATIO && slot == 0) assert (number == 0 && level == 1 && r == 0 && age >= 3);
        if (state == RATIO && slot == 1) assert (first_1 && age >= 3);
        if (state == RATIO && slot == 2) assert (first_2 || first_ratio_3 || of_n == accepted);
        if (state == LEVEL) assert ((first_ratio_3 || of_n == accepted) && age >= 3 && axis == axis_0 && !tag_1[9]);
        if (state == SUM) assert ((first_ratio_3 || of_n == accepted) && age >= 3);
        if (state != SUM && state != IDLE && state != DIVIDE) assert (summing == 0);
        if (state == SUM && summing == 0) assert (!tag_1[9] && r == 0 && axis == axis_0);
        if (state == SUM && summing == 1) assert (axis == axis_0 && r == 1);
        if (state == SUM && summing >= 1) assert (tag_1[14:13] == 0);
        if (state == SUM && summing >= 2) assert (tag_2[14:13] == 0);
        if (state == SUM && summing == 3) assert (tag_3[14:13] == 0);
        if (state == SUM && summing == 2) assert (axis == axis_0 + (r == 0) && (r == 0 ? degree == 1 : r == 2));
        if (state == SUM) assert (r <= degree);
        cover (done && out_of_range && owed == 2);
        cover (summed && state == READ && !rational);
        cover (done && state == SUM);
        cover (done && rational && overflow);
    end
    generate if (RATIONAL != 0) begin : quotients
        // The divider gets each axis once, after its sum; the last one ends the point.
        wire [1:0] all      = LAST_AXIS + 2'd1;
        wire [1:0] before_3 = axis_3 == WEIGHT ? 0 : axis_3, before_2 = tag_2[1:0] == WEIGHT ? 0 : tag_2[1:0],
                   before_1 = tag_1[1:0] == WEIGHT ? 0 : tag_1[1:0];
        wire [1:0] made_3   = sum_3 && last_3 && axis_3 != WEIGHT ? axis_3 + 1 : weights.made,
                   made_2   = tag_2[9] && tag_2[8] && tag_2[1:0] != WEIGHT ? tag_2[1:0] + 1 : made_3,
                   made_1   = tag_1[9] && tag_1[8] && tag_1[1:0] != WEIGHT ? tag_1[1:0] + 1 : made_2;
        always @* if (fresh && !rst) begin
            assert (weights.taken <= weights.made && weights.made <= all);
            if (owed != 0) assert ((weights.made == all) == (rational && (summed || dividing)));
            if (dividing) assert (weights.divider_busy || weights.divider_done || weights.next);
            if (weights.divider_busy || (weights.divider_done && owed != 0)) assert (weights.taken != 0);
            if (owed == 0) assert (!weights.next && !weights.divider_busy);
            if (!rational && owed != 0) assert (weights.made == 0 && !weights.divider_busy && !weights.divider_done);
            assert (!(weights.divider_busy && weights.divider_done));
            // As many sums are there as axes have left the stages.
            if (rational && sum_3) assert (weights.made == before_3 && final_3 == (last_3 && axis_3 == LAST_AXIS));
            if (rational && tag_2[9]) assert (made_3 == before_2 && tag_2[7] == (tag_2[8] && tag_2[1:0] == LAST_AXIS));
            if (rational && tag_1[9]) assert (made_2 == before_1 && tag_1[7] == (tag_1[8] && tag_1[1:0] == LAST_AXIS));
            if (rational && state == SUM)
                assert (made_1 == (axis == WEIGHT ? 0 : axis) && (axis == WEIGHT || axis <= LAST_AXIS));
            if (state != SUM && state != DIVIDE && state != IDLE)
                assert (weights.made == 0 && !(rational && (tag_1[9] || tag_2[9] || sum_3)));
        end
    end endgenerate
