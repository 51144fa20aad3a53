// SPDX-License-Identifier: MIT
    // Read inside axes, by its proof; written from its header.
    wire [4:0] flags = {too_fast, late, lost, elsewhere, cut};
    reg        allowed = 0, calm = 0, calm_rst = 0;
    reg  [4:0] flags_was = 0;
    reg  [4:0] since = 31; // cycles since the latest beat was taken; 31 for more
    wire       takes = s_axis_tvalid && s_axis_tready;
    always @(posedge clk) begin
        calm      <= !rst && !origin;
        allowed   <= !rst && enable && (origin || (allowed && flags == 0));
        flags_was <= flags;
        since     <= rst ? 31 : takes ? 1 : since == 31 ? 31 : since + 1;
        calm_rst  <= !rst;
    end
    // ---- Outputs: of the latest point, of the one whose period it is, and whether they have to be off.
    reg  [3:0] given = 0, shown = 0;
    reg        off = 1;
    always @(posedge clk) begin
        off <= rst || origin || !enable || !allowed || flags != 0;
        if (takes) given <= s_axis_tuser[0] ? 0 : s_axis_tuser[4:1];
        if (since == 12) shown <= given;
        if (since == 28) shown <= 0;
        if (rst || origin || !enable || !allowed || flags != 0) {given, shown} <= 0;
    end
    always @* if (calm_rst && !rst) begin
        if (takes) assert (allowed && enable && flags == 0);
        if (takes && since != 31) assert (since >= 16);
        if (!allowed) assert (clear && !placed);
        if (calm && flags_was[4:1] != 0) assert ((flags & flags_was) == flags_was || flags_was[2]);
        if (allowed && flags == 0) assert (placed);
        if (off) assert (outputs == 0);
        assert (outputs[2:0] == shown[2:0] && (shown[3] || !outputs[3]));
        cover (outputs == 9);
        cover (takes && s_axis_tuser[0] && allowed);
        cover (cut && allowed);
        cover (elsewhere && allowed);
        // What makes these inductive.
        assert (placed == allowed && left < 16 && cycles == 16);
        if (since < 16) assert (left == 16 - since);
        if (since == 31) assert (shown == 0 && (!fresh || off));
        if (since > 15 && since != 31) assert (left == (since == 16 ? 0 : 32 - since));
        if (since < 28)
            assert (since < 12 ? phase == since : phase == (since == 12 ? 12 : since < 17 ? 0 : since - 16));
        if (since < 17) assert (given == (fresh ? bits : 0) || off);
        if (since >= 17) assert (!fresh || off);
    end
