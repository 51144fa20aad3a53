// SPDX-License-Identifier: MIT
    // Read inside uart_bridge, by its proof. owed: something has come in that is not yet answered; quiet: cycles
    // since then in which nothing came, and no write of a block ended.
    localparam [11:0] SPEAK = 9 * 4, REACH = 2 * BUS_CYCLES + 4, LISTEN = 2 * GAP + 4,
                      LATE = REACH + SPEAK, ALL = LATE + LISTEN + SPEAK;
    reg         owed = 0;
    reg  [11:0] quiet = 0;
    reg  [1:0]  hesitates = 0; // the transmitter: it is ready at least in every fourth cycle
    always @(posedge clk) hesitates <= sent ? 0 : hesitates + 1;
    always @* assume (sent || hesitates != 3);
    wire        ends = state == TELL && sent && at == 4'd8 && !missed && !anything;
    wire        block_goes_on = state == ACCESS && block && launched && finished && response == 0;
    // The alarm: each rise is told once.
    reg         alarm_before = 0, rang = 0;
    always @(posedge clk) begin
        alarm_before <= !rst && alarm;
        rang         <= !rst && !alert && (rang || (alarm && !alarm_before));
    end
    // Exactly once: the number of the latest request that the bus has answered, and the transfers of this request.
    reg         told = 0, is_block = 0;
    reg  [7:0]  told_number = 0, asks = 0, promised = 0;
    reg  [8:0]  launches = 0;
    wire        twice = told && asks == told_number;
    wire        answered = state == ACCESS && !twice && (launched ? finished && !block_goes_on
                                                         : is_block && launches == promised);
    always @(posedge clk) begin
        if (state == IDLE) is_block <= byte_in == 8'hB5;
        if (state == RECEIVE && came && at == 1) asks <= byte_in;
        if (state == RECEIVE && came && at == 2 && is_block) promised <= byte_in;
        if (state != ACCESS) launches <= 0;
        else if (launch) launches <= launches + 1;
        if (answered) {told, told_number} <= {asks != 0, asks};
        else if (state == ACCESS && !twice && !block_goes_on && timer == PATIENCE) told <= 0;
        if (rst) told <= 0;
    end
    always @(posedge clk) begin
        owed  <= !rst && (anything || (owed && !ends));
        quiet <= rst || anything || coming || block_goes_on || !(owed && !ends) ? 0
                 : quiet == 12'hFFF ? quiet : quiet + 1;
    end
    always @* if (!rst) begin
        assert (state <= TELL);
        if (alert) assert (rang);
        assert (rang == alarm_owed && alarm_before == alarm_was);
        assert (owed == (state != IDLE));
        assert (quiet <= ALL);
        // What makes this inductive.
        if (state == RECEIVE) assert (at >= 1 && at <= (block ? 3 : 8) && timer <= QUIET && quiet <= timer);
        if (state == RECEIVE && !block) assert (left == 9 - at);
        if (state == RECEIVE && at >= 2) assert (asks == asked_number);
        if (state == RECEIVE && at == 3 && block) assert (count == promised);
        if (state == RECEIVE || state == ACCESS) assert (block == is_block);
        // Exactly once.
        if (launch) assert (!twice && launches < (is_block ? promised : 1));
        if (state == ACCESS) assert (asks == asked_number && again == twice && (!block || count == promised));
        if (state == ACCESS) assert (entry <= count || !block);
        if (state == ACCESS) assert (launches == (block ? entry + launched : launched));
        if (state == ACCESS && block && launched) assert (entry != count);
        assert (told == known && (!known || told_number == number));
        cover (launch && is_block && launches == 1); // of the sums of its bytes the solver has to find the right one
        if (state == DRAIN)
            assert (timer <= QUIET + 1 && quiet <= LATE + timer && (error == TOO_SOON || quiet <= timer));
        if (state == DRAIN) assert (error != 0);
        if (state == ACCESS) assert (error == 0 && timer <= PATIENCE);
        if (state == ACCESS) assert (quiet <= (launched ? PATIENCE + 2 : 0) + timer);
        if (state == TELL) assert (at <= 8);
        if (state == TELL && error == 0) assert (quiet <= REACH + 4 * at + hesitates);
        if (state == TELL && missed) assert (quiet <= REACH + 4 * at + hesitates);
        if (state == TELL && error != 0) assert (quiet <= LATE + LISTEN + 4 * at + hesitates);
        cover (state == DRAIN && error == BAD_STOP);
        cover (alert);
    end
