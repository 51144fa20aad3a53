    // Read inside streamer, by its proof; written from its header.
    reg  told = 0;                         // of a stop or a bank outside, in this run
    reg  no_run = 1, left = 0, ended = 0;  // no beat is to come; one of this run has left; the final one was taken
    reg  waits = 0, fresh_rst = 1, ran = 0, evaluated = 0;
    reg  valid_was = 0, ready_was = 0, far_was = 0, beyond_was = 0, unsure_was = 0;
    reg  [DIM*WORD+WORD+6:0]   beat_was;
    reg  [DIM*WORD+WORD+4:0]   latest = 0; // beat of this run; 0 before the first
    reg  [2*DIM*WORD-1:0]      points_was; // of the two cycles before: soft_limits compares in two
    wire [DIM*WORD+WORD+5:0]   beat = {stopped, point_out, position};
    wire fresh = valid && (!valid_was || ready_was);
    always @(posedge clk) begin
        fresh_rst  <= rst;
        evaluated  <= state == EVALUATE;
        ran        <= !rst && busy;
        valid_was  <= !rst && valid;
        ready_was  <= ready;
        waits      <= !rst && valid && !ready;
        beat_was   <= {beat, last};
        far_was    <= far_now;
        beyond_was <= beyond_now;
        points_was <= {points_was, point};
        no_run     <= rst || (no_run ? !begins : valid && ready && last);
        ended      <= !rst && !begins && (ended || (valid && ready && last));
        told       <= !rst && busy && (told || stop || outside);
        left       <= !rst && !begins && (left || valid);
        if (begins) latest <= 0;
        else if (valid && !stopped) latest <= beat;
    end
    // ---- Each distance that is taken is moved once, and only then the next is taken.
    reg         owed = 0;      // a distance whose step has not begun
    reg         open = 0;      // the run may take distances: not after the last one, nor after a cut
    reg  [5:0]  at = 0;        // piece of the latest step, if there is one
    reg         known = 0;
    always @(posedge clk) begin
        owed <= !clear && !begins && (adding && fed ? 1 : owed && !step);
        open <= !clear && (begins || (open && !(adding && fed && (fed_last || fed_cut))));
        if (step) at <= piece;
        known <= !rst && !begins && (known || step);
    end
    always @* if (!fresh_rst && !rst) begin
        assert (!(busy && done) && no_run == !busy);
        if (waits) assert (valid && {beat, last} == beat_was);
        if (done) assert (ended && ran && !valid);
        if (valid) assert (busy && (last || !stopped));
        // A point that raised a flag never leaves, nor one that was not compared as it is.
        if (fresh && !stopped) begin
            assert (!beyond_was && !(far_was && left));
            assert (points_was[DIM*WORD-1:0] == point_out && points_was[2*DIM*WORD-1:DIM*WORD] == point_out);
            assert (faults == 0);
        end
        if (valid && stopped) assert (beat == {1'b1, latest[DIM*WORD+WORD+4:0]});
        if (valid && last && faults != 0) assert (stopped);
        if (adding && fed) assert (!owed && open);
        if (step) assert (owed);
        if (step && !anew) assert (known && piece == at);
        assert (stopping == told);
        // What makes these inductive.
        assert (state <= DRAIN && no_run == (state == IDLE) && (state == DRAIN) == (valid && last));
        if (state == IDLE) assert (!valid);
        if (done) assert (state == IDLE);
        if (busy && state != DRAIN) assert (sent == (left || valid));
        if (busy && !(valid && !stopped)) assert ({point_out, position} == latest);
        if (stopped) assert (state == DRAIN || state == IDLE);
        if (state != CLOSE && state != DRAIN && state != IDLE) assert (!beyond && !too_far);
        assert (pending == evaluated);
        if (state == CHECK && compared) assert (!pending && points_was[DIM*WORD-1:0] == point);
        if (state == OFFER) assert (!pending && !compared && points_was == {point, point});
        if (compared && busy) assert (state == CHECK);
        assert (adding + comparing + settled <= 1 && owed == (comparing || settled));
        if (busy && state != CLOSE && !open) assert (!adding && (!owed || is_last || is_cut));
        if (open) assert (!(owed && (is_last || is_cut)) && !now_last);
        if (over && busy) assert (now_last && !open);
        if (now_last && busy && state != CLOSE) assert (!open && !owed);
        if (state == IDLE || state == DRAIN) assert (!open && !adding && !owed);
        if (busy && state < CLOSE && known && (!owed || !anew)) assert (piece == at);
        if (busy && state != CLOSE && !known && adding) assert (length == 0 && !no_more);
        if (busy && state != CLOSE && !known && owed) assert (anew || (length == 0 && !no_more && !settled));
        if (busy && final_point) assert (over && state >= CHECK);
        cover (done && !stopped && left);
        cover (valid && stopped && latest != 0 && faults == 5'b01000);
        cover (step && anew && at == 6'h20);
    end
