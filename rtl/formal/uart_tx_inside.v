// SPDX-License-Identifier: MIT
    // Read inside uart_tx, by its proof; written from its header: from the cycle after a byte is handed over the line
    // carries a low bit, the byte from its lowest bit on and a high bit, each for DIVIDER cycles; then it is high, and
    // ready.
    reg  [9:0] place = 0; // cycle of the byte, from 1; 0: none
    reg  [7:0] sent = 0;
    reg        began = 0;
    wire [9:0] bits  = {1'b1, sent, 1'b0};
    wire [3:0] which = (place - 1) / DIVIDER;
    wire [9:0] rest  = ~(~bits >> which); // high bits move in
    always @(posedge clk) begin
        began <= 1;
        place <= rst ? 0 : place != 0 ? (place == 10 * DIVIDER ? 0 : place + 1) : valid;
        if (place == 0) sent <= data;
    end
    always @* if (began && !rst) begin
        assert (ready == (place == 0));
        assert (line == (place == 0 || bits[which]));
        // What makes these inductive.
        assert (place <= 10 * DIVIDER);
        if (place != 0) assert (missing == 10 - which && wait_for == DIVIDER - 1 - (place - 1) % DIVIDER);
        if (place != 0) assert (shifted == rest[9:1] || (which == 9 && &shifted));
        cover (place == 10 * DIVIDER && sent == 8'hA5);
    end
