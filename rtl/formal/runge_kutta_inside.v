// SPDX-License-Identifier: MIT
    // Read inside runge_kutta, by its proof; written from its header and Fig. 5: four orders, one after the other,
    // each begun a cycle after what it needs is there; what each asks of the row; ui_out gets them in their order.
    reg        works = 0, asks = 0, ended = 0, fresh = 1, waits = 0, wrong = 0, zero = 0;
    reg  [1:0] came = 0;             // slopes of this step
    reg  [WORD-1:0] slopes[0:3];
    reg  [7*(WORD-1)+DIM*WORD:0] given_was;
    wire [7*(WORD-1)+DIM*WORD:0] operands =
        {first, u, u_before, point_before, s_now, s_half, s_whole, first_du, first_chord};
    wire       begins = start && !works;
    always @(posedge clk) begin
        fresh     <= rst;
        given_was <= operands;
        works     <= !rst && (begins || (works && !(row_done && came == 3)));
        ended     <= !rst && works && row_done && came == 3;
        asks      <= !rst && (begins || (works && row_done && came != 3));
        waits     <= !rst && (row_start || waits) && !(works && row_done);
        came      <= rst || begins ? 0 : came + (works && row_done);
        wrong     <= !rst && !begins && (wrong || (works && row_done && row_overflow));
        zero      <= !rst && !begins && (zero || (works && row_done && row_by_zero));
        if (works && row_done) slopes[came] <= row_k;
    end
    always @* if (!rst && !fresh) begin
        assume (!(works || ended) || operands == given_was);
        assume (!row_done || waits);
    end
    wire [4:0] a = slopes[0], b = slopes[1], c = slopes[2], d = slopes[3];
    wire [3:0] next = u ^ a ^ {b[0], b[3:1]} ^ {c[1:0], c[3:2]} ^ {d[2:0], d[3]};
    wire       both = !first && !(CACHED != 0 && came == 0); // ends of the quotient
    always @* if (!rst && !fresh) begin
        assert (busy == works && done == ended && row_start == asks);
        assert (point_done == (works && row_done && came == 0));
        if (row_start || waits) begin
            assert (row_want_a == (!first || came == 0) && row_want_b == both && row_given == first);
            assert (row_half == (came == 1 || came == 2) && row_whole == (came == 3));
            if (came != 0) assert (row_shift == slopes[came-2'd1]);
            assert (row_s == (came == 0 ? s_now : came == 3 ? s_whole : s_half));
            assert (row_du == (first ? {1'b0, first_du} : {1'b0, u} - {1'b0, u_before}));
            if (first) assert (row_base[WORD-1:0] == first_chord && row_base[DIM*WORD-1:WORD] == 0);
            else assert (row_base == point_before);
        end
        if (done) assert (k == slopes[0] && u_next == next && overflow == wrong && by_zero == zero);
        cover (done && next == 5 && first);
        cover (done && wrong && !first && k == 3);
        // What makes these inductive.
        assert (working == works && !(row_start && waits));
        if (works) assert (stage == came && overflow == wrong && by_zero == zero && (asks || waits));
        if (!works) assert (!asks && !waits);
        if (works && came > 0) assert (k == slopes[0]);
        if (works && came > 1) assert (k_2 == slopes[1]);
        if (works && came > 0) assert (row_shift == slopes[came-2'd1]);
    end
