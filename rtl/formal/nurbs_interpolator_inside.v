// SPDX-License-Identifier: MIT
    // Read inside nurbs_interpolator, by its proof; written from its header.
    reg permit_was = 0, running = 0, rst_was = 1;
    reg ended_was, aborted_was, go_was, forget_was, stop_was, busy_was;
    always @(posedge clk) begin
        permit_was <= permit;
        rst_was    <= rst;
        running    <= busy;
        {ended_was, aborted_was, go_was, forget_was, stop_was, busy_was} <= {ended, aborted, go, forget, stop, busy};
    end
    always @* if (!rst && !rst_was) begin
        if (go) assert (!busy && permit && !halt);
        if (halt) assert (stop);
        if (load) assert (SLOPE == 1 ? writable : !busy);
        assert ({2'b00, go} + {2'b00, write && forget && permit} + {2'b00, stop && !halt} + {2'b00, load} <= 3'd1);
        if (stop_was && !forget_was) assert (!busy_was || aborted);
        if (permit_was && !permit) assert (forget);
        if (forget_was) assert (!ended && !aborted && !refused && seen == 0 && rate == 9'd256);
        if (go_was && !forget_was && aborted_was) assert (aborted);
        assert (rate <= 9'd256);
        cover (go && complete);
        cover (stop && busy && !halt);
        cover (aborted && halt);
        cover (forget && busy && !permit);
    end
