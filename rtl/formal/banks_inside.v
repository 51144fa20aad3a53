// SPDX-License-Identifier: MIT
    // Read inside banks, by its proof; written from its header: a bank in use is never written and stays closed, one
    // that is left opens, and a bank closes only with all its bounds, loaded after the limits and within them.
    reg [7:0] there = 0;
    reg       bad = 0, close_was = 0, done_was = 0, good_was = 0, named = 0, calm = 0;
    wire      is_bound = load && load_space == 3 && load_index[2:0] == 4;
    wire      is_limit = load && load_space == 5 && (load_index[3:0] == 4 || load_index[3:0] >= 8);
    wire      bank_of  = load_space == 0 ? load_index[8] : load_space == 3 ? load_index[3] : load_index[9];
    wire      ahead    = feed_bank != point_bank;
    always @(posedge clk) begin
        if (is_bound) there <= there | (8'd1 << load_index[6:4]);
        if (is_bound && bound_beyond) bad <= 1;
        if (rst || close || is_limit) {there, bad} <= 0;
        calm      <= !rst;
        done_was  <= done;
        close_was <= close && !rst;
        good_was  <= there[3:0] == 4'hF && there[7] && !bad;
        named     <= load_index[0];
    end
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 3) age <= age + 1;
    always @* if (age == 1 || age == 2) assert (held == 0 && !busy && $countones(there) < age);
    always @* if (age < 3) assert (!ahead);
    always @* if (age == 3) begin // what makes the rest inductive
        if (ahead) assert (oldest == point_bank);
        if (!busy && !done) assert (oldest == point_bank);
    end
    always @* if (calm && !rst) begin
        if (busy) assert (closed[point_bank]);
        if (busy && load) assert (load_space != 5 && (load_space > 3 || bank_of != point_bank));
        if (close_was && good_was && !done_was) assert (closed[named] || forgets || (busy && named != point_bank));
        if (close_was) assert (outside == !good_was);
        if (!close_was) assert (!outside);
        if (starved) assert (busy && closed != 2'b11 && (final_bank & closed) == 0);
        // What makes these inductive.
        assert (bounds == there && leaves == bad);
        cover (busy && streamed && close_was && good_was);
        cover (busy && outside);
    end
