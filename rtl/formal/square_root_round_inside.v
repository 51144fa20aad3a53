// SPDX-License-Identifier: MIT
    // Read inside square_root, by the proof of its round: from any state in which the remainder is at most twice the
    // root so far, a step leaves 4 remainder + two bits - (4 root + 1) if its bit is 1, so that root^2 + remainder
    // stays the radicand so far; and what is left is at most twice the new root.
    generate for (i = 0; i < 4; i = i + 1) begin : lemma
        wire [WORD+4:0] brought = {1'b0, rest[i], digits[2*PAIRS-1-2*i-:2]};
        always @* if (!partial[WORD] && !partial[WORD-1] && !partial[WORD-2] && !partial[WORD-3]
                      && remainder <= {partial, 1'b0}) begin
            assert (rest[i+1] <= {found[i+1], 1'b0});
            assert (found[i+1][WORD:1] == found[i][WORD-1:0]);
            assert ({3'd0, rest[i+1]} + (found[i+1][0] ? {2'd0, found[i], 2'b01} : {WORD+5{1'b0}}) == brought);
        end
    end endgenerate
    always @* cover (remainder <= {partial, 1'b0} && partial != 0 && found[4][3:0] == 4'd9);
