// SPDX-License-Identifier: MIT
    // Read inside watchdog, by its proof; written from its header.
    reg        begun = 0, told = 0;
    reg [7:0]  since = 0; // cycles since the latest fed, or since armed rose; 255 for more
    always @(posedge clk) begin
        begun <= 1;
        since <= rst || !armed || fed ? 0 : since == 255 ? 255 : since + 1;
        told  <= !rst && armed && !forget && (told || (since == CYCLES - 1 && !fed));
    end
    always @* if (begun) begin
        assert (expired == (since >= CYCLES));
        assert (silent == told);
        assert (silence == (since > CYCLES ? CYCLES : since)); // what makes this inductive
        cover (silent && !expired && since == 3);
        cover (expired && !silent);
        cover (since == CYCLES + 2);
    end
