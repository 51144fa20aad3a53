/*
 * The feed as a table: the distance of each period, one after another.
 *
 * A record {periods, d, e, f} gives the distances d, d + e, d + 2 e + f, d + 3 e + 3 f, ... of its periods: what a
 * constant jerk commands, exactly. A period in which the jerk changes is a record of its own. So trapezoids, S-curves and
 * plans limited by curvature are all tables, and no polynomial is multiplied out.
 *
 * Format    distances: WORD + 27 bits in two's complement, 28 more fraction bits than a step. periods: 32 bits.
 * Rounding  none; the step is rounded by the caller.
 * Latency   6 cycles from start, or from the end of a record, to valid; else 1.
 * Flags     none.
 *
 * distance is there while valid is high, is_last with that of the last period; take goes to the next one. Load bus, while
 * idle: space 0, {record[5:0], word[1:0]}; space 1: last record.
 */
`default_nettype none

module steps #(
    // Width of a step: odd, 9 to 35.
    parameter WORD = 35
) (
    input  wire               clk,
    input  wire               rst,
    input  wire               load,
    input  wire               load_space,
    input  wire [7:0]         load_index,
    input  wire [WORD+26:0]   load_data,
    input  wire               start,
    input  wire               take,
    output wire               valid,
    output wire [WORD+26:0]   distance,
    output wire               is_last
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        steps_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    reg [WORD+26:0] table_of [0:255];
    reg [WORD+26:0] word;
    reg [5:0]       last_record, record;
    reg [2:0]       reading; // 0: none; else one more than the number of the word that is asked for
    reg [31:0]      periods;
    reg [WORD+26:0] d, e, f;
    reg             running;
    assign valid    = running && reading == 3'd0;
    assign distance = d;
    wire   ends     = periods == 32'd1;
    assign is_last  = ends && record == last_record;
    wire [1:0] asked = reading[1:0] - 2'd1;

    always @(posedge clk) begin
        if (load && !load_space) table_of[load_index] <= load_data;
        if (load && load_space) last_record <= load_data[5:0];
        word <= table_of[{record, asked}];
        if (reading != 3'd0) reading <= reading == 3'd5 ? 3'd0 : reading + 3'd1;
        case (reading) // the word asked for one cycle before
            3'd2: periods <= word[31:0];
            3'd3: d <= word;
            3'd4: e <= word;
            3'd5: f <= word;
            default: ;
        endcase
        if (start) begin
            running <= 1'b1;
            record  <= 6'd0;
            reading <= 3'd1;
        end else if (valid && take) begin
            periods <= periods - 32'd1;
            d       <= d + e;
            e       <= e + f;
            if (ends) begin
                running <= !is_last;
                record  <= record + 6'd1;
                reading <= is_last ? 3'd0 : 3'd1;
            end
        end
        if (rst) running <= 1'b0;
    end
endmodule

`default_nettype wire
