// SPDX-License-Identifier: MIT
/*
 * Enables of the motor drivers: the stop input cuts them through gates, so that no clock is needed.
 *
 * Format    stop: asynchronous, high stops. It is meant for a contact that opens to stop, between the pin and ground,
 *           with a pull-up at the pin: a broken wire stops as well.
 * Rounding  none.
 * Latency   enable falls with the rise of stop or rst, through one gate. enabled and tripped follow stop in their
 *           registers, by their asynchronous set and reset, and rst with the clock. After stop is released, enable
 *           stays low until on rises anew.
 * Flags     pressed: stop, until two cycles after its fall; tripped: stop has been high since the last order `on`.
 *
 * The order `on` is a rise of on; while pressed is high it is ignored, so a level that is held enables nothing. off
 * wins over on.
 */
`default_nettype none

module emergency_stop (
    input  wire clk,
    input  wire rst,
    input  wire stop,
    input  wire on,
    input  wire off,
    output wire enable,
    output reg  enabled,
    output reg  tripped,
    output wire pressed
);
    reg [1:0] seen;
    reg       was_on;
    wire      asked = on && !was_on && !pressed;
    assign pressed = seen[1];
    assign enable  = enabled && !stop && !rst;

    always @(posedge clk) was_on <= on;

    always @(posedge clk or posedge stop) begin
        if (stop) seen <= 2'b11;
        else seen <= {seen[0], 1'b0};
    end

    always @(posedge clk or posedge stop) begin
        if (stop) enabled <= 1'b0;
        else if (rst || off) enabled <= 1'b0;
        else if (asked) enabled <= 1'b1;
    end

    always @(posedge clk or posedge stop) begin
        if (stop) tripped <= 1'b1;
        else if (rst || asked) tripped <= 1'b0;
    end
endmodule

`default_nettype wire
