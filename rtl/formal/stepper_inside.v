// SPDX-License-Identifier: MIT
    // Read inside stepper, by its proof: what makes the properties of stepper_proof.v inductive.
    reg told = 0; // of a stop, before the final beat was offered
    reg over = 1; // no beat of this run is still to come
    always @(posedge clk) begin
        told <= !rst && busy && (told || (stop && !(valid && last)));
        over <= rst || (over ? !(go && !busy && !stop) : valid && ready && last);
    end
    // A point that raises a flag never leaves: what the cycle before said of the beat that is new.
    reg       rst_was = 1, valid_was = 0, ready_was = 0, wrong_was = 0;
    wire      fresh = valid && (!valid_was || ready_was);
    always @(posedge clk) begin
        rst_was   <= rst;
        valid_was <= valid;
        ready_was <= ready;
        wrong_was <= overflow || by_zero || beyond_now || (far_now && sent) || (state == OFFER && u_next < u);
    end
    always @* if (!rst && !rst_was && fresh && !stopped) assert (!wrong_was);
    always @* if (!rst) begin
        assert (state <= DRAIN);
        assert ((state == DRAIN) == (valid && last));
        assert (over == (state == IDLE));
        if (state == IDLE) assert (!valid);
        if (done) assert (state == IDLE);
        if (valid && last && faults != 5'd0) assert (stopped);
        if (told) assert (state == CLOSE || (stopped && (state == DRAIN || state == IDLE)));
        if (stopped) assert (state == DRAIN || state == IDLE);
        if (state == STEP) assert (faults == 5'd0);
        if (state == END_POINT) assert (faults == 5'd0);
        if (state != CLOSE && state != DRAIN && state != IDLE) assert (faults[4:2] == 3'd0);
        assert (!end_start || state == END_POINT);
    end
