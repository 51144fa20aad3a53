    // Read inside load_guard, by its proof: bad is sticky; ready only follows a close whose count and checksum are those of
    // all writes since the one before, each of them right, and which brought all that a run needs (without EXACT).
    reg        fresh = 0, bad_was = 0, all_right = 1, open = 1; // a reset was; since the last close; nothing closed since
    reg [15:0] writes = 0;
    reg [31:0] sum = 0;
    reg [5:0]  brought = 0;
    wire       anew = !open; // this write begins another load
    wire [5:0] brings = {space == 4 && index == 0, space == 5 && index[2:0] == 4, space == 5 && index[3:0] == 0,
                         space == 3 && index[1:0] == 2, space == 3 && index[1:0] == 1, space == 3 && index[1:0] == 0};
    always @(posedge clk) begin
        fresh   <= 1;
        bad_was <= !rst && !clear && bad;
        if (load) begin
            all_right <= all_right && !wrong;
            open      <= space != 7;
            writes    <= anew ? 1 : writes + 1;
            sum       <= (anew ? 0 : {sum[30:0], sum[31]}) ^ data[31:0] ^ data[63:32] ^ {space, index};
            brought   <= anew && EXACT == 0 ? brings : brought | brings;
        end
        if (rst || clear) begin
            {all_right, open} <= 2'b11;
            {writes, sum, brought} <= 0;
        end
    end
    always @* if (fresh && !rst) begin
        if (bad_was) assert (bad);
        assert (bad == !all_right);
        if (ready) assert (!open && !bad && (EXACT != 0 || brought == 6'h3F));
        if (open) assert (!ready);
        // A close is right only with the count and the checksum of the writes since the last one.
        if (load && space == 7 && !wrong) assert (open && writes != 0 && data == {16'd0, writes, sum});
        if (closes) assert (load && !bad && !wrong);
        // What makes these inductive.
        assert (closed == !open && seen == brought && count == writes && checksum == sum);
        cover (ready && writes == 7);
        cover (bad && bad_was && writes == 3);
    end
