// SPDX-License-Identifier: MIT
    // Read inside steps, by its proof: a distance is offered until it is taken; records follow each other, from bank
    // 0 on and from bank to bank; none is read from a bank that is open; each is offered as often as it says; after
    // the last, nothing.
    reg               fresh = 0, offered = 0, ended = 1, open_was = 1; // a reset was; the last distance has been taken
    reg [WORD+26:0]   was;
    reg [9:0]         ends_was; // of this bank: last record, final
    reg [7:0]         record_was;
    // distances of this record that are taken, and all of them; 0: for ever
    reg [31:0]        through = 0, promised = 0;
    reg [2:0]         reading_was = 0;
    reg               going = 0;
    reg  [7:0]        place = 0; // record that has to be read
    wire [7:0]        ends_here = {bank ? last_record[13:7] : last_record[6:0], final_bank[bank]};
    always @* if (going) begin
        assume (closed[bank] || !(reading == 0 || reading > 1));
        if (reading != 1 && reading_was != 1) assume (ends_was == {1'b1, closed[bank], ends_here});
    end
    always @(posedge clk) begin
        fresh       <= 1;
        offered     <= !rst && !start && valid && !take;
        was         <= distance;
        ends_was    <= {1'b1, closed[bank], ends_here};
        record_was  <= record;
        reading_was <= rst || start ? 0 : reading;
        open_was    <= !closed[bank];
        going       <= !rst && (start || (going && !(valid && take && is_last)));
        ended       <= rst || (!start && (ended || (valid && take && is_last)));
        if (valid && take && promised != 0 && through + 1 == promised)
            place <= record[6:0] == ends_here[7:1] ? {!record[7], 7'd0} : record + 8'd1;
        if (start) place <= 0;
        if (reading == 3'd2) {promised, through} <= {word[31:0], 32'd0};
        if (valid && take) through <= through + 1;
    end
    // The numbers of a record: d, d + e, d + 2 e + f, ...
    reg  [WORD+26:0]  due, change, second;
    always @(posedge clk) begin
        due    <= reading == 3 ? word : valid && take ? due + change : due;
        change <= reading == 4 ? word : valid && take ? change + second : change;
        second <= reading == 5 ? word : second;
    end
    always @* if (fresh && !rst) begin
        if (valid) assert (distance == due);
        if (valid) assert (e == change && f == second);
        if (going && reading > 3) assert (d == due);
        if (going && reading > 4) assert (e == change);
        assert (going == !ended);
        if (offered) assert (valid && distance == was && record == record_was);
        if (ended) assert (!valid);
        if (going) assert (record == place);
        if (valid) assert (is_last == (ends && record[6:0] == ends_here[7:1] && final_bank[record[7]]));
        if (going && reading != 0 && reading == reading_was) assert (open_was);
        if (going && reading_was != 0 && reading != reading_was) assert (!open_was);
        if (valid && promised != 0) assert (through < promised);
        if (valid && promised != 0 && ends) assert (through + 1 == promised);
        // What makes these inductive.
        assert (running == going && (!going || reading <= 5));
        if (going && (reading > 2 || reading == 0)) assert (periods == (promised == 0 ? 0 : promised - through));
        if (going && reading > 2) assert (through == 0);
        cover (valid && record == 8'h80 && ended == 0);
        cover (offered && through == 2 && promised == 3);
    end
