// SPDX-License-Identifier: MIT
    // Read inside feed_override, by its proof: a distance is offered until it is taken; one that was asked for at
    // rest under a hold is 0, takes nothing from the feed and leaves path time where it is, for as long as the hold
    // lasts; the path is cut only there, and only by a stop; the program never leaves its text, never takes a period
    // twice or one that is not known. A hold takes hundreds of cycles: cocotb_tests/test_feed_override.py reaches it,
    // no cover does.
    reg           fresh = 0, offered = 0, going = 0; // a reset was; a run has begun
    reg           held = 0;                          // the distance on offer was asked for at rest under a hold
    reg           stop_told = 0;                     // a stop was sampled for the latest distance
    reg           rated = 0, rate_is_0 = 0;          // the rate of this period came in the latest cycle; it is 0
    reg           advanced = 0;                      // this period has taken one of the feed
    reg [WORD+26:0] was;
    reg [1:0]     ends_was;
    wire [15:0]   text;
    feed_override_text text_inst (.clk(clk), .read(1'b0), .at(pc), .code(text));
    always @(posedge clk) begin
        fresh   <= 1;
        going   <= !rst && (start || going);
        offered <= !rst && !start && valid && !take;
        was     <= distance;
        ends_was <= {is_last, cut};
        rated     <= !rst && !start && running && works && order == MARK && how == 4'd5;
        rate_is_0 <= acc == 0;
        if (begins) {held, stop_told, advanced} <= {rests, stopping, 1'b0};
        if (running && works && order == MARK && how == 4'd4) advanced <= 1;
        if (start) {held, stop_told, advanced} <= 0;
    end
    always @* assume (going || !begins); // nothing is asked for before a run
    wire in_init = pc <= 9;
    wire in_fast = pc >= 10 && pc <= 14;
    wire in_slow = pc >= 15 && pc <= 217;
    wire in_speed = pc >= 218 && pc <= 247;
    always @* if (fresh && !rst && going) begin
        if (offered) assert (valid && distance == was && {is_last, cut} == ends_was);
        if (rated) assert (resting == rate_is_0);
        if (valid && held) assert (distance == 0 && !is_last);
        if (valid && cut) assert (held && stop_told);
        assert (!(running && valid));
        assert (count <= (sealed ? 5 : 4));
        if (sealed) assert (ending && count != 0);
        if (running && works && order == MARK && how == 4'd4)
            assert (!advanced && (count > 2 || (sealed && count == 2)));
        // The program.
        if (running) assert (instruction == text);
        if (running) assert (in_init || in_fast || in_slow || in_speed);
        if (running && in_speed) assert (link == 18 || link == 38 || link == 53 || link == 209);
        if (running && !in_init && !advanced) assert (count > 2 || (sealed && count == 2));
        if (running && advanced) assert (count != 0);
        if (running && !in_init && advanced)
            assert (pc == 12 || pc == 13 || pc == 14 || (pc >= 204 && pc <= 217) || (in_speed && link == 209));
        if (running && (pc == 12 || pc == 13 || pc == 14 || pc == 204)) assert (advanced);
        if (running && in_init) assert (!advanced && whole && first && !resting);
        if (running) assert (!held && !cut);
        cover (running && pc == 2 && count == 3);
    end
