// SPDX-License-Identifier: MIT
/*
 * Step and direction outputs of one axis, by an accumulator: steps are spread evenly over the period.
 *
 * In every cycle the accumulator grows by advance. When it reaches half of modulus (or falls below minus that), a step
 * forward (or back) is due and modulus is taken off (or added). So modulus * position + accumulator is exactly the sum
 * of all advances since origin, and position is that sum over modulus, to the nearest step, halves up.
 *
 * Format    modulus: one step times the cycles of a period, even, 2 or more; another one only with clear. advance:
 *           what the period moves, in the same fraction of a step, two's complement; at most modulus / (2 * PULSE + 1)
 *           in size, so that pulses keep up. position: 32 bits, in two's complement.
 * Rounding  none but that of position.
 * Latency   position changes a cycle after the accumulator's edge, step at least 1 cycle later; behind a turn it
 *           comes up to PULSE + SETUP cycles later.
 * Flags     lost: more than 7 steps were due, so those beyond were left out, of position too; stays until origin.
 *           moving: advance is not 0, or a step is due.
 *
 * step is high for PULSE cycles and low for at least PULSE. dir (1: back) changes only while step has been low for
 * PULSE cycles, and step rises at least SETUP cycles later; only rst breaks this off, after which both are low.
 * clear empties the accumulator and what is due: position is then that of the pins, and no step begins. origin makes
 * the position 0.
 */
`default_nettype none

module step_dir #(
    // Width of modulus and advance: 4 to 62.
    parameter integer WIDTH = 31,
    // Cycles that step stays high, and least cycles that it stays low: 1 to 65535.
    parameter integer PULSE = 50,
    // Cycles from a change of dir to the next step: 1 to 65535, and at most 6 PULSE, or turns lose steps.
    parameter integer SETUP = 50
) (
    input  wire                    clk,
    input  wire                    rst,
    input  wire                    clear,
    input  wire                    origin,
    input  wire signed [WIDTH-1:0] modulus,
    input  wire signed [WIDTH-1:0] advance,
    output reg                     step,
    output reg                     dir,
    output reg  signed [31:0]      position,
    output reg                     lost,
    output wire                    moving
);
    generate if (WIDTH < 4 || WIDTH > 62) begin : check_width
        step_dir_WIDTH_must_be_from_4_to_62 stop ();
    end
    if (PULSE < 1 || PULSE > 65535) begin : check_pulse
        step_dir_PULSE_must_be_from_1_to_65535 stop ();
    end
    if (SETUP < 1 || SETUP > 65535 || SETUP > 6 * PULSE) begin : check_setup
        step_dir_SETUP_must_be_from_1_to_65535_and_6_PULSE stop ();
    end endgenerate

    // ---- Which steps are due.

    reg  signed [WIDTH-1:0] accumulator; // from -modulus / 2, less than modulus / 2
    wire signed [WIDTH-1:0] half = modulus >>> 1;
    wire signed [WIDTH-1:0] next = accumulator + advance;
    wire                    forward = next >= half;
    wire                    back    = next < -half;

    reg signed [3:0] due; // steps that are due and not yet on the pins
    wire             takes, takes_back;
    wire              drops = !takes && (forward ? due == 4'sd7 : back && due == -4'sd7);
    wire signed [3:0] one = drops ? 4'sd0 : {{3{back}}, forward || back}, taken = {{3{takes_back}}, takes};
    wire signed [3:0] left = due + one - taken;
    assign moving = advance != {WIDTH{1'b0}} || due != 4'sd0 || step;

    always @(posedge clk) begin
        accumulator <= forward ? next - modulus : back ? next + modulus : next;
        position    <= position + {{28{one[3]}}, one};
        due         <= left;
        if (drops) lost <= 1'b1;
        if (rst || clear || origin) begin
            accumulator <= {WIDTH{1'b0}};
            position    <= position - {{28{due[3]}}, due};
            due         <= 4'sd0;
        end
        if (rst || origin) begin
            position <= 32'sd0;
            lost     <= 1'b0;
        end
    end

    // ---- The pins.

    localparam [15:0] LONG = PULSE[15:0] - 16'd1, BEFORE = SETUP[15:0] - 16'd1,
                      LONGER = LONG > BEFORE ? LONG : BEFORE;
    reg  [15:0] wait_for;
    wire        free = !step && wait_for == 16'd0 && due != 4'sd0 && !clear && !origin;
    wire        wanted = due < 4'sd0;
    assign takes      = free && dir == wanted;
    assign takes_back = takes && wanted;

    always @(posedge clk) begin
        if (wait_for != 16'd0) wait_for <= wait_for - 16'd1;
        else if (step) begin
            step     <= 1'b0;
            wait_for <= LONG;
        end else if (takes) begin
            step     <= 1'b1;
            wait_for <= LONG;
        end else if (free) begin
            dir      <= wanted;
            wait_for <= BEFORE;
        end
        if (rst) begin
            step     <= 1'b0;
            dir      <= 1'b0;
            wait_for <= LONGER;
        end
    end
endmodule

`default_nettype wire
