// SPDX-License-Identifier: MIT
/* What every unit of fixed latency promises: busy from the start, one done at the end, never both. */
module latency_proof #(
    parameter LATENCY = 1
) (
    input  wire clk,
    input  wire rst,
    input  wire start,
    input  wire busy,
    input  wire done,
    // The answer to a start in the very first cycle.
    output wire first_answer
);
    reg [7:0] age = 0; // cycles since the start that is being worked on; 0: none
    reg [7:0] now = 0;
    always @(posedge clk) begin
        now <= now + 1;
        if (rst) age <= 0;
        else if (age == 0 || age == LATENCY) age <= start;
        else age <= age + 1;
    end
    assign first_answer = done && age == LATENCY && now == LATENCY;
    always @* begin
        if (now == 0) assume (!busy && !done);
        assert (!(busy && done));
        assert (busy == (age != 0 && age != LATENCY));
        assert (done == (age == LATENCY));
    end
endmodule
