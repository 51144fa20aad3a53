// SPDX-License-Identifier: MIT
    // Read inside axil_slave, by its proof: what is answered OKAY has been written once, with the address and data of
    // the latest request, and nothing else has; a read brings what the owner gave when it was taken.
    reg        fresh = 0, answered = 0, written = 0; // a reset was; an answer waits; the write took effect
    reg [5:0]  aw;
    reg [35:0] w;
    reg [33:0] r;
    always @(posedge clk) begin
        fresh    <= 1;
        answered <= !rst && s_axil_bvalid && !s_axil_bready;
        written  <= write && !rst;
        if (s_axil_awvalid && s_axil_awready) aw <= s_axil_awaddr;
        if (s_axil_wvalid && s_axil_wready) w <= {s_axil_wdata, s_axil_wstrb};
        if (s_axil_arvalid && s_axil_arready) r <= {!read_allowed || s_axil_araddr[1:0] != 0, 1'b0, read_data};
    end
    always @* if (fresh && !rst) begin
        if (!s_axil_awready) assert (address == aw);
        if (!s_axil_wready) assert ({write_data, strobes} == w);
        assert (complete == (!s_axil_awready && !s_axil_wready && !s_axil_bvalid));
        assert (write == (complete && write_allowed && aw[1:0] == 0 && &w[3:0]));
        if (write) assert (write_at == aw[5:2] && write_data == w[35:4]);
        if (s_axil_bvalid && !answered) assert (s_axil_bresp == (written ? 2'b00 : 2'b10));
        if (!s_axil_bvalid || answered) assert (!written);
        if (s_axil_bvalid) assert (!s_axil_bresp[0]);
        if (s_axil_rvalid) assert ({s_axil_rresp, s_axil_rdata} == r);
        assert (read_at == s_axil_araddr[5:2]);
    end
