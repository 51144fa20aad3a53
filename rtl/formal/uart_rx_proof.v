// SPDX-License-Identifier: MIT
/* uart_rx behind a sender of its own rate: what uart_rx_inside.v says, in runs of any length. */
module uart_rx_proof (input wire clk, input wire line);
    reg started = 0;
    always @(posedge clk) started <= 1;
    uart_rx #(.DIVIDER(8)) dut (.clk(clk), .rst(!started), .line(line));
endmodule
