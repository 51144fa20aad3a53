// SPDX-License-Identifier: MIT
    // Read inside kout, by its proof: a start while busy is low is answered once, none else is; the axes of the chord
    // as they were at the start are squared, one after the other and each once; their sum goes to the root once, when
    // it is complete, its answer to the division once; and s du is asked for from then on.
    reg                fresh = 0, asked = 0; // a reset was; an order is on its way
    reg [DIM*WORD-1:0] chord_was;
    reg [1:0]          squared = 0;          // axes that have been asked for
    reg [1:0]          added = 0;            // squares that have come back
    reg                rooted = 0, divided = 0;
    reg [2*WORD-1:0]   sum;
    always @(posedge clk) begin
        fresh <= 1;
        if (square) squared <= (begins ? 0 : squared) + 1;
        if (square_valid[2]) sum <= (added == 0 ? 0 : sum) + product;
        if (square_valid[2]) added <= added + 1;
        if (radicand_complete) rooted <= 1;
        if (root_done) divided <= 1;
        if (done) asked <= 0;
        if (begins) begin
            {asked, rooted, divided, added} <= 5'b1_0_0_00;
            chord_was <= chord;
        end
        if (rst) {asked, squared, added, rooted, divided} <= 0;
    end
    wire [2:0] travelling = {2'b00, square_valid[0]} + {2'b00, square_valid[1]} + {2'b00, square_valid[2]};
    wire       pending = working && !rooted;
    always @* if (fresh && !rst) begin
        assert (working == asked);
        assert (busy == (asked && !done));
        if (done) assert (asked && rooted && divided);
        if (squaring) assert (a == chord_was[squared*WORD+:WORD] && b == a && squared < DIM);
        if (begins) assert (a == chord[WORD-1:0] && b == a);
        if (!square) assert (a == {1'b0, s} && b == du);
        if (radicand_complete) assert (added == DIM - 1 && !rooted && squares == sum + product);
        if (root_done) assert (rooted && !divided && !square);
        // What makes these inductive.
        if (!pending) assert (!squaring && square_valid == 0);
        if (pending)
            assert (squared != 0 && squared <= DIM && squaring == (squared != DIM) && added + travelling == squared);
        if (pending && squaring) assert (axis == squared && square_valid == (1 << squared) - 1);
        if (pending && !squaring) assert (axis == 0
            && (DIM == 2 ? square_valid == 3 || square_valid == 6 : square_valid == 7 || square_valid == 6)
                                          || square_valid == 4);
        if (!square) assert (axis == 0);
        if (squaring) assert (later[WORD-1:0] == chord_was[squared*WORD+:WORD]);
        if (squaring && DIM == 3 && squared == 1) assert (later[(DIM-2)*WORD+:WORD] == chord_was[(DIM-1)*WORD+:WORD]);
        // The square of the last axis travels last.
        if (square_valid[0]) assert (square_last[0] == (squared == DIM));
        if (square_valid[1]) assert (square_last[1] == (squared == DIM && !square_valid[0]));
        if (square_valid[2]) assert (square_last[2] == (squared == DIM && !square_valid[1] && !square_valid[0]));
        if (pending && added != 0) assert (radicand == sum);
        if (pending && added == 0) assert (radicand == 0);
        assert (!divided || rooted);
        assert (root_busy + root_done + divide_busy + done <= 1);
        assert ((root_busy || root_done) == (rooted && !divided && working));
        assert ((divide_busy || done) == (divided && working));
        cover (done && start);
    end
