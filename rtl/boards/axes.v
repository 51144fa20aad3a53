// SPDX-License-Identifier: MIT
/*
 * From points to the pins of three axes: one point a period is taken from the stream, scaled to steps, and its
 * distance from the point before is spread over a period.
 *
 * Format    points: 40 bits a field as nurbs_interpolator.v sends them, u first, at most 35 bits of a coordinate in
 *           use. scales: 32 bits an axis without sign; a coordinate times its scale over 2^32 is a place in 1/1024 of
 *           a step. largest: 32 bits an axis without sign: the most that it moves in a period, in 1/1024 of a step.
 *           period: cycles, even or odd, 16 to 2^20 - 1. positions: 32 bits an axis, steps on the pins from the
 *           origin. period and scales are those of the latest origin: others wait for the next.
 * Rounding  a place to nearest, halves up, so no error adds up from point to point; positions to the nearest step,
 *           halves up.
 * Latency   the motion to a point begins 13 cycles after it was taken and lasts a period.
 * Flags     too_fast: an axis would move by more than largest, or need more steps than one in 2 * PULSE + 1 cycles;
 *           late: within a run no point was there when the period began; lost: more than 7 steps were due; elsewhere:
 *           a run would begin more than a step from where the tool stands; cut: a run ended with a void beat while
 *           the tool moved.
 *           Flags stay until origin. moving: within a run, at rest in a hold too, or a step is due.
 *
 * origin, while enable is high, says that the tool stands at the next point: nothing moves for it, positions count
 * from it; placed is high from then on until enable falls or a flag rises. While it is low no point is taken and
 * nothing moves: neither enable nor a new run starts the motors again, but an origin and a run after it. positions
 * keep what the pins have made; once placed has fallen the tool may stand elsewhere. A void beat (tuser[0]) moves
 * nothing. outputs: those of a point (tuser[4:1]) come as the motion to it begins and stay while it lasts; those of
 * ONLY_MOVING are off if no axis moves in that period. All are off before an origin, between runs, after a void
 * beat, and from the cycle after enable fell or a flag rose. points_taken and checksum tell of all points since the
 * origin: for u and each coordinate, in this order, the checksum is rotated left by 1, then exclusive-or with the
 * lower 32 bits and with the upper 8 of the field.
 */
`default_nettype none

module axes #(
    // Cycles that step stays high, and least cycles that it stays low: 1 to 65535.
    parameter integer PULSE = 50,
    // Cycles from a change of dir to the next step: 1 to 65535, and at most 6 PULSE.
    parameter integer SETUP = 50,
    // Outputs that are on only while the tool moves, such as a laser.
    parameter [3:0]   ONLY_MOVING = 4'b1000
) (
    input  wire         clk,
    input  wire         rst,
    input  wire         enable,
    input  wire         origin,
    input  wire [19:0]  period,
    input  wire [95:0]  scales,
    input  wire [95:0]  largest,

    input  wire [159:0] s_axis_tdata,
    input  wire         s_axis_tvalid,
    output wire         s_axis_tready,
    input  wire         s_axis_tlast,
    input  wire [4:0]   s_axis_tuser,

    output wire [2:0]   step,
    output wire [2:0]   dir,
    output reg  [3:0]   outputs,
    output wire [95:0]  positions,
    output reg  [31:0]  points_taken,
    output reg  [31:0]  checksum,
    output reg          placed,
    output wire         moving,
    output reg          too_fast,
    output reg          late,
    output wire         lost,
    output reg          elsewhere,
    output reg          cut
);
    localparam WIDTH = 20 + 10 + 1; // a period's cycles, fractions of a step, a sign

    // ---- The tick.

    reg  [19:0] cycles;  // of a period, and
    reg  [19:0] left;    // of this one
    reg         running; // within a run
    wire        tick   = left == 20'd0;
    wire        halted = too_fast || late || lost || elsewhere || cut;
    wire        clear  = rst || origin || !placed;
    wire        take   = s_axis_tready && s_axis_tvalid;
    assign s_axis_tready = tick && enable && placed && !halted;

    always @(posedge clk) begin
        if (clear) cycles <= period;
        left <= tick ? cycles - 20'd1 : left - 20'd1;
        if (take) running <= !s_axis_tlast;
        if (tick && running && !s_axis_tvalid) late <= 1'b1;
        if (clear || halted) running <= 1'b0;
        if (origin) placed <= 1'b1;
        if (rst || !enable || (halted && !origin)) placed <= 1'b0;
        if (rst || origin) late <= 1'b0;
        if (rst) left <= 20'd0;
    end

    // ---- From a point to distances, axis by axis. Phase 1: u is the lowest field; 2 to 4: a coordinate enters the
    // multiplier; 5 to 7: its product is there; 6 to 8: its place; 7 to 9: its distance; 9 to 11: what it needs; 12:
    // all go.

    reg         [3:0]         phase;  // from the tick on, whether there is a point or not
    reg                       fresh;  // there is one
    reg                       first;  // none since the origin
    reg                       begins; // the point is the first of its run
    reg                       moved;  // the latest point lies elsewhere than the one before
    reg         [159:0]       point;
    reg         [3:0]         bits;   // outputs of the latest point
    reg         [95:0]        scale, most; // scale turns once a point
    wire signed [69:0]        product;
    wire signed [69:0]        rounded = product + 70'sh0_8000_0000;
    reg         [35:0]        place;
    reg         [107:0]       former;
    reg signed  [36:0]        distance;
    reg         [36:0]        size, size_q;
    reg         [53:0]        needed; // cycles, in 1/1024
    reg         [3*WIDTH-1:0] next, advance;
    multiply #(.WORD(35)) multiply_inst (.clk(clk), .a(point[34:0]), .b({3'd0, scale[31:0]}), .product(product));

    localparam [16:0] SPACING = {PULSE[15:0], 1'b1};
    wire weighs = fresh && phase >= 4'd9 && phase <= 4'd11;
    always @(posedge clk) begin
        phase <= tick ? 4'd1 : phase == 4'd0 || phase == 4'd12 ? 4'd0 : phase + 4'd1;
        if (tick) fresh <= take && !s_axis_tuser[0];
        point <= {40'd0, point[159:40]};
        if (clear) scale <= scales;
        else if (fresh && phase >= 4'd2 && phase <= 4'd4) scale <= {scale[31:0], scale[95:32]};
        if (fresh && phase >= 4'd1 && phase <= 4'd4)
            checksum <= {checksum[30:0], checksum[31]} ^ point[31:0] ^ {24'd0, point[39:32]};
        place <= rounded[67:32];
        if (fresh && phase >= 4'd6 && phase <= 4'd8) former <= {place, former[107:36]};
        distance <= first ? 37'sd0 : {place[35], place} - {former[35], former[35:0]};
        if (fresh && phase >= 4'd7 && phase <= 4'd9) next <= {distance[WIDTH-1:0], next[3*WIDTH-1:WIDTH]};
        size   <= distance[36] ? -distance : distance;
        size_q <= size;
        needed <= size * SPACING;
        if (phase == 4'd8) moved <= 1'b0;
        if (weighs && size_q != 37'd0) moved <= 1'b1;
        if (weighs && !begins && (needed > {24'd0, cycles, 10'd0} || size_q > {5'd0, most[31:0]})) too_fast <= 1'b1;
        if (weighs && begins && size_q > 37'd1024) elsewhere <= 1'b1;
        if (weighs) most <= {32'd0, most[95:32]};
        if (fresh && phase == 4'd11) first <= 1'b0;
        if (phase == 4'd12) begin
            advance <= halted ? {3*WIDTH{1'b0}} : next;
            next    <= {3*WIDTH{1'b0}};
            outputs <= !fresh ? 4'd0 : moved ? bits : bits & ~ONLY_MOVING;
        end
        if (take) begin
            begins <= !running;
            point  <= s_axis_tdata;
            bits   <= s_axis_tuser[4:1];
            most   <= largest;
            if (!s_axis_tuser[0]) points_taken <= points_taken + 32'd1;
            if (s_axis_tuser[0] && running && moved) cut <= 1'b1;
        end
        if (clear) begin
            fresh   <= 1'b0;
            next    <= {3*WIDTH{1'b0}};
            advance <= {3*WIDTH{1'b0}};
        end
        if (clear || halted || !enable) outputs <= 4'd0;
        if (rst || origin) begin
            first        <= 1'b1;
            too_fast     <= 1'b0;
            elsewhere    <= 1'b0;
            cut          <= 1'b0;
            points_taken <= 32'd0;
            checksum     <= 32'd0;
        end
        if (rst) phase <= 4'd0;
    end

    // ---- The pins.

    wire [2:0] axis_lost, axis_moving;
    wire signed [WIDTH-1:0] modulus = {1'b0, cycles, 10'd0};
    genvar i;
    generate for (i = 0; i < 3; i = i + 1) begin : axis
        step_dir #(.WIDTH(WIDTH), .PULSE(PULSE), .SETUP(SETUP)) step_dir_inst (
            .clk(clk), .rst(rst), .clear(clear), .origin(origin), .modulus(modulus), .advance(advance[i*WIDTH+:WIDTH]),
            .step(step[i]), .dir(dir[i]), .position(positions[32*i+:32]), .lost(axis_lost[i]), .moving(axis_moving[i])
        );
    end endgenerate
    assign lost   = |axis_lost;
    assign moving = running || fresh || next != {3*WIDTH{1'b0}} || |axis_moving;

    wire unused = &{1'b0, rounded[69:68], rounded[31:0]};
endmodule

`default_nettype wire
