// SPDX-License-Identifier: MIT
/*
 * What streamer.v is loaded with, in two banks: while one is in use the other may be loaded.
 *
 * Format    as on the load bus of streamer.v. metric_at and length_at name a piece {bank, piece[4:0]} and its word,
 *           coefficient_at a piece, an axis and a power of t.
 * Rounding  none.
 * Latency   a number asked for is there in the next cycle.
 * Flags     outside: high for a cycle when a bank was not closed, since a bound of its curve lies beyond a limit or
 *           is missing.
 *
 * closed tells which banks hold a load. A write to a bank opens it, close closes the bank of load_index[0], and a bank
 * that is left opens: when points come from another (point_bank) and the feed, too (feed_bank). writable: the number
 * at load_space and load_index may be loaded now: all but space 5 while busy, if its bank is not closed. A close needs
 * a bound for every axis and side and one of the step since the close before, loaded after the limits, each of them
 * within (bound_beyond). starved: while busy a bank is open, fewer periods than the reserve are there to run and the
 * final bank is not closed.
 */
`default_nettype none

module banks #(
    // Width of a word: odd, 5 to 63.
    parameter integer WORD = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM  = 3
) (
    input  wire                   clk,
    input  wire                   rst,
    input  wire                   load,
    input  wire [2:0]             load_space,
    input  wire [9:0]             load_index,
    input  wire [63:0]            load_data,
    input  wire                   close,
    input  wire                   bound_beyond,
    input  wire                   busy,
    input  wire                   begins,
    input  wire                   done,
    input  wire                   period_taken,
    input  wire                   point_bank,
    input  wire                   feed_bank,

    input  wire [8:0]             metric_at,
    output reg  signed [WORD-1:0] metric,
    input  wire [8:0]             root_at,
    output reg  [WORD-1:0]        root,
    input  wire [5:0]             length_at,
    output reg  [63:0]            length,
    input  wire [9:0]             coefficient_at,
    output reg  signed [WORD-1:0] coefficient,
    output reg  [1:0]             cubic,
    output reg  [9:0]             last_piece,  // of bank 1 and of bank 0
    output reg  [13:0]            last_record,
    output reg  [1:0]             final_bank,
    output reg  [DIM*WORD-1:0]    end_point,

    output wire                   writable,
    output wire [1:0]             closed,
    output reg                    outside,
    output wire                   starved
);
    generate if (WORD % 2 == 0 || WORD < 5 || WORD > 63) begin : check_word
        banks_WORD_must_be_odd_and_from_5_to_63 stop ();
    end
    if (DIM != 2 && DIM != 3) begin : check_dim
        banks_DIM_must_be_2_or_3 stop ();
    end endgenerate

    reg signed [WORD-1:0] metrics [0:511];
    reg        [WORD-1:0] roots [0:511];   // a copy for the second reader
    reg        [63:0]     lengths [0:63];
    reg signed [WORD-1:0] points [0:1023];
    always @(posedge clk) begin
        if (load && load_space == 3'd0) begin
            metrics[load_index[8:0]] <= load_data[WORD-1:0];
            roots[load_index[8:0]]   <= load_data[WORD-1:0];
        end
        if (load && load_space == 3'd0 && load_index[2:0] == 3'd6) lengths[load_index[8:3]] <= load_data;
        if (load && load_space == 3'd2) points[load_index] <= load_data[WORD-1:0];
        metric      <= metrics[metric_at];
        root        <= roots[root_at];
        length      <= lengths[length_at];
        coefficient <= points[coefficient_at];
    end

    // ---- The shape of each bank, and the end of the job.

    wire       shape   = load && load_space == 3'd3 && load_index[2:0] == 3'd0;
    wire       of_bank = load_space == 3'd0 ? load_index[8] : load_space == 3'd1 || load_space == 3'd2 ? load_index[9]
                       : load_space == 3'd3 ? load_index[3] : load_index[0];
    reg [31:0] periods_0, periods_1;
    reg [15:0] reserve;
    always @(posedge clk) begin
        if (shape && !load_index[3])
            {last_piece[4:0], last_record[6:0], cubic[0], final_bank[0], periods_0} <=
                {load_data[4:0], load_data[11:5], load_data[12], load_data[13], load_data[47:16]};
        if (shape && load_index[3])
            {last_piece[9:5], last_record[13:7], cubic[1], final_bank[1], periods_1} <=
                {load_data[4:0], load_data[11:5], load_data[12], load_data[13], load_data[47:16]};
        if (load && load_space == 3'd5 && load_index[3:0] == 4'd6) reserve <= load_data[15:0];
    end
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : end_of
        localparam [2:0] AT = i + 1;
        always @(posedge clk) if (load && load_space == 3'd3 && load_index[2:0] == AT)
            end_point[i*WORD+:WORD] <= load_data[WORD-1:0];
    end endgenerate

    // ---- The bounds of the load that is not yet closed.

    localparam [7:0] ALL = DIM == 3 ? 8'hBF : 8'h8F; // the bounds that are needed
    wire       bound  = load && load_space == 3'd3 && load_index[2:0] == 3'd4;
    wire       limit  = load && load_space == 3'd5 && (load_index[3] || load_index[3:0] == 4'd4);
    wire [7:0] which  = 8'd1 << load_index[6:4]; // {axis, whether it is the highest}; 7 is the step
    reg  [7:0] bounds;
    reg        leaves; // one of them lies beyond its limit
    wire       good   = (bounds & ALL) == ALL && !leaves;
    always @(posedge clk) begin
        outside <= close && !good;
        if (bound) bounds <= bounds | which;
        if (bound && bound_beyond) leaves <= 1'b1;
        if (rst || close || limit) begin
            bounds <= 8'd0;
            leaves <= 1'b0;
        end
        if (rst) outside <= 1'b0;
    end

    // ---- Which banks are in use, and how many periods there are.

    reg [31:0] committed;
    reg  [1:0] held;
    reg        oldest, streamed; // bank that is still in use; another was before it
    wire       forgets = done && streamed;
    assign closed   = forgets ? 2'b00 : held;
    wire       closes = close && good;
    assign writable = !busy || (load_space != 3'd5 && !closed[of_bank]);
    assign starved  = busy && committed < {16'd0, reserve} && (final_bank & closed) == 2'd0 && closed != 2'b11;
    always @(posedge clk) begin
        committed <= (begins ? periods_0 + (closed[1] ? periods_1 : 32'd0) : committed)
                   + (closes ? (load_index[0] ? periods_1 : periods_0) : 32'd0) - {31'd0, period_taken};
        if (load && load_space < 3'd4) held[of_bank] <= 1'b0;
        if (closes) held[load_index[0]] <= 1'b1;
        if (point_bank != oldest && feed_bank != oldest) begin
            held[oldest] <= 1'b0;
            oldest         <= !oldest;
            streamed       <= 1'b1;
        end
        if (begins) {oldest, streamed} <= 2'd0;
        if (rst || forgets) held <= 2'd0;
    end
endmodule

`default_nettype wire
