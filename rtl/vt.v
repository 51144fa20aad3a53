// SPDX-License-Identifier: MIT
/*
 * The paper's module vt: the speed at t, t + T/2 and t + T, from a table of segments.
 *
 * A record {samples, d, e, f} of the table gives the speeds d, d + e, d + 2 e + f, ... at its half periods, as
 * feed_table.v says: what a constant jerk commands. So ramps, S-curves and plans limited by curvature are all tables.
 * The last record has 0 for its number of samples and goes on for ever.
 *
 * Format    now, half, whole: the distance v T / 24, WORD - 1 bits without sign, 8 more fraction bits than a
 *           coordinate. In the table 28 more fraction bits, two's complement; a speed is below half of its range.
 * Rounding  to nearest, halves up; the sums are exact.
 * Latency   now 1 cycle after advance, or 7 after start; half and whole at most 7 each after the one before. busy is
 *           low when all three are there: at most 21 cycles.
 * Flags     overflow: a speed since start was negative or too large.
 *
 * start and advance are sampled while busy is low, and none is needed before busy is low again. Nobody waits for
 * busy: in a step K takes longer than half, and its other slopes longer than whole. Load bus, while idle:
 * {record[7:0], word[1:0]}.
 */
`default_nettype none

module vt #(
    // Width of a word: odd, 9 to 35.
    parameter integer WORD = 35
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             load,
    input  wire [9:0]       load_index,
    input  wire [WORD+26:0] load_data,
    input  wire             start,
    input  wire             advance,
    output wire             busy,
    output reg  [WORD-2:0]  now,
    output reg  [WORD-2:0]  half,
    output reg  [WORD-2:0]  whole,
    output reg              overflow
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        vt_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    localparam GUARD = 28;
    localparam [1:0] NOW = 2'd0, HALF = 2'd1, NONE = 2'd3; // 2: whole

    reg  [1:0]       awaited; // the speed that the table gives next
    wire             valid, is_last, bank;
    wire [WORD+26:0] speed;
    wire [WORD+26:0] rounded = speed + {{WORD-1{1'b0}}, 1'b1, {GUARD-1{1'b0}}};
    assign busy = awaited != NONE;

    feed_table #(.WORD(WORD)) feed_table_inst (
        .clk(clk), .rst(rst), .load(load), .load_index(load_index), .load_data(load_data), .last_record({14{1'b1}}),
        .closed(2'b11), .final_bank(2'b10), .start(start && !busy), .take(busy), .valid(valid), .distance(speed),
        .is_last(is_last), .bank(bank)
    );

    always @(posedge clk) begin
        if (busy) begin
            if (valid) begin
                awaited  <= awaited + 2'd1;
                overflow <= overflow || rounded[WORD+26];
                case (awaited)
                    NOW:     now   <= rounded[GUARD+:WORD-1];
                    HALF:    half  <= rounded[GUARD+:WORD-1];
                    default: whole <= rounded[GUARD+:WORD-1];
                endcase
            end
        end else if (start) begin
            awaited  <= NOW;
            overflow <= 1'b0;
        end else if (advance) begin
            awaited <= HALF;
            now     <= whole;
        end
        if (rst) awaited <= NONE;
    end

    wire unused = &{1'b0, rounded[GUARD-1:0], is_last, bank};
endmodule

`default_nettype wire
