// SPDX-License-Identifier: MIT
/*
 * Serial transmitter: 8 data bits, no parity, one stop bit.
 *
 * Format    line: high while idle, lowest bit first.
 * Rounding  none.
 * Latency   a byte that valid and ready hand over takes 10 bits of DIVIDER cycles; ready rises with the end of its
 *           stop bit.
 * Flags     none.
 */
`default_nettype none

module uart_tx #(
    // Cycles of a bit: 4 to 65535.
    parameter integer DIVIDER = 434
) (
    input  wire       clk,
    input  wire       rst,
    input  wire [7:0] data,
    input  wire       valid,
    output wire       ready,
    output reg        line
);
    generate if (DIVIDER < 4 || DIVIDER > 65535) begin : check_divider
        uart_tx_DIVIDER_must_be_from_4_to_65535 stop ();
    end endgenerate

    localparam [15:0] WHOLE = DIVIDER[15:0] - 16'd1;
    reg [3:0]  missing;
    reg [15:0] wait_for;
    reg [8:0]  shifted; // what follows the bit on the line
    assign ready = missing == 4'd0;

    always @(posedge clk) begin
        wait_for <= wait_for - 16'd1;
        if (ready && valid) begin
            missing  <= 4'd10;
            wait_for <= WHOLE;
            line     <= 1'b0;
            shifted  <= {1'b1, data};
        end else if (!ready && wait_for == 16'd0) begin
            missing  <= missing - 4'd1;
            wait_for <= WHOLE;
            line     <= shifted[0];
            shifted  <= {1'b1, shifted[8:1]};
        end
        if (rst) begin
            missing <= 4'd0;
            line    <= 1'b1;
        end
    end
endmodule

`default_nettype wire
