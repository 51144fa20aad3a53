// SPDX-License-Identifier: MIT
/*
 * Model of the phase-locked loop of an ECP5 for simulation: the output runs CLKFB_DIV / CLKI_DIV times as fast as
 * CLKI, which is measured over two periods, and LOCK rises after 8 of them. While CLKI stands still the output does as
 * well, after one more period. Phases, the other outputs and the range of the oscillator are not modelled.
 *
 * Format    clocks.
 * Rounding  none.
 * Latency   as above.
 * Flags     LOCK.
 */
`default_nettype none

module EHXPLLL #(
    parameter CLKI_DIV        = 1,
    parameter CLKFB_DIV       = 1,
    parameter CLKOP_DIV       = 8,
    parameter CLKOP_ENABLE    = "ENABLED",
    parameter CLKOP_CPHASE    = 0,
    parameter CLKOP_FPHASE    = 0,
    parameter FEEDBK_PATH     = "CLKOP",
    parameter OUTDIVIDER_MUXA = "DIVA"
) (
    input  wire CLKI,
    input  wire CLKFB,
    output reg  CLKOP,
    output reg  LOCK,
    input  wire RST,
    input  wire STDBY,
    input  wire PHASESEL0,
    input  wire PHASESEL1,
    input  wire PHASEDIR,
    input  wire PHASESTEP,
    input  wire PHASELOADREG,
    input  wire PLLWAKESYNC,
    input  wire ENCLKOP
);
    time    former, period;
    integer edges, i;
    initial begin
        CLKOP = 1'b0;
        LOCK  = 1'b0;
        edges = 0;
    end
    always @(posedge CLKI) begin
        period = $time - former;
        former = $time;
        edges  = edges + 1;
        LOCK   = edges > 8 && !RST;
    end
    // Each edge of CLKI gives the edges of the output up to the next one.
    always @(negedge CLKI) if (edges > 2) for (i = 0; i < CLKFB_DIV; i = i + CLKI_DIV) begin
        CLKOP = 1'b1;
        #(period * CLKI_DIV / CLKFB_DIV / 2) CLKOP = 1'b0;
        if (i + CLKI_DIV < CLKFB_DIV) #(period * CLKI_DIV / CLKFB_DIV / 2);
    end

    wire unused = &{1'b0, CLKFB, STDBY, PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP};
endmodule

`default_nettype wire
