// SPDX-License-Identifier: MIT
    // Read inside uart_rx, by its proof; written from its header. A sender begins whenever it likes, at once after a
    // byte too, and may send a low stop bit. Each byte is told once, in the middle of its stop bit, valid with its
    // bits or failed; nothing else is. The line settles in two cycles, and what is sampled is told a cycle later.
    localparam TOLD = 9 * DIVIDER + DIVIDER / 2 + 4;
    reg  [6:0] place = 0; // cycle of the byte, from 1; 0: none
    reg  [7:0] sent = 0;
    reg        stop = 1;
    reg  [2:0] lines = 0; // of the cycles before
    wire [9:0] bits = {stop, sent, 1'b0};
    wire       begins = $anyseq;
    wire [8:0] any = $anyseq;
    always @* assume (line == (place == 0 || bits[(place - 1) / DIVIDER]));
    always @(posedge clk) begin
        lines <= rst ? 0 : {lines[1:0], line};
        if (!rst && begins && (place == 0 || (place == 10 * DIVIDER && stop))) {place, stop, sent} <= {7'd1, any};
        else place <= place == 10 * DIVIDER || place == 0 ? 0 : place + 1;
    end
    wire [6:0] into = place - 4; // cycles since the start bit was seen
    wire [3:0] read = into < DIVIDER / 2 ? 0 : 1 + (into - DIVIDER / 2) / DIVIDER; // bits
    wire [7:0] kept = sent << (9 - read);
    always @* if (!rst) begin
        assert (valid == (place == TOLD && stop));
        assert (failed == (place == TOLD && !stop));
        if (valid) assert (data == sent);
        cover (valid && sent == 8'h5A);
        cover (failed && sent == 8'h00);
        // What makes these inductive.
        assert (place <= 10 * DIVIDER && seen == lines);
        if (place != 0) assert (lines[0] == (place == 1 || bits[(place - 2) / DIVIDER]));
        if (place > 1) assert (lines[1] == (place == 2 || bits[(place - 3) / DIVIDER]));
        if (place > 2) assert (lines[2] == (place == 3 || bits[(place - 4) / DIVIDER]));
        if (place > 3 && place < TOLD) begin
            assert (missing == 10 - read);
            assert (wait_for == (read == 0 ? DIVIDER / 2 - 1 - into : DIVIDER - 1 - (into - DIVIDER / 2) % DIVIDER));
            if (read > 1) assert (((shifted ^ kept) >> (9 - read)) == 0);
        end else assert (missing == 0);
    end
