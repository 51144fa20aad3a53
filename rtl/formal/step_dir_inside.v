// SPDX-License-Identifier: MIT
    // Read inside step_dir, by its proof; written from its header. What the pins do is told from the pins alone:
    // pulses and gaps keep their times, dir changes only in a gap and SETUP cycles before the next pulse, whatever is
    // cleared when. When nothing is due, position is what the pins have made since origin, after lost steps too. While
    // none is lost, the sum of all advances since origin or clear and the position then differ by half a step at most.
    // Sums are taken to 10 bits.
    reg               begun = 0, calm = 0, step_was = 0, dir_was = 0;
    // cycles that step was high, low, and dir as it is: before this one
    reg [5:0]         high = 63, low = 63, straight = 63;
    reg signed [9:0]  made = 0;                           // steps that began before this cycle
    reg signed [9:0]  sum = 0, start = 0;
    wire              rises = step && !step_was, falls = !step && step_was, turns = dir != dir_was;
    wire signed [9:0] now_made = rises ? (dir ? made - 10'sd1 : made + 10'sd1) : made;
    wire signed [9:0] error = sum - (position[9:0] - start) * 10'sd60;
    wire              empties = clear || origin || rst;
    function [5:0] one_more(input [5:0] cycles);
        one_more = cycles == 63 ? 63 : cycles + 1;
    endfunction
    always @(posedge clk) begin
        begun    <= 1;
        calm     <= begun && !rst;
        step_was <= !rst && step;
        dir_was  <= !rst && dir;
        high     <= rst || !step ? 0 : one_more(high);
        low      <= rst ? 63 : step ? 0 : one_more(low);
        straight <= rst ? 0 : turns ? 1 : one_more(straight);
        made     <= rst || origin ? 10'sd0 : now_made;
        sum      <= empties ? 10'sd0 : sum + advance;
        start    <= rst || origin ? 10'sd0 : clear ? now_made : start;
    end
    always @* if (begun && !rst) begin
        if (!calm) assert (!step && !dir);
        if (rises) assert (low >= PULSE && straight >= SETUP && !turns);
        if (falls) assert (high == PULSE);
        if (step) assert (high < PULSE);
        if (turns) assert (!step && !step_was && low >= PULSE);
        if (!lost) assert (error >= -10'sd30 && error < 10'sd30);
        if (!moving) assert (position[9:0] == now_made);
        assert ($signed(position[9:0]) == now_made + due);
        // What makes these inductive.
        assert (due != -4'sd8 && (lost || accumulator == error));
        assert (accumulator >= -10'sd30 && accumulator < 10'sd30);
        assert (step_was == (high != 0) && (step_was || low != 0 || !step) && (high == 0 || low == 0));
        if (step) assert (!rises || high == 0);
        assert (wait_for <= (step ? PULSE - 1 : PULSE > SETUP ? PULSE - 1 : SETUP - 1));
        if (step) assert (high + wait_for == PULSE - 1);
        else if (step_was) assert (wait_for == PULSE - 1);
        else assert (low == 63 || low + wait_for >= PULSE - 1);
        if (!step) assert ((turns ? 0 : straight) + wait_for >= SETUP - 1);
        cover (rises && dir && made == 10'sd2);
        cover (clear && due == 4'sd2 && step);
    end
