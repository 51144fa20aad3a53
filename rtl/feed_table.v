// SPDX-License-Identifier: MIT
/*
 * The feed as a table: the distance of each period, one after another.
 *
 * A record {periods, d, e, f} gives the distances d, d + e, d + 2 e + f, d + 3 e + 3 f, ... of its periods: what a
 * constant jerk commands, exactly. A record of 0 periods goes on for ever. So trapezoids, S-curves and plans limited
 * by curvature are all tables, and no polynomial is multiplied out.
 *
 * Format    distances: WORD + 27 bits in two's complement, 28 more fraction bits than a step. periods: 32 bits.
 * Rounding  none; the step is rounded by the caller.
 * Latency   6 cycles from start, or from the end of a record, to valid; else 1.
 * Flags     none.
 *
 * The table has two banks of 128 records, read in turn from bank 0 on: while one is read the other may be loaded.
 * closed tells which banks are loaded; at the end of one the next is awaited, unless the one that ends is marked
 * final. distance is there while valid is high, is_last with that of the last period; take goes to the next one. Load
 * bus: at {bank, record[6:0], word[1:0]}.
 */
`default_nettype none

module feed_table #(
    // Width of a step: odd, 9 to 35.
    parameter integer WORD = 35
) (
    input  wire               clk,
    input  wire               rst,
    input  wire               load,
    input  wire [9:0]         load_index,
    input  wire [WORD+26:0]   load_data,
    input  wire [13:0]        last_record, // of bank 1 and of bank 0
    input  wire [1:0]         closed,
    input  wire [1:0]         final_bank,
    input  wire               start,
    input  wire               take,
    output wire               valid,
    output wire [WORD+26:0]   distance,
    output wire               is_last,
    output wire               bank
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        feed_table_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    reg [WORD+26:0] table_of [0:1023];
    reg [WORD+26:0] word;
    reg [7:0]       record;
    reg [2:0]       reading; // 0: none; else one more than the number of the word that is asked for
    reg [31:0]      periods; // left in the record; 0: for ever
    reg [WORD+26:0] d, e, f;
    reg             running;
    assign valid    = running && reading == 3'd0;
    assign distance = d;
    wire   ends     = periods == 32'd1;
    assign bank     = record[7];
    wire   bank_ends = record[6:0] == (bank ? last_record[13:7] : last_record[6:0]);
    assign is_last  = ends && bank_ends && final_bank[bank];
    wire [1:0] asked = reading[1:0] - 2'd1;

    always @(posedge clk) begin
        if (load) table_of[load_index] <= load_data;
        word <= table_of[{record, asked}];
        if (reading != 3'd0 && closed[bank]) reading <= reading == 3'd5 ? 3'd0 : reading + 3'd1;
        case (reading) // the word asked for one cycle before
            3'd2: periods <= word[31:0];
            3'd3: d <= word;
            3'd4: e <= word;
            3'd5: f <= word;
            default: ;
        endcase
        if (start) begin
            running <= 1'b1;
            record  <= 8'd0;
            reading <= 3'd1;
        end else if (valid && take) begin
            if (periods != 32'd0) periods <= periods - 32'd1;
            d       <= d + e;
            e       <= e + f;
            if (ends) begin
                running <= !is_last;
                record  <= bank_ends ? {!bank, 7'd0} : record + 8'd1;
                reading <= is_last ? 3'd0 : 3'd1;
            end
        end
        if (rst) running <= 1'b0;
    end
endmodule

`default_nettype wire
