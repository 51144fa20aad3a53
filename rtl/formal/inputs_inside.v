// SPDX-License-Identifier: MIT
    // Read inside inputs, by its proof; written from its header.
    reg         begun = 0, known = 0;
    wire [1:0]  calm, came;   // at its level, and counted back to it; its edge has come
    reg  [95:0] kept;         // positions of the latest cycle in which the watched ones were calm
    genvar k;
    generate for (k = 0; k < 2; k = k + 1) begin : model
        reg       was, was_2;               // the pin, one and two cycles ago
        reg       level, on_watch, edge_to, edge_came;
        reg [1:0] margin;                   // cycles seen away less those seen back
        wire      flips = was_2 != level && margin + 1 == BOUNCE;
        assign    calm[k] = !on_watch || (was_2 == level && margin == 0);
        assign    came[k] = edge_came;
        always @(posedge clk) begin
            {was_2, was} <= {was, pins[k]};
            margin <= flips ? 0 : was_2 != level ? margin + 1 : margin == 0 ? 0 : margin - 1;
            if (flips) level <= was_2;
            if (flips && on_watch && was_2 == edge_to) edge_came <= 1;
            if (write) {on_watch, edge_to, edge_came} <= {data[k], data[16 + k], 1'b0};
            if (rst) {was_2, was, level, margin, on_watch, edge_to, edge_came} <= {{3{pins[k]}}, 5'd0};
        end
        always @* if (begun) begin
            assert (levels[k] == level && watched[k] == on_watch && edges[k] == edge_to && hit[k] == edge_came);
            assert (margin < BOUNCE);
            assert (seen[k] == was_2 && settling[k] == was); // what makes these inductive
        end
    end endgenerate
    always @(posedge clk) begin
        begun <= 1;
        if (write) assert (write_at == 4'd1);
        if (came == 0 && calm == 2'b11) {known, kept} <= {1'b1, positions};
        if (!begun) known <= 0;
    end
    always @* if (begun) begin
        assert (halt == (came != 0));
        if (known) assert (place == kept);
        assert (pin[0].away == model[0].margin && pin[1].away == model[1].margin);
        cover (known && came == 2'b10 && model[1].margin == 2);
        cover (known && came == 2'b01 && calm == 2'b01 && place != positions);
    end
