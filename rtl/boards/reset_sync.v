// SPDX-License-Identifier: MIT
/*
 * Reset of one clock domain: rises at once, even while the clock stands still, and falls with the clock.
 *
 * Format    ok: asynchronous; low asks for the reset. rst: active high.
 * Rounding  none.
 * Latency   rst rises with the fall of ok and falls at the third edge of clk after the rise of ok, so that a register
 *           that goes metastable at the release has two cycles to settle.
 * Flags     none.
 */
`default_nettype none

module reset_sync (
    input  wire clk,
    input  wire ok,
    output wire rst
);
    reg [2:0] held;
    always @(posedge clk or negedge ok) begin
        if (!ok) held <= 3'b111;
        else held <= {held[1:0], 1'b0};
    end
    assign rst = held[2];
endmodule

`default_nettype wire
