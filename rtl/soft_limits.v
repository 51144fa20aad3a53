// SPDX-License-Identifier: MIT
/*
 * The last check before a point leaves: inside the limits of every axis, and no further from the point before than the
 * largest step.
 *
 * Format    points, lowest, highest: DIM words of WORD bits in two's complement. step: WORD bits without sign, the
 *           binary point of a coordinate; it limits each axis by itself.
 * Rounding  none.
 * Latency   2 cycles: the flags say what held for the points two cycles before.
 * Flags     too_far: an axis moves by more than the largest step; beyond: an axis lies outside its limits.
 *
 * bound names an axis and a side (0: lowest), bound_beyond tells in the same cycle whether load_data lies beyond that
 * limit; of axis 3, whether it is more than the largest step.
 * Load bus, while no point is checked: index 4 is the largest step, index 8 + 2 * axis the lowest and 9 + 2 * axis the
 * highest coordinate of an axis.
 */
`default_nettype none

module soft_limits #(
    // Width of a coordinate: odd, 5 to 63.
    parameter integer WORD = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM  = 3
) (
    input  wire                clk,
    input  wire                load,
    input  wire [3:0]          load_index,
    input  wire [WORD-1:0]     load_data,
    input  wire [2:0]          bound,
    output wire                bound_beyond,
    input  wire [DIM*WORD-1:0] point,
    input  wire [DIM*WORD-1:0] point_before,
    output reg                 too_far,
    output reg                 beyond
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check_word
        soft_limits_WORD_must_be_odd_and_from_5_to_63 stop ();
    end
    if (DIM < 2 || DIM > 3) begin : check_dim
        soft_limits_DIM_must_be_2_or_3 stop ();
    end endgenerate

    reg  [WORD-1:0] largest_step;
    wire [DIM-1:0]  far, outside, over;
    assign bound_beyond = |over || (bound[2:1] == 2'd3 && load_data > largest_step);
    always @(posedge clk) begin
        if (load && load_index == 4'd4) largest_step <= load_data;
        too_far <= |far;
        beyond  <= |outside;
    end

    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : axis
        localparam [2:0] AXIS = i;
        reg signed [WORD-1:0] lowest, highest;
        always @(posedge clk) if (load && load_index[3:1] == 3'd4 + AXIS) begin
            if (load_index[0]) highest <= load_data;
            else lowest <= load_data;
        end
        wire signed [WORD-1:0] given = load_data;
        assign over[i] = bound[2:1] == AXIS[1:0] && (bound[0] ? given > highest : given < lowest);
        wire signed [WORD-1:0] here   = point[i*WORD+:WORD];
        wire signed [WORD-1:0] former = point_before[i*WORD+:WORD];
        reg signed  [WORD:0]   move;
        reg                    below, above;
        always @(posedge clk) begin
            move  <= {here[WORD-1], here} - {former[WORD-1], former};
            below <= here < lowest;
            above <= here > highest;
        end
        // A negative move is as long as its complement and 1.
        wire        [WORD:0]   length = move ^ {WORD+1{move[WORD]}};
        wire        [WORD+1:0] room   = {2'd0, largest_step} - {1'b0, length} - {{WORD+1{1'b0}}, move[WORD]};
        assign far[i]     = room[WORD+1];
        assign outside[i] = below || above;
    end endgenerate
endmodule

`default_nettype wire
