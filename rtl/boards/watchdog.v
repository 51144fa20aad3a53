/*
 * Watchdog: tells when the host has been silent for too long.
 *
 * Format    fed: high for one cycle whenever the host has been heard.
 * Rounding  none.
 * Latency   expired rises CYCLES cycles after the latest fed, or after armed rose, and stays until armed falls.
 * Flags     expired.
 */
`default_nettype none

module watchdog #(
    // Longest silence, in cycles: 2 to 2^31.
    parameter CYCLES = 25000000
) (
    input  wire clk,
    input  wire rst,
    input  wire armed,
    input  wire fed,
    output reg  expired
);
    generate if (CYCLES < 2) begin : check_cycles
        watchdog_CYCLES_must_be_2_or_more stop ();
    end endgenerate

    localparam [31:0] LAST = CYCLES - 1;
    reg [31:0] silence;
    always @(posedge clk) begin
        silence <= silence + 32'd1;
        if (silence == LAST && !fed) expired <= 1'b1;
        if (fed || expired) silence <= 32'd0;
        if (rst || !armed) begin
            silence <= 32'd0;
            expired <= 1'b0;
        end
    end
endmodule

`default_nettype wire
