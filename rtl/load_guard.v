// SPDX-License-Identifier: MIT
/*
 * Watches the load bus: a curve that cannot be right raises bad, and ready tells that a run has all it needs.
 *
 * What it knows: knots come in the order of their indices, from 0 to 1, and do not decrease; coordinates come in the
 * order of their indices, each point's weight after them; either may begin anew at 0. Weights are from 1/1024 to 1;
 * numbers fit their words; the degree is 1 to 5, with more points than that and no more than fit; weights only where
 * cu divides; spaces and indices exist.
 *
 * A load is closed by a write to space 7, index 0: {number of writes[15:0], checksum[31:0]}, both of all writes since
 * clear or the last close. The checksum of a write is the one before, turned left by one bit, xor both halves of the
 * data, xor {space, index}; it begins with 0. A wrong one raises bad, and so does one where there is nothing to
 * close. The first write after a close begins another load, which has to bring everything, or it is never ready: the
 * shape, as many points and knots as it tells, both ends of u, the number of periods, a record of the feed, the
 * largest step, both limits of each axis. With EXACT, in one of the loads since clear: the shape of bank 0, the end of
 * the job, A T^2, J T^3, the distance before the first period, the reserve, the largest step and the limits. What is
 * not named here is the loader's: that all reciprocals and records are there, and with EXACT all pieces.
 *
 * Format    as on the load bus of stepper.v, with the data 64 bits wide in two's complement.
 * Rounding  none.
 * Latency   1 cycle.
 * Flags     bad: sticky until clear, which also forgets what was loaded.
 */
`default_nettype none

module load_guard #(
    // Width of a coordinate: odd, 17 to 35.
    parameter integer WORD       = 35,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL   = 1,
    // Dimension of the points: 2 or 3.
    parameter integer DIM        = 3,
    // 1: the spaces of streamer.v; of its numbers only the checksum is known.
    parameter integer EXACT      = 0
) (
    input  wire        clk,
    input  wire        rst,
    input  wire        clear,
    input  wire        load,
    input  wire [2:0]  space,
    input  wire [9:0]  index,
    input  wire [63:0] data,
    output reg         bad,
    output wire        ready,
    output wire        closes // a load, rightly
);
    generate if (WORD % 2 == 0 || WORD < 17 || WORD > 35) begin : check_word
        load_guard_WORD_must_be_odd_and_from_17_to_35 stop ();
    end
    if (MAX_POINTS < 2 || MAX_POINTS > 64) begin : check_points
        load_guard_MAX_POINTS_must_be_from_2_to_64 stop ();
    end
    if (DIM != 2 && DIM != 3) begin : check_dim
        load_guard_DIM_must_be_2_or_3 stop ();
    end endgenerate

    localparam [31:0] LAST_POINT = MAX_POINTS - 1;
    localparam [31:0] LAST_KNOT  = MAX_POINTS + 5;

    reg [WORD-2:0] knot_before;
    reg [6:0]      latest_knot;  // its index, or all ones
    reg [8:0]      latest_place; // the same of a coordinate or weight
    reg [8:0]      shape;      // last point, degree
    reg [11:0]     seen;   // of what a run needs, in the order of now
    reg            closed;
    reg [15:0]     count;
    reg [31:0]     checksum;

    wire begins    = closed; // another load
    wire zero      = data == 64'd0;
    wire word_fits = data[63:WORD-1] == {65-WORD{1'b0}};
    // At most 1: the bit of 1 alone, or none of it.
    wire unit_fits   = word_fits && !(data[WORD-2] && |data[WORD-3:0]);
    wire light       = data[WORD-2:WORD-12] == 11'd0; // a weight below 1/1024
    wire signed_fits = data[63:WORD-1] == {65-WORD{data[WORD-1]}};
    wire falls       = data[WORD-2:0] < knot_before;
    wire [2:0] degree = data[2:0];
    wire [6:0] last   = data[9:3];
    // The indices that come next, of the same point, or of the next.
    wire [6:0] next_knot  = latest_knot + 7'd1;
    wire [8:0] next_place = latest_place + (latest_place[1:0] == 2'd1 && DIM == 2 ? 9'd2 : 9'd1);
    wire wrong_close = closed || count == 16'd0 || data != {16'd0, count, checksum};
    reg  wrong;
    always @* if (EXACT != 0) wrong = space == 3'd4 || space == 3'd6
                                      || (space == 3'd7 && (index > 10'd1 || wrong_close));
    else case (space)
        3'd0: wrong = index == LAST_KNOT[9:0] + 10'd1 || !unit_fits
                      || (index != 10'd0 && (begins || falls || index != {3'd0, next_knot}));
        3'd1: wrong = index[9:7] > 3'd4 || index[6:0] >= LAST_KNOT[6:0] || |data[63:WORD+3];
        3'd2: wrong = index[9:2] > LAST_POINT[7:0] || (index != 10'd0 && (begins || index[8:0] != next_place))
                      || (index[1:0] == 2'd3 ? light || !unit_fits : !signed_fits);
        3'd3: wrong = index > 10'd2 || (index != 10'd0 ? !unit_fits
                    : |data[63:11] || (RATIONAL == 0 && data[10]) || degree == 3'd0 || degree > 3'd5
                      || last > LAST_POINT[6:0] || last < {4'd0, degree});
        3'd4: wrong = index[1:0] == 2'd0 ? |data[63:32] : data[63:WORD+26] != {38-WORD{data[63]}};
        3'd5: wrong = index > 10'd13 || (index == 10'd0 ? zero || |data[63:32] 
                    : index[3] ? !signed_fits : index == 10'd4 ? zero || |data[63:WORD]
                    : zero || !word_fits || index == 10'd1 || index > 10'd4);
        3'd7: wrong = index != 10'd0 || wrong_close;
        default: wrong = 1'b1;
    endcase

    // Which of the numbers that a run needs this write brings.
    wire        of_run = space == 3'd5;
    wire [11:0] now    = {of_run && index == 10'd13, of_run && index == 10'd12, of_run && index == 10'd11,
                          of_run && index == 10'd10, of_run && index == 10'd9, of_run && index == 10'd8,
                          of_run && index == 10'd4, space == 3'd3 && index == 10'd0, space == 3'd3 && index == 10'd1,
                          space == 3'd3 && index == 10'd2,
                          EXACT != 0 ? of_run && index == 10'd5 : of_run && index == 10'd0,
                          EXACT != 0 ? of_run && index == 10'd6 : space == 3'd4 && index == 10'd0};
    wire [2:0]  and_now = {of_run && index == 10'd7, of_run && index == 10'd14, space == 3'd3 && index == 10'd3};
    reg  [2:0]  and_seen;  // with EXACT: more of them
    localparam [11:0] NEEDS = DIM == 3 ? 12'hFFF : 12'h3FF;
    wire        counts  = EXACT != 0 ? and_seen[2:1] == 2'b11 && (and_seen[0] || DIM == 2)
                          : latest_place == {1'b0, shape[8:3], 2'd3}
                            && latest_knot == {1'b0, shape[8:3]} - {4'hF, ~shape[2:0]}; // the sum, and 1
    assign ready = (seen & NEEDS) == NEEDS && counts && closed && !bad;
    assign      closes = load && space == 3'd7 && !wrong && !bad;
    wire [31:0] former = begins ? 32'd0 : checksum;

    always @(posedge clk) begin
        if (load) begin
            if (wrong) bad <= 1'b1;
            if (begins) {latest_knot, latest_place} <= 16'hFFFF;
            if (space == 3'd0) {latest_knot, knot_before} <= {index[6:0], data[WORD-2:0]};
            if (space == 3'd2) latest_place <= index[8:0];
            if (space == 3'd3 && index == 10'd0) shape <= data[8:0];
            closed   <= space == 3'd7;
            seen     <= begins && EXACT == 0 ? now : seen | now;
            and_seen <= and_seen | and_now;
            count    <= begins ? 16'd1 : count + 16'd1;
            checksum <= {former[30:0], former[31]} ^ data[31:0] ^ data[63:32] ^ {19'd0, space, index};
        end
        if (rst || clear) begin
            knot_before <= {WORD-1{1'b0}};
            {latest_knot, latest_place} <= 16'hFFFF;
            bad      <= 1'b0;
            closed   <= 1'b0;
            seen     <= 12'd0;
            and_seen <= 3'd0;
            count    <= 16'd0;
            checksum <= 32'd0;
        end
    end
endmodule

`default_nettype wire
