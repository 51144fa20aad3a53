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
    always @* if (calm_rst && !rst) begin
        if (takes) assert (allowed && enable && flags == 0);
        if (takes && since != 31) assert (since >= 16);
        if (!allowed) assert (clear && !placed);
        if (calm && flags_was[4:1] != 0) assert ((flags & flags_was) == flags_was || flags_was[2]);
        if (allowed && flags == 0) assert (placed);
        cover (takes && s_axis_tuser && allowed);
        cover (cut && allowed);
        cover (elsewhere && allowed);
        // What makes these inductive.
        assert (placed == allowed && left < 16);
        if (since < 16) assert (left == 16 - since);
    end
