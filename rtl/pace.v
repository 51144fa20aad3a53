/*
 * Feed override and hold: path time runs at a rate from 0 to 1, and the rate slews. The tool stays on the path, and goes
 * on where it stopped.
 *
 * In each period of the machine the path time advances by the mean of the rate before and after. The distance is what
 * the feed commands in that stretch of path time, at even speed within each of the feed's periods; at rate 1 it is the
 * feed's own, to the last bit. At rate 0 it is 0: the tool rests.
 *
 * Format    rate: 0 to 256 for 0 to 1, what is above counts as 1. slew: the largest change of the rate in a period,
 *           16 fraction bits. distances as in steps.v, never negative.
 * Rounding  the part of a period downwards; the parts of one period add up to its whole, so nothing is lost.
 * Latency   1 cycle at rate 1, at most 12 otherwise; the next distance is made while the one before is in use.
 * Flags     resting: the rate is 0.
 *
 * rate is sampled once a period, with sampled high for that cycle. Both sides are valid/take handshakes as in steps.v.
 */
`default_nettype none

module pace #(
    // Width of a step: odd, 9 to 35.
    parameter WORD = 35
) (
    input  wire             clk,
    input  wire             rst,
    input  wire             load,
    input  wire [15:0]      load_data,
    input  wire [8:0]       rate,
    output wire             sampled,
    output wire             resting,
    input  wire             in_valid,
    input  wire [WORD+26:0] in_distance,
    input  wire             in_last,
    output wire             in_take,
    output reg              valid,
    output reg  [WORD+26:0] distance,
    output reg              is_last,
    input  wire             take
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        pace_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    localparam W = WORD + 27;
    reg  [15:0]  slew;
    reg  [16:0]  now;                 // rate with 16 fraction bits
    wire [16:0]  wanted = rate[8] ? 17'h10000 : {1'b0, rate[7:0], 8'd0};
    wire [17:0]  gap    = wanted >= now ? {1'b0, wanted} - {1'b0, now} : {1'b0, now} - {1'b0, wanted};
    wire         near   = gap <= {2'd0, slew};
    wire [16:0]  next   = near ? wanted : wanted > now ? now + {1'b0, slew} : now - {1'b0, slew};
    wire [17:0]  both   = {1'b0, now} + {1'b0, next};
    reg  [15:0]  done_of;             // what is done of the feed's period
    wire [17:0]  reached = {2'd0, done_of} + {1'b0, both[17:1]};
    wire         passes  = |reached[17:16];

    localparam [1:0] IDLE = 2'd0, SHARE = 2'd1, FINISH = 2'd2;
    reg  [1:0]   state;
    reg  [2:0]   round;
    reg  [15:0]  factor;
    reg  [W+15:0] sum;                // distance * factor, two bits of the factor a cycle
    reg  [W-1:0] given;               // of the feed's period
    reg  [W-1:0] base;
    wire [W+1:0] triple = {1'b0, in_distance, 1'b0} + {2'b00, in_distance};
    wire [W+1:0] part   = factor[15:14] == 2'd3 ? triple : factor[15] ? {1'b0, in_distance, 1'b0}
                        : factor[14] ? {2'b00, in_distance} : {W+2{1'b0}};
    wire [W-1:0] share  = sum[W+15:16];

    assign sampled = state == IDLE && in_valid && (!valid || take);
    assign in_take = sampled && passes;
    assign resting = now == 17'd0;

    always @(posedge clk) begin
        if (load) slew <= load_data;
        if (take) valid <= 1'b0;
        case (state)
            IDLE: if (sampled) begin
                now     <= next;
                done_of <= reached[15:0];
                is_last <= passes && in_last;
                factor  <= reached[15:0];
                sum     <= {W+16{1'b0}};
                round   <= 3'd0;
                base    <= passes ? in_distance - given : -given;
                distance <= passes ? in_distance - given : {W{1'b0}};
                if ((passes && (in_last || reached[15:0] == 16'd0)) || both[17:1] == 17'd0) valid <= 1'b1;
                else state <= SHARE;
                if (passes) given <= {W{1'b0}};
            end
            SHARE: if (in_valid) begin
                sum    <= (sum << 2) + {14'd0, part};
                factor <= factor << 2;
                round  <= round + 3'd1;
                if (round == 3'd7) state <= FINISH;
            end
            FINISH: begin
                distance <= base + share;
                given    <= share;
                valid    <= 1'b1;
                state    <= IDLE;
            end
            default: state <= IDLE;
        endcase
        if (rst) begin
            state   <= IDLE;
            valid   <= 1'b0;
            now     <= 17'h10000;
            done_of <= 16'd0;
            given   <= {W{1'b0}};
        end
    end

    wire unused = &{1'b0, both[0]};
endmodule

`default_nettype wire
