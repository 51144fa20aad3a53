// SPDX-License-Identifier: MIT
    // Read inside adams, by its proof; written from its header. The four latest steps are kept as they were pushed.
    // The quotient of lag i belongs to the points of the steps i and i + 1 before this one, with the distance of its
    // own step; ui_out gets the four slopes in their order, and a flag of any row is told.
    reg  [4*WORD-1:0]     us, ks;    // pushed: the latest lowest
    reg  [4*(WORD-1)-1:0] distances;
    reg  [DIM*WORD-1:0]   latest;
    reg                   began = 0; // what was kept before is unknown
    wire [WORD-1:0]       lags[0:4];
    assign lags[0] = u;
    wire [WORD-2:0]       of_lag[0:3];
    assign of_lag[0] = s;
    genvar j;
    generate for (j = 0; j < 4; j = j + 1) begin : lag
        assign lags[j+1] = us[j*WORD+:WORD];
        if (j < 3) begin : older
            assign of_lag[j+1] = distances[j*(WORD-1)+:WORD-1];
        end
    end endgenerate
    reg           asks = 0, works = 0, was_done = 0, fresh = 1;
    reg           wrong = 0, zero = 0;      // flags of this step
    reg  [2:0]    given = 0, took = 0, came = 0; // orders: begun, taken, answered
    reg  [WORD-1:0] slopes[0:3];           // of this step, by lag
    reg  [WORD-2:0] u_was, s_was;
    wire          begins = start && !works;
    wire [2:0]    orders = ARRANGEMENT == 0 ? 4 : 1;
    wire          answers = ARRANGEMENT == 1 ? &(rows_done | row_done) : row_done[0];
    reg  [ROWS-1:0] rows_done = 0;
    wire          ends_now = works && answers && came + 1 == orders;
    wire [1:0]    by_taken = 3 - took, by_came = 3 - came;
    integer n;
    always @(posedge clk) begin
        fresh <= rst;
        began <= 1;
        if (push) begin
            us        <= {us, {1'b0, u}};
            distances <= {distances, s};
            ks        <= {ks, push_k};
            latest    <= push_point;
        end
        asks  <= !rst && (begins || (ARRANGEMENT == 0 && works && row_taken && took != 3));
        works <= !rst && (begins || (works && !ends_now));
        was_done <= !rst && ends_now;
        {given, took, came} <= begins || rst ? 9'd0 : {given + row_start, took + row_taken, came + (works && answers)};
        rows_done <= begins || rst || answers ? 0 : works ? rows_done | row_done : 0;
        wrong <= !rst && (begins ? 0 : wrong || (works && answers && row_overflow));
        zero  <= !rst && (begins ? 0 : zero || (works && answers && row_by_zero));
        for (n = 0; n < ROWS; n = n + 1)
            if (works && row_done[n]) slopes[ARRANGEMENT == 0 ? by_came : n] <= row_k[n*WORD+:WORD];
        {u_was, s_was} <= {u, s};
    end
    // What the header asks of the caller, and slope.v promises.
    always @* begin
        if (works && !fresh) assume (u == u_was && s == s_was);
        if (works || done) assume (!push);
        if (ARRANGEMENT == 0) assume (row_taken ? took < given : 1);
        if (ARRANGEMENT == 0) assume (!row_done[0] || came < took);
        assume ((row_done & rows_done) == 0);
        if (!works || given == 0) assume (row_done == 0 && !row_taken);
    end
    wire [4:0] a = ARRANGEMENT == 2 ? row_k[WORD-1:0] : slopes[0], b = ARRANGEMENT == 2 ? ks[WORD-1:0] : slopes[1];
    wire [4:0] c = ARRANGEMENT == 2 ? ks[2*WORD-1:WORD] : slopes[2];
    wire [4:0] d = ARRANGEMENT == 2 ? ks[3*WORD-1:2*WORD] : slopes[3];
    wire [3:0] next = u ^ a ^ {b[0], b[3:1]} ^ {c[1:0], c[3:2]} ^ {d[2:0], d[3]} ^ 1;
    always @* if (!rst && !fresh) begin
        assert (done == (ARRANGEMENT == 2 ? ends_now : was_done));
        assert (busy == (works && !done) && row_start == asks);
        assert (u_before == us[WORD-2:0]);
        if (ARRANGEMENT == 2) assert (point_before == latest && row_base == latest);
        if (done && !push) begin
            assert (k == a && u_next == next);
            assert (overflow == (wrong || (ARRANGEMENT == 2 && row_overflow)));
            assert (by_zero == (zero || (ARRANGEMENT == 2 && row_by_zero)));
        end
        for (n = 0; n < ROWS; n = n + 1) begin
            if (works && took < given)
                assert (row_u_a[n*(WORD-1)+:WORD-1] == lags[ARRANGEMENT == 0 ? by_taken : n][WORD-2:0]);
            if (works && took < given && ARRANGEMENT != 2)
                assert (row_u_b[n*(WORD-1)+:WORD-1] == lags[(ARRANGEMENT == 0 ? by_taken : n)+1][WORD-2:0]);
            if (works && row_done[n]) begin
                assert (row_s[n*(WORD-1)+:WORD-1] == of_lag[ARRANGEMENT == 0 ? by_came : n]);
                assert (row_du[n*WORD+:WORD] == lags[ARRANGEMENT == 0 ? by_came : n]
                                                - lags[(ARRANGEMENT == 0 ? by_came : n)+1]);
            end
        end
        cover (done && next == 5 && wrong);
        cover (done && us[WORD-1:0] == 7 && !push);
    end
    // What makes these inductive.
    always @* if (began) begin
        assert (working == works && row_start == asks && (ARRANGEMENT == 2 || ended == was_done));
        assert (given <= orders && (came < 4 || !works) && (!fresh || !works) && (works || !asks));
        if (works) assert (any_overflow == wrong && any_by_zero == zero);
        if (works && ARRANGEMENT == 0) assert (turn == came && came <= took);
        if (works && ARRANGEMENT == 0) assert (given + row_start == (took == 4 ? 4 : took + 1));
        if (works && ARRANGEMENT != 0) assert (given + row_start == 1 && came == 0);
        if (was_done) assert (!works && any_overflow == wrong && any_by_zero == zero);
    end
    wire kept, same;
    generate if (ARRANGEMENT == 2) begin : keeps
        assign kept = cached.point_1 == latest && {cached.old_3, cached.old_2, cached.old_1} == ks[3*WORD-1:0]
                      && {1'b0, u_1} == us[WORD-1:0];
        assign same = 1;
    end else begin : keeps
        assign kept = {1'b0, anew.u_4, 1'b0, anew.u_3, 1'b0, anew.u_2, 1'b0, u_1} == us
                      && {anew.s_3, anew.s_2, anew.s_1} == distances[3*(WORD-1)-1:0];
        wire [3:0] there = was_done ? 4'hF : !works ? 4'h0 : ARRANGEMENT == 1 ? rows_done : ~(4'hF >> came);
        wire [3:0] equal = {anew.all_k[4*WORD-1:3*WORD] == slopes[3], anew.all_k[3*WORD-1:2*WORD] == slopes[2],
                            anew.all_k[2*WORD-1:WORD] == slopes[1], anew.all_k[WORD-1:0] == slopes[0]};
        assign same = &(equal | ~there);
    end
    if (ARRANGEMENT == 0) begin : in_turn
        always @* if (began && works) assert (anew.serial.orders == took[1:0]);
    end
    if (ARRANGEMENT == 1) begin : at_once
        always @* if (began && works) assert (anew.parallel.finished == rows_done && rows_done != 4'hF);
    end endgenerate
    always @* if (began) assert (kept && same); else assume (kept);
