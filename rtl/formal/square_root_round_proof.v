// SPDX-License-Identifier: MIT
/* square_root: the lemma of one round, for any numbers of the width that is built. */
module square_root_round_proof #(
    parameter WORD = 35
) (
    input wire              clk,
    input wire              rst,
    input wire              start,
    input wire [2*WORD-1:0] radicand
);
    wire          busy, done;
    wire [WORD:0] root;
    square_root #(.WORD(WORD)) dut (
        .clk(clk), .rst(rst), .start(start), .radicand(radicand), .busy(busy), .done(done), .root(root)
    );
endmodule
