// SPDX-License-Identifier: MIT
    // Read inside slope, by its proof: every order is done once, in its turn and never two at a time; a chord goes to
    // kout once for each order that wants its slope, while kout is free, and is that of the points of this order.
    reg                fresh = 0, calm = 0;   // a reset was; and not in the cycle before
    reg                holds = 0;             // the caller has an order here
    reg                has_k = 0;             // kout has an order
    reg  [1:0]         owed = 0;              // orders that are not done
    reg  [1:0]         on_a = 0, came = 0;    // points that cuk_a is at, and that it has given to this order
    reg                on_b = 0;              // cuk_b is at one
    reg  [DIM*WORD+1:0] first, second, a_was, b_was; // points with their flags
    reg  [DIM*WORD-1:0] base_was;
    reg  [3:0]         wants_was;
    reg  [1:0]         flagged = 0;           // of the points that kout's order came from: overflow, by_zero
    wire [3:0]         wants   = {want_a, want_b, want_k, given};
    wire               a_start = (go && want_a) || second_start;
    wire               b_start = PAIR != 0 && go && want_b;
    wire [DIM*WORD+1:0] a_answer = {a_point, a_overflow, a_by_zero}, b_answer = {b_point, b_overflow, b_by_zero},
                        kept     = {point, points_overflow, points_by_zero};
    // A chord that is no word of WORD bits: DIM is 2 here.
    localparam signed [WORD:0] MOST = (1 << WORD - 1) - 1;
    wire signed [WORD-1:0] to_x = point[0+:WORD], to_y = point[WORD+:WORD];
    wire signed [WORD-1:0] from_x = want_b ? b_point[0+:WORD] : base[0+:WORD];
    wire signed [WORD-1:0] from_y = want_b ? b_point[WORD+:WORD] : base[WORD+:WORD];
    wire signed [WORD:0]   far_x = to_x - from_x, far_y = to_y - from_y;
    wire               beyond = !given && (far_x > MOST || far_x < -MOST - 1 || far_y > MOST || far_y < -MOST - 1);
    always @(posedge clk) begin
        fresh <= 1;
        calm  <= fresh && !rst;
        owed  <= owed + go - done;
        holds <= go || (busy && !(taken || (ready && !want_k && (state == POINTS || state == SECOND))));
        has_k <= taken || (has_k && !kout_done);
        on_a  <= on_a + a_start - a_done;
        on_b  <= b_start || (on_b && !(PAIR != 0 && b_done));
        came  <= go ? 0 : came + a_done;
        if (a_done && came == 0) first <= a_answer;
        if (PAIR != 0 ? b_done : a_done && came == 1) second <= b_answer;
        {wants_was, base_was} <= {wants, base};
        {a_was, b_was} <= {a_answer, b_answer};
        if (taken) flagged <= {(want_a && first[1]) || (want_b && second[1]) || beyond,
                               (want_a && first[0]) || (want_b && second[0])};
        if (rst) {owed, holds, has_k, on_a, on_b, came} <= 0;
    end
    always @* begin
        // Of cuk, as cu_inside.v proves of cu: an answer comes after its start, and holds until the next start; two
        // points may be on their way, and then it is busy.
        assume (!a_done || on_a != 0);
        assume (!calm || on_a != 0 || a_answer == a_was);
        assume (on_a != 2 || a_busy);
        assume (on_a != 0 || !a_busy);
        if (PAIR != 0) assume ((!b_done || on_b) && (!calm || on_b || b_answer == b_was) && (on_b || !b_busy));
        // Of kout, as kout_inside.v proves.
        assume (!kout_done || has_k);
        assume (kout_busy == (has_k && !kout_done));
        // Of the caller: operands hold; the order says which points; one without a slope comes when no slope is owed.
        if (holds) assume (wants == wants_was && base == base_was);
        assume (!go || ((want_a || given) && (want_a || !want_b) && (want_a || want_k)));
        assume (want_k || !has_k);
        assume (!points_done || !want_k);
    end
    always @* if (fresh && !rst) begin
        assert (!(points_done && kout_done));
        if (done) assert (owed != 0);
        if (a_start) assert (!a_busy);
        if (b_start) assert (!b_busy);
        if (taken) assert (!kout_busy && want_k);
        if (taken && want_a) assert (kept == first);
        if (taken && want_b) assert (b_answer == second);
        if (taken && !given) assert (chord[WORD-1:0] == point[WORD-1:0] - (want_b ? second[2+:WORD] : base[WORD-1:0]));
        if (kout_done && want_k) assert ({overflow, by_zero} == (flagged | {kout_overflow, kout_by_zero}));
        // What makes these inductive.
        if (has_k) assert ({chord_overflow, chord_by_zero} == flagged);
        assert (owed == (state != IDLE) + has_k + points_done);
        assert (PAIR != 0 || !on_b);
        assert (holds == (state != IDLE) && (calm || state == IDLE));
        assert (!points_done || (!has_k && state == IDLE));
        if (state == IDLE) assert (on_a == 0 && !on_b);
        if (state == POINTS || state == SECOND) assert (want_a && a_ready == (came != 0) && (PAIR != 0 || !b_ready));
        if (state == POINTS) assert (on_a + came == 1 && came <= (want_b ? 1 : 0));
        if (state == SECOND) assert (PAIR == 0 && want_b && on_a + came == 2 && came <= 1);
        if (PAIR != 0 && state == POINTS) assert (want_b ? on_b != b_ready : !on_b && !b_ready);
        if (PAIR != 0 && state == POINTS && want_b) assert (!(a_ready && b_ready));
        if (PAIR != 0 && b_ready && state != IDLE && want_b) assert (b_was == second);
        if (state == CHORD && !want_a) assert (!points_overflow && !points_by_zero);
        if (state == CHORD) assert (want_k && on_a == 0 && !on_b);
        if (state == CHORD && want_a) assert (kept == first && came != 0);
        if (state == CHORD && want_b) assert (b_was == second);
        if (a_ready && state != IDLE && want_a) assert (kept == first);
        cover (taken && kout_done && want_b);
        cover (done && !want_k);
        cover (taken && given && !want_a);
    end
