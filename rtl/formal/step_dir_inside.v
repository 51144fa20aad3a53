    // Read inside step_dir, by its proof: position is the sum of all advances over the modulus, to the nearest step; what is
    // on the pins and what is due make up position; pulses and turns keep their times. Sums are taken to 10 bits.
    reg signed [9:0] sum = 0, pins = 0;
    reg               step_was = 0, dir_was = 0;
    wire              rises   = step && !step_was;
    wire signed [9:0] on_pins = !rises ? pins : dir ? pins - 10'sd1 : pins + 10'sd1;
    wire signed [9:0] rest    = sum - position[9:0] * 10'sd60;
    // Cycles that step and dir have been as they are, this one included; 63 stands for 63 or more.
    reg [5:0]  same = 63, straight = 63;
    wire [5:0] now_same     = step != step_was ? 6'd1 : same == 6'd63 ? 6'd63 : same + 6'd1;
    wire [5:0] now_straight = dir != dir_was ? 6'd1 : straight == 6'd63 ? 6'd63 : straight + 6'd1;
    always @(posedge clk) begin
        sum      <= clear ? 10'sd0 : sum + advance;
        pins     <= clear ? 10'sd0 : on_pins;
        step_was <= !clear && step;
        dir_was  <= !clear && dir;
        same     <= clear ? 6'd63 : now_same;
        straight <= clear ? 6'd63 : now_straight;
    end
    always @* if (!clear) begin
        assert (accumulator >= -half && accumulator < half);
        assert (rest == accumulator);
        if (!lost) assert (due != -4'sd8 && on_pins + due == $signed(position[9:0]));
        if (rises) assert (same >= PULSE && now_straight > SETUP);
        if (!step && step_was) assert (same == PULSE);
        if (dir != dir_was) assert (!step && !step_was && same >= PULSE);
        // What makes these inductive.
        assert (wait_for < (step ? PULSE : PULSE > SETUP ? PULSE : SETUP));
        if (step) assert (now_same + wait_for == PULSE);
        else assert (now_same + wait_for >= PULSE);
        assert (step_was || same >= PULSE || now_same > same);
        if (!step) assert (now_straight + wait_for >= SETUP);
        else assert (now_straight > SETUP);
        cover (rises && dir && pins == 10'sd2);
    end
