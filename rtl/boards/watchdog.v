// SPDX-License-Identifier: MIT
/*
 * Watchdog: tells when the host has been silent for too long, every time anew.
 *
 * Format    fed: high for one cycle whenever the host has been heard. forget: high for a cycle at a new origin.
 * Rounding  none.
 * Latency   expired rises CYCLES cycles after the latest fed, or after armed rose, and falls with the next fed or
 *           with armed.
 * Flags     expired; silent: expired has risen since armed rose and since the latest forget.
 */
`default_nettype none

module watchdog #(
    // Longest silence, in cycles: 2 to 2^31 - 1.
    parameter integer CYCLES = 25000000
) (
    input  wire clk,
    input  wire rst,
    input  wire armed,
    input  wire fed,
    input  wire forget,
    output reg  expired,
    output reg  silent
);
    generate if (CYCLES < 2) begin : check_cycles
        watchdog_CYCLES_must_be_from_2_to_2_to_the_31 stop ();
    end endgenerate

    localparam [31:0] LAST = CYCLES - 1;
    reg [31:0] silence;
    always @(posedge clk) begin
        if (!expired) silence <= silence + 32'd1;
        if (silence == LAST) {expired, silent} <= 2'b11;
        if (fed) begin
            silence <= 32'd0;
            expired <= 1'b0;
            silent  <= silent;
        end
        if (forget) silent <= 1'b0;
        if (rst || !armed) begin
            silence <= 32'd0;
            {expired, silent} <= 2'b00;
        end
    end
endmodule

`default_nettype wire
