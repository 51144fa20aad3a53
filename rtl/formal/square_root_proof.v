// SPDX-License-Identifier: MIT
/* square_root: as divide_proof.v; the root is the nearest one. */
module square_root_proof #(
    parameter WORD = 5
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
    wire first;
    latency_proof #(.LATENCY((WORD + 4) / 4 + 1)) latency (
        .clk(clk), .rst(rst), .start(start), .busy(busy), .done(done), .first_answer(first)
    );

    reg [2*WORD-1:0] x;
    reg              later = 0;
    always @(posedge clk) begin
        later <= 1;
        if (!later) x <= radicand;
    end

    // (root - 1/2)^2 < x < (root + 1/2)^2, without the quarters: x is whole.
    wire [2*WORD+1:0] square = root * root;
    always @* cover (first && x != 0 && root > 2);
    always @* if (first) assert (x <= square + root && (root == 0 || x > square - root));
endmodule
