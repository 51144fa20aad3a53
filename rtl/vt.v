/*
 * The paper's module vt: the speed at t, t + T/2 and t + T: ramp up, cruise, ramp down.
 *
 * The speed is the smallest of three lines: one rises from the start, one is level, one falls to the end speed and
 * stays there. Each is sampled every half period, so where they cross need not fall on a sample.
 *
 * Format    now, half, whole: the distance v T / 24, WORD - 1 bits without sign, 8 more fraction bits than a
 *           coordinate. Inside, and on the load bus, 16 more fraction bits.
 * Rounding  to nearest, halves up; the lines themselves add exactly.
 * Latency   4 cycles after start, 3 after advance, until busy is low and the speeds hold: sooner than any C(u).
 * Flags     none: the lines stop at the cruise and end speeds, and load_guard admits none that rounds beyond its word.
 *
 * start and advance are sampled while busy is low. Load bus, while idle:
 *   0 rising line at 0   1 its rise a half period   2 cruise   3 first half period of the falling line
 *   4 falling line there 5 its fall a half period   6 end speed
 */
`default_nettype none

module vt #(
    // Width of a word: odd, 9 to 35.
    parameter WORD = 35
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             load,
    input  wire [2:0]       load_index,
    input  wire [WORD+14:0] load_data,
    input  wire             start,
    input  wire             advance,
    output wire             busy,
    output reg  [WORD-2:0]  now,
    output reg  [WORD-2:0]  half,
    output reg  [WORD-2:0]  whole
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        vt_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    localparam GUARD = 16;
    localparam LINE  = WORD - 1 + GUARD;
    localparam [LINE-1:0] ROUND = 1 << (GUARD - 1);

    reg [LINE-1:0] rise_from, rise_by, cruise, fall_from, fall_by, end_speed;
    reg [31:0]     fall_at;

    always @(posedge clk) if (load) case (load_index)
        3'd0: rise_from <= load_data;
        3'd1: rise_by   <= load_data;
        3'd2: cruise    <= load_data;
        3'd3: fall_at   <= load_data[31:0];
        3'd4: fall_from <= load_data;
        3'd5: fall_by   <= load_data;
        3'd6: end_speed <= load_data;
        default: ;
    endcase

    reg [LINE-1:0] rising, falling;
    reg [31:0]     until_fall;  // half periods until the falling line begins
    reg [1:0]      samples;     // still to take
    wire           fallen = until_fall == 32'd0;
    wire [LINE:0]  higher = {1'b0, rising} + {1'b0, rise_by};
    wire [LINE:0]  lower  = {1'b0, falling} - {1'b0, fall_by};
    wire [LINE-1:0] speed = fallen && falling < rising ? falling : rising;
    wire [LINE-1:0] rounded = speed + ROUND;

    assign busy = samples != 2'd0;

    always @(posedge clk) begin
        if (busy) begin
            samples <= samples - 2'd1;
            now     <= half;
            half    <= whole;
            whole   <= rounded[LINE-1:GUARD];
            rising  <= higher > {1'b0, cruise} ? cruise : higher[LINE-1:0];
            if (fallen) falling <= lower[LINE] || lower[LINE-1:0] < end_speed ? end_speed : lower[LINE-1:0];
            else until_fall <= until_fall - 32'd1;
        end else if (start) begin
            samples    <= 2'd3;
            rising     <= rise_from;
            falling    <= fall_from;
            until_fall <= fall_at;
        end else if (advance) begin
            samples <= 2'd2;
        end
        if (rst) samples <= 2'd0;
    end

    wire unused = &{1'b0, rounded[GUARD-1:0]};
endmodule

`default_nettype wire
