    // Read inside uart_bridge, by its proof. owed: something has come in that is not yet answered; quiet: cycles since then
    // in which nothing came.
    localparam [11:0] SPEAK = 9 * 4, REACH = 2 * BUS_CYCLES + 4, LISTEN = 2 * GAP + 4,
                      LATE = REACH + SPEAK, ALL = LATE + LISTEN + SPEAK;
    reg         owed = 0;
    reg  [11:0] quiet = 0;
    reg  [1:0]  hesitates = 0; // the transmitter: it is ready at least in every fourth cycle
    always @(posedge clk) hesitates <= sent ? 0 : hesitates + 1;
    always @* assume (sent || hesitates != 3);
    wire        ends = state == TELL && sent && at == 4'd8 && !missed && !anything;
    always @(posedge clk) begin
        owed  <= !rst && (anything || (owed && !ends));
        quiet <= rst || anything || coming || !(owed && !ends) ? 0 : quiet == 12'hFFF ? quiet : quiet + 1;
    end
    always @* if (!rst) begin
        assert (state <= TELL);
        assert (owed == (state != IDLE));
        assert (quiet <= ALL);
        // What makes this inductive.
        if (state == RECEIVE) assert (at >= 1 && at <= 8 && timer <= QUIET && quiet <= timer);
        if (state == DRAIN) assert (timer <= QUIET + 1 && quiet <= LATE + timer && (error == TOO_SOON || quiet <= timer));
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
