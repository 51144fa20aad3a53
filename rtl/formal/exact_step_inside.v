// SPDX-License-Identifier: MIT
    // Read inside exact_step, by its proof; written from its header and the formulas of the step, after Horner, in the
    // order of the operands. The products are stood in for by {a, b}, one behind the other, so that each operand is
    // seen wherever it goes. 17 or 24 cycles from a start to done, once; the answer stays.
    (* anyconst *) reg [5*WORD-1:0] metrics;
    reg  [2:0]   asked;
    reg          works = 0, due = 0, ran = 0;
    reg  [4:0]   cycles = 0;
    wire         over = works && cycles == (cubic ? 23 : 16);
    always @(posedge clk) begin
        asked  <= coefficient;
        works  <= !rst && (works ? !over : start);
        cycles <= works ? cycles + 1 : 1;
        due    <= !rst && over;
        ran    <= !rst && (ran ? !(start && !works) : over);
    end
    always @* if (!rst) assume (metric == metrics[asked*WORD+:WORD]);

    // A product rounded to bits fraction bits, halves up.
    function signed [TW-1:0] by(input signed [WORD-1:0] a, b, input integer bits);
        reg signed [2*WORD-1:0] wide;
        begin
            wide = {a, b};
            wide = wide + (64'sd1 <<< (bits - 1));
            by = wide >>> bits;
        end
    endfunction
    function signed [WORD-1:0] tf(input signed [WORD-1:0] a, b);
        tf = by(a, b, TF);
    endfunction
    function signed [WORD-1:0] ef(input signed [WORD-1:0] a, b);
        ef = by(a, b, EF);
    endfunction

    // ---- The step.

    wire signed [WORD-1:0] d0 = metrics[0+:WORD], d1 = metrics[WORD+:WORD], d2 = metrics[2*WORD+:WORD],
                           d3 = metrics[3*WORD+:WORD], d4 = metrics[4*WORD+:WORD];
    wire [2*WORD-1:0]      along  = {1'b0, ds, 1'b0, y} >> shift;
    wire [TW-1:0]          r_p      = along, r_middle = t + r_p / 2; // of t, with guard bits
    wire signed [WORD-1:0] r_p_word = r_p >> 12;
    wire signed [WORD-1:0] r_m      = r_middle >> (TW - 1) != 0 ? (1 << TF) - 1 : r_middle >> 12;
    wire signed [WORD-1:0] r_yy = ef(y, y), r_w = tf(r_p_word, r_yy), r_ty = tf(r_m, r_yy);
    wire signed [WORD-1:0] q  = tf(cubic ? d4 : d2, r_m); // |C'|^2 and its derivatives at the midpoint: b, c, e
    wire signed [WORD-1:0] r_b3 = q + d3, r_c3 = q + r_b3, r_e3 = q + r_c3;
    wire signed [WORD-1:0] r_b2 = tf(r_b3, r_m) + d2, r_c2 = tf(r_c3, r_m) + r_b2,
                           r_e2 = cubic ? tf(r_e3, r_m) + r_c2 : d2;
    wire signed [WORD-1:0] r_b1 = cubic ? tf(r_b2, r_m) + d1 : q + d1, r_c1 = cubic ? tf(r_c2, r_m) + r_b1 : q + r_b1;
    wire signed [WORD-1:0] r_h  = (1 << EF) - ef(d0, r_yy) - ef(r_b1, r_ty);
    wire signed [WORD-1:0] r_x  = ef(r_c1, r_w), r_v = ef(tf(r_e2, r_p_word), r_w), r_xx = ef(r_x, r_x);
    wire signed [WORD-1:0] h3x = (r_h <<< 1) + r_h - r_x, r_more = ef(r_h, h3x) >>> 3;
    // From here on of the registers, once they are known to be right.
    wire signed [WORD-1:0] xxx = (xx <<< 1) + xx, r_both = (h >>> 1) + (cubic ? h_more : r_more);
    wire signed [WORD-1:0] four = (v <<< 2) - xx;
    wire signed [WORD-1:0] c_0 = four >>> 7, c_1 = c_0 + (c_0 >>> 2), c_2 = c_1 + (c_1 >>> 4),
                           r_of_t = r_both - (c_2 + (c_2 >>> 8)); // four / 96, as 4/3 / 128
    wire signed [WORD-1:0] r_of_y = r_both - (x >>> 1) + (xxx >>> 3) - (v >>> 1);
    wire [TW-1:0]          t_due = t + r_p + by(r_p_word, r_of_t, EF - 12);
    wire [WORD-2:0]        y_due = y + ef(y, r_of_y);
    always @* if (!rst) begin
        assert (busy == works && done == due);
        if (works) assert (cycle == cycles && cycles <= (cubic ? 23 : 16));
        // Steps on the way, in the cycles in which they are there, make the rest quick to see.
        if (ran || (works && cycles > 3)) assert (p == r_p && m == r_m && yy == r_yy);
        if (works && cycles > 6) assert (w == r_w);
        if (works && cubic && cycles > 6) assert (c3 == r_c3 && e3 == r_e3);
        if (works && cycles > 7) assert (ty == r_ty);
        if (works && cycles > 8) assert (d0yy == ef(d0, r_yy));
        if (works && cycles > (cubic ? 12 : 6)) assert (b1 == r_b1);
        if (works && cubic && cycles > 9) assert (b2 == r_b2);
        if (works && cubic && cycles > 10) assert (c2 == r_c2);
        if (ran || (works && cycles > (cubic ? 15 : 10))) assert (h == r_h);
        if (ran || (works && cycles > (cubic ? 16 : 9))) assert (x == r_x);
        if (ran || (works && cycles > (cubic ? 19 : 12))) assert (xx == r_xx);
        if (cubic && (ran || (works && cycles > 19))) assert (h_more == r_more);
        if (ran || (works && cycles > (cubic ? 17 : 12))) assert (v == r_v);
        if (works && cycles == (cubic ? 16 : 10)) assert (a_1 == r_h && a_2 == h3x);
        if (works && cycles == 12 && !cubic) assert (a_ef == r_v && b_ef == r_xx);
        if (works && cycles == 11 && cubic) assert (b_1 == r_e2 && b_2 == r_p_word);
        if (works && cycles == 14 && cubic) assert (b_1 == tf(r_e2, r_p_word) && b_2 == r_w);
        if (works && cycles == 16 && cubic) assert (b_ef == r_x);
        if (works && cycles == 17 && cubic) assert (b_ef == r_v);
        if (works && cycles == 19 && cubic) assert (b_ef == r_xx && a_ef == ef(r_h, h3x));
        if (works && cycles == (cubic ? 20 : 13)) assert (a_1 == r_p_word && a_2 == r_of_t);
        if (works && cycles == (cubic ? 20 : 13)) assert (b_1 == y && b_2 == r_of_y);
        if (ran) assert (t_next == t_due);
        if (ran) assert (y_next == y_due);
        if (ran) assert (unsettled == (r_h < -(1 << (EF - 4)) || r_h >= (1 << (EF - 4))));
        cover (done && !unsettled);
        cover (done && unsettled);
    end
