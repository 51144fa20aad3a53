/*
 * From points to the pins of three axes: one point a period is taken from the stream, scaled to steps, and its distance
 * from the point before is spread over the next period.
 *
 * Format    points: 40 bits a field as nurbs_interpolator.v sends them, u first, at most 35 bits of a coordinate in use.
 *           scales: 32 bits an axis without sign; a coordinate times its scale over 2^32 is a place in 1/1024 of a step.
 *           period: cycles, even or odd, 16 to 2^20 - 1. positions: 32 bits an axis, steps from the origin.
 * Rounding  a place to nearest, halves up, so no error adds up from point to point; positions to the nearest step, halves up.
 * Latency   a point is reached two periods after it was taken.
 * Flags     too_fast: an axis would need more steps than one in 2 * PULSE + 1 cycles; late: within a run no point was there when
 *           the period began; lost: more than 7 steps were due. After a flag nothing moves: no point is taken,
 *           and the distance of the next period is 0. Flags stay until origin.
 *
 * origin says that the tool stands at the next point: nothing moves for it, positions count from it. While enable is low,
 * nothing moves and the origin is forgotten. A void beat (tuser) moves nothing. points_taken and checksum tell of all
 * points since the origin: for u and each coordinate, in this order, the checksum is rotated left by 1, then
 * exclusive-or with the lower 32 bits and with the upper 8 of the field.
 */
`default_nettype none

module axes #(
    // Cycles that step stays high, and least cycles that it stays low: 1 to 65535.
    parameter PULSE = 50,
    // Cycles from a change of dir to the next step: 1 to 65535.
    parameter SETUP = 50
) (
    input  wire         clk,
    input  wire         rst,
    input  wire         enable,
    input  wire         origin,
    input  wire [19:0]  period,
    input  wire [95:0]  scales,

    input  wire [159:0] s_axis_tdata,
    input  wire         s_axis_tvalid,
    output wire         s_axis_tready,
    input  wire         s_axis_tlast,
    input  wire         s_axis_tuser,

    output wire [2:0]   step,
    output wire [2:0]   dir,
    output wire [95:0]  positions,
    output reg  [31:0]  points_taken,
    output reg  [31:0]  checksum,
    output reg          placed,
    output wire         moving,
    output reg          too_fast,
    output reg          late,
    output wire         lost
);
    localparam WIDTH = 20 + 10 + 1; // a period's cycles, fractions of a step, a sign

    // ---- The tick.

    reg  [19:0] left; // cycles of this period
    reg         running;
    wire        tick   = left == 20'd0;
    wire        halted = too_fast || late || lost;
    wire        clear  = rst || origin || !enable;
    wire        take   = s_axis_tready && s_axis_tvalid;
    assign s_axis_tready = tick && enable && !halted;

    always @(posedge clk) begin
        left <= tick ? period - 20'd1 : left - 20'd1;
        if (take) running <= !s_axis_tlast;
        if (tick && running && !s_axis_tvalid) late <= 1'b1;
        if (clear || halted) running <= 1'b0;
        if (rst || origin) late <= 1'b0;
        if (rst) left <= 20'd0;
    end

    // ---- From a point to distances, axis by axis. Phase 1: u is the lowest field; 2 to 4: a coordinate enters the
    // multiplier; 5 to 7: its product is there; 6 to 8: its place; 7 to 9: its distance.

    reg         [3:0]         phase;
    reg         [159:0]       point;
    reg         [95:0]        scale;
    wire signed [69:0]        product;
    wire signed [69:0]        rounded = product + 70'sh0_8000_0000;
    reg         [35:0]        place;
    reg         [107:0]       former;
    reg signed  [36:0]        distance;
    reg         [36:0]        size;
    reg         [52:0]        needed; // cycles, in 1/1024
    reg         [3*WIDTH-1:0] next, advance;
    multiply #(.WORD(35)) multiply_inst (.clk(clk), .a(point[34:0]), .b({3'd0, scale[31:0]}), .product(product));

    localparam [15:0] SPACING = {PULSE[14:0], 1'b1};
    always @(posedge clk) begin
        if (phase != 4'd0) phase <= phase == 4'd11 ? 4'd0 : phase + 4'd1;
        point <= {40'd0, point[159:40]};
        if (phase >= 4'd2) scale <= {32'd0, scale[95:32]};
        if (phase >= 4'd1 && phase <= 4'd4)
            checksum <= {checksum[30:0], checksum[31]} ^ point[31:0] ^ {24'd0, point[39:32]};
        place <= rounded[67:32];
        if (phase >= 4'd6 && phase <= 4'd8) former <= {place, former[107:36]};
        distance <= placed ? {place[35], place} - {former[35], former[35:0]} : 37'sd0;
        if (phase >= 4'd7 && phase <= 4'd9) next <= {distance[WIDTH-1:0], next[3*WIDTH-1:WIDTH]};
        size   <= distance[36] ? -distance : distance;
        needed <= size * SPACING;
        if (phase >= 4'd9 && needed > {23'd0, period, 10'd0}) too_fast <= 1'b1;
        if (phase == 4'd9) placed <= 1'b1;
        if (tick) begin
            advance <= halted ? {3*WIDTH{1'b0}} : next;
            next    <= {3*WIDTH{1'b0}};
        end
        if (take && !s_axis_tuser) begin
            phase        <= 4'd1;
            point        <= s_axis_tdata;
            scale        <= scales;
            points_taken <= points_taken + 32'd1;
        end
        if (clear) begin
            phase   <= 4'd0;
            placed  <= 1'b0;
            next    <= {3*WIDTH{1'b0}};
            advance <= {3*WIDTH{1'b0}};
        end
        if (rst || origin) begin
            too_fast     <= 1'b0;
            points_taken <= 32'd0;
            checksum     <= 32'd0;
        end
    end

    // ---- The pins.

    wire [2:0] axis_lost, axis_moving;
    wire signed [WIDTH-1:0] modulus = {1'b0, period, 10'd0};
    genvar i;
    generate for (i = 0; i < 3; i = i + 1) begin : axis
        step_dir #(.WIDTH(WIDTH), .PULSE(PULSE), .SETUP(SETUP)) step_dir_inst (
            .clk(clk), .clear(clear), .modulus(modulus), .advance(advance[i*WIDTH+:WIDTH]), .step(step[i]),
            .dir(dir[i]), .position(positions[32*i+:32]), .lost(axis_lost[i]), .moving(axis_moving[i])
        );
    end endgenerate
    assign lost   = |axis_lost;
    assign moving = running || phase != 4'd0 || next != {3*WIDTH{1'b0}} || |axis_moving;

    wire unused = &{1'b0, rounded[69:68], rounded[31:0]};
endmodule

`default_nettype wire
