// SPDX-License-Identifier: MIT
/* uart_tx, for any bytes at any time and a reset at any time: what uart_tx_inside.v says, in runs of any length. */
module uart_tx_proof (input wire clk, input wire again, input wire [7:0] data, input wire valid);
    reg started = 0;
    always @(posedge clk) started <= 1;
    uart_tx #(.DIVIDER(4)) dut (.clk(clk), .rst(!started || again), .data(data), .valid(valid));
endmodule
