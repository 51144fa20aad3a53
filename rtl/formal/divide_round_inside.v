// SPDX-License-Identifier: MIT
    // Read inside divide, by the proof of its round: from any state in which the remainder is below the divisor,
    // every digit takes its multiple of the divisor off the remainder with the next bit below it, and what is left is
    // below the divisor.
    generate for (i = 0; i < 4; i = i + 1) begin : lemma
        always @* if (remainder < divisor) begin
            assert (rest[i+1] < divisor);
            assert ({1'b0, rest[i+1]} + (bits[3-i] ? {1'b0, divisor} : {WORD+1{1'b0}})
                    == {rest[i], digits[DIGITS-1-i]});
        end
    end endgenerate
    always @* cover (remainder < divisor && bits == 4'd9 && rest[4] != 0);
