// SPDX-License-Identifier: MIT
/*
 * Serial receiver: 8 data bits, no parity, one stop bit.
 *
 * Format    line: asynchronous, high while idle, lowest bit first. data: the byte, while valid.
 * Rounding  bits are sampled in their middle, to one cycle; the sender's rate may differ by 4 % if DIVIDER is 16 or
 *           more.
 * Latency   valid or failed rises in the middle of the stop bit, for one cycle.
 * Flags     failed: the stop bit was low. active: a byte is on its way. After a line that stays low, and after rst,
 *           nothing begins until it has been high for a cycle.
 */
`default_nettype none

module uart_rx #(
    // Cycles of a bit: 4 to 65535.
    parameter integer DIVIDER = 434
) (
    input  wire       clk,
    input  wire       rst,
    input  wire       line,
    output wire [7:0] data,
    output reg        valid,
    output reg        failed,
    output wire       active
);
    generate if (DIVIDER < 4 || DIVIDER > 65535) begin : check_divider
        uart_rx_DIVIDER_must_be_from_4_to_65535 stop ();
    end endgenerate

    localparam [15:0] WHOLE = DIVIDER[15:0] - 16'd1, HALF = {1'b0, DIVIDER[15:1]} - 16'd1;
    reg [2:0]  seen;    // the line: two cycles to settle, and the one before
    reg [3:0]  missing; // bits of this byte, its start and stop bits included
    reg [15:0] wait_for;
    reg [7:0]  shifted; // the start bit falls out at the lower end
    wire       sampled = active && wait_for == 16'd0;
    assign active = missing != 4'd0;
    assign data   = shifted;

    always @(posedge clk) begin
        seen     <= {seen[1:0], line};
        valid    <= 1'b0;
        failed   <= 1'b0;
        wait_for <= wait_for - 16'd1;
        if (!active) begin
            wait_for <= HALF;
            if (seen[2:1] == 2'b10) missing <= 4'd10;
        end
        if (sampled) begin
            wait_for <= WHOLE;
            missing  <= missing - 4'd1;
            shifted  <= {seen[1], shifted[7:1]};
            if (missing == 4'd10 && seen[1]) missing <= 4'd0; // the start bit was a spike
            if (missing == 4'd1) begin
                shifted <= shifted;
                valid   <= seen[1];
                failed  <= !seen[1];
            end
        end
        if (rst) begin
            missing <= 4'd0;
            seen    <= 3'b000;
            valid   <= 1'b0;
            failed  <= 1'b0;
        end
    end
endmodule

`default_nettype wire
