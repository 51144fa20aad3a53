// SPDX-License-Identifier: MIT
    // Read inside vt, by its proof: three speeds of the table after start and two after advance, each once and in its
    // turn, rounded; now is the former whole; they hold while nothing is asked; overflow tells any speed out of range
    // since start.
    reg            fresh = 0;                  // a reset was
    reg [1:0]      owed;                       // speeds still to come
    reg [WORD-2:0] first, second, third, old;  // the latest three, and the whole before
    // two since the last start or advance were asked; out of range; ever started
    reg            moved, wrong, asked;
    wire           takes = valid && busy;
    wire [WORD-2:0] taken = (speed + (1 << GUARD - 1)) >> GUARD;
    always @(posedge clk) begin
        fresh <= 1;
        if (takes) {first, second, third} <= {second, third, taken};
        if (takes) owed <= owed - 1;
        if (takes && (speed[WORD+26] ? speed < -(1 << GUARD - 1) : taken[WORD-2])) wrong <= 1;
        if (!busy && start) begin
            {owed, moved, wrong, asked} <= 5'b11_0_0_1;
        end else if (!busy && advance) begin
            {owed, moved} <= 3'b10_1;
            old <= whole;
        end
        if (rst) {owed, asked} <= 0;
    end
    always @* if (fresh && !rst) begin
        assert (owed == 2'd3 - awaited && busy == (owed != 0));
        if (asked) assert (overflow == wrong);
        if (asked && owed == 0 && !moved) assert ({now, half, whole} == {first, second, third});
        if (asked && owed == 0 && moved) assert ({now, half, whole} == {old, second, third});
        // What makes these inductive.
        if (asked && owed == 2 && !moved) assert (now == third);
        if (asked && owed == 1 && !moved) assert ({now, half} == {second, third});
        if (asked && owed == 2 && moved) assert (now == old);
        if (asked && owed == 1 && moved) assert ({now, half} == {old, third});
        if (asked) assert (owed != 3 || !moved);
        cover (asked && owed == 0 && moved && !wrong && now != half && half != whole && !start);
        cover (overflow && busy && moved);
    end
