// SPDX-License-Identifier: MIT
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
    // ---- Outputs: of a piece, as its number tells (streamer_proof.v).
    reg  [3:0]  outputs_was;
    reg         entered = 0;   // a piece, in this run
    wire [3:0]  of_at = at[3:0] ^ {2{at[5:4]}}, of_piece = piece[3:0] ^ {2{piece[5:4]}};
    wire [3:0]  of_ahead = ahead[3:0] ^ {2{ahead[5:4]}};
    wire [5:0]  beat_piece = position[WORD+4:WORD-1];
    always @(posedge clk) begin
        outputs_was <= outputs;
        entered     <= !rst && !begins && (entered || (comparing && passes && fetched));
    end
    always @* if (!fresh_rst && !rst) begin
        if (waits) assert (outputs == outputs_was);
        if (fresh && !stopped)
            assert (outputs == (!left ? 0 : last ? of_at : beat_piece[3:0] ^ {2{beat_piece[5:4]}}));
        if (valid && stopped) assert (outputs == 0);
        cover (fresh && left && outputs == 1 && beat_piece == 1);
        // What makes these inductive.
        if (state == IDLE || state == DRAIN || (over && state != CLOSE)) assert (!step_busy && !step_done);
        if (busy && state < CLOSE) begin
            assert (!(fetched && fetching != 0) && fetching < 4);
            if (fetched) assert (next_bits == of_ahead);
            if (entered) assert (bits == of_piece);
            if (settled || known || (owed && anew)) assert (entered);
            if (known) assert (now_piece == at && now_bits == of_at);
            if (over || final_point || now_last || step_busy || step_done || waiting) assert (known);
            if (state == RUN || final_point) assert (sent);
            if (state > RUN && state < CLOSE)
                assert (point_bits == (!sent ? 0 : final_point ? of_at : point_piece[3:0] ^ {2{point_piece[5:4]}}));
        end
    end
    always @* if (!fresh_rst && !rst) begin
        assert (!(busy && done) && no_run == !busy);
        if (begins) assert (!load && !close && !stop);
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
