// SPDX-License-Identifier: MIT
/*
 * Feed override, hold and stop: path time runs at a rate from 0 to 1. The rate follows the command in the least time
 * that the limits of acceleration and jerk allow; the tool stays on the path, and goes on where it stopped.
 *
 * The limits hold along the path; README.md says how to plan so that the vector and the axes keep theirs. The rule is
 * that of nurbs_lab/hardware/feed_override.py. A period of the machine is long, so one adder computes all of it, a bit
 * of a product or of a quotient a cycle, as feed_override_program.v says. Within a period of the feed the speed
 * changes evenly, by half of the difference of the two neighbours' distances, so the path time may stand anywhere in
 * it. At rate 1 since the start, the distances are the feed's own.
 *
 * Format    rate: 0 to 256 for 0 to 1, what is above counts as 1. Inside, rates and path time have 32 fraction bits.
 *           distances: WORD + 27 bits, 28 more fraction bits than a step; a quarter more than the largest fits too.
 * Rounding  products and quotients downwards; the parts of a period of the feed add up to its whole, so nothing is
 *           lost.
 * Latency   10 cycles at rate 1 since the start, 1 at rest, else at most 1215: a period of 25 microseconds at 50 MHz.
 * Flags     resting: the rate is 0.
 *
 * rate is sampled once a period, not before may is high, with sampled high for that cycle; stopping is sampled with
 * it, holds the tool, and cuts the path where it rests: the distance is 0 then, and cut is high. On both sides a
 * distance is there while valid is high, until taken; a distance leaves when the next two are known, or the last.
 * Load bus, before start: at 5 the largest change of a distance from one period to the next, at 7 that of this
 * change, at 14 the distance before the first, which is negative if the feed starts at rest: the rate is then that of
 * the first command.
 */
`default_nettype none

module feed_override #(
    // Width of a step: odd, 9 to 35.
    parameter integer WORD = 35
) (
    input  wire               clk,
    input  wire               rst,
    input  wire               load,
    input  wire [3:0]         load_index,
    input  wire [63:0]        load_data,
    input  wire               start,
    input  wire               may,
    input  wire [8:0]         rate,
    input  wire               stopping,
    output wire               sampled,
    output reg                resting,
    input  wire               in_valid,
    input  wire [WORD+26:0]   in_distance,
    input  wire               in_last,
    output wire               in_take,
    output reg                valid,
    output reg  [WORD+26:0]   distance,
    output reg                is_last,
    output reg                cut,
    input  wire               take
);
    generate if (WORD % 2 == 0 || WORD < 9 || WORD > 35) begin : check_word
        feed_override_WORD_must_be_odd_and_from_9_to_35 stop ();
    end endgenerate

    localparam ONE = WORD + 27; // place of the bit of 1 in a rate or a time
    localparam A   = WORD + 32; // width of the accumulator

    // As in feed_override_program.v.
    localparam [3:0] ALU = 4'h0, STORE = 4'h1, SHIFT = 4'h2, FACTOR = 4'h3, FRACTION = 4'h4, MULTIPLY = 4'h5,
                     DIVIDE = 4'h6, WRAP = 4'h7, JUMP = 4'h8, CALL = 4'h9, RETURN = 4'hA, MARK = 4'hB, FINISH = 4'hC;
    localparam [7:0] INIT = 8'd0, AS_PLANNED = 8'd10, SLOW = 8'd15;
    localparam [4:0] ALPHA = 5'd8, BETA = 5'd9, PRIOR = 5'd10;

    // ---- The next periods of the feed, and where the run is.

    reg  [2:0] number;         // of the period, in a ring of 8
    reg  [2:0] count;          // known from this one on
    reg        ending, sealed; // the last is known; and a distance of 0 after it
    reg        whole, first;   // rate 1 since the start; no period has begun but this one
    reg        idled;          // at rest the period before
    reg        known;          // the period before left W, as the rate has not arrived
    wire       ready = count > 3'd2 || (sealed && count != 3'd1);

    // ---- The program: a cycle reads the number, the next one works, while the next instruction is read.

    reg         running, works;
    reg  [7:0]  pc, link;
    wire [15:0] instruction;
    wire [3:0]  order = instruction[15:12];
    wire [3:0]  how   = instruction[11:8];
    reg  [5:0]  round;
    wire        loops = (order == MULTIPLY && round != 6'd32) || (order == DIVIDE && round != 6'd31);

    reg  signed [A-1:0] acc, number_q;
    reg         [32:0]  factor;
    reg  [8:0]          goal;
    reg                 zero, sign, passes;
    reg  [2:0]          at;    // HERE is this far from number
    wire                negative = acc[A-1];

    reg met;
    always @* case (how)
        4'd0:    met = 1'b1;
        4'd1:    met = negative;
        4'd2:    met = !negative;
        4'd3:    met = zero;
        4'd4:    met = !whole && !idled;
        4'd5:    met = whole && !first;
        4'd6:    met = idled;
        4'd7:    met = !passes;
        4'd8:    met = sealed && count == 3'd1;
        default: met = known;
    endcase

    wire       free     = !valid || take;
    wire [8:0] wanted   = rate[8] ? 9'h100 : {1'b0, rate[7:0]};
    wire       rests    = resting && (wanted == 9'd0 || stopping);
    wire       begins   = !running && free && !start && may && (ready || rests);
    assign     sampled  = begins;
    wire       jumps    = (order == JUMP && met) || order == CALL;
    wire [7:0] next_pc  = start ? INIT : !running ? (whole && wanted[8] && !stopping ? AS_PLANNED : SLOW)
                        : jumps ? instruction[7:0] : order == RETURN && met ? link : pc + 8'd1;
    wire       goes_on  = running && works && !loops;
    wire       fetches  = start || (begins && !rests) || goes_on;
    feed_override_program feed_override_program_inst (.clk(clk), .read(fetches), .at(next_pc), .code(instruction));

    // ---- One adder.

    wire               subtracts = order == DIVIDE || (order == ALU && how[1] ^ (how[0] && sign));
    wire               uses      = order == DIVIDE || order == ALU || (order == MULTIPLY && factor[0]);
    wire signed [A-1:0] left     = order == FRACTION ? {{A-1-ONE{1'b0}}, factor, {WORD-5{1'b0}}}
                                 : order == DIVIDE || (order == SHIFT && !how[0]) ? {acc[A-2:0], 1'b0}
                                 : order == ALU && how[2] ? {A{1'b0}} : acc;
    wire signed [A-1:0] right    = uses ? number_q ^ {A{subtracts}} : {A{1'b0}};
    wire signed [A-1:0] sum      = left + right + {{A-1{1'b0}}, subtracts};
    wire                halves   = (order == MULTIPLY && round != 6'd32) || (order == SHIFT && how[0]);

    // ---- Memory: 0 to 7 the feed's periods, then the program's numbers.

    reg  [A-1:0] memory [0:31];
    wire [2:0]   place = number + at + instruction[2:0];
    wire [4:0]   named = instruction[4:3] == 2'd0 ? {2'd0, place} : instruction[4:0];
    wire         stores = running && works && order == STORE;
    wire         seals  = ending && !sealed && !stores && !start;
    assign       in_take = in_valid && !ending && count < 3'd4 && !stores && !start;
    wire [4:0]   written = load ? (load_index == 4'd5 ? ALPHA : load_index == 4'd7 ? BETA : PRIOR)
                         : stores ? named : {2'd0, number + count};
    wire [98:0]  wide    = {{35{load_data[63]}}, load_data};
    wire [A-1:0] data    = load ? wide[A-1:0] : stores ? acc
                         : seals ? {A{1'b0}} : {{5{in_distance[WORD+26]}}, in_distance};
    wire         loads   = load && (load_index == 4'd5 || load_index == 4'd7 || load_index == 4'd14);
    always @(posedge clk) begin
        if (loads || stores || seals || in_take) memory[written] <= data;
        if (!works) number_q <= memory[named];
    end

    always @(posedge clk) begin
        zero <= acc == {A{1'b0}};
        if (fetches) pc <= next_pc;
        if (take) valid <= 1'b0;
        count <= count + {2'd0, in_take || seals} - {2'd0, running && works && order == MARK && how == 4'd4};
        if (in_take && in_last) ending <= 1'b1;
        if (seals) sealed <= 1'b1;
        if (begins) begin
            goal <= stopping ? 9'd0 : wanted;
            cut  <= stopping && rests;
            if (rests) begin
                distance <= {WORD+27{1'b0}};
                is_last  <= 1'b0;
                valid    <= 1'b1;
                idled    <= 1'b1;
            end else begin
                running <= 1'b1;
                works   <= 1'b0;
            end
        end
        if (running && !works) begin
            works <= 1'b1;
            round <= 6'd0;
            if (order == MULTIPLY) acc <= {A{1'b0}};
            if (order == DIVIDE) factor <= 33'd0;
        end
        if (running && works) begin
            round <= round + 6'd1;
            if (!loops) works <= 1'b0;
            case (order)
                ALU, SHIFT, FRACTION: acc <= halves ? sum >>> 1 : sum;
                FACTOR: factor <= how[0] ? {goal, 24'd0} : acc[ONE-:33];
                MULTIPLY: begin
                    acc    <= halves ? sum >>> 1 : sum;
                    factor <= {factor[0], factor[32:1]};
                end
                DIVIDE: begin
                    acc    <= sum[A-1] ? left : sum;
                    factor <= {factor[31:0], !sum[A-1]};
                end
                WRAP: begin
                    passes   <= acc[ONE];
                    acc[ONE] <= 1'b0;
                end
                CALL: link <= pc + 8'd1;
                MARK: case (how)
                    4'd0: begin
                        sign  <= negative;
                        known <= 1'b0;
                    end
                    4'd6: known <= 1'b1;
                    4'd4: begin
                        number <= number + 3'd1;
                        first  <= 1'b0;
                    end
                    4'd5: begin
                        resting <= zero;
                        known   <= known && !zero;
                        whole   <= 1'b0;
                        idled   <= 1'b0;
                    end
                    default: at <= how == 4'd2 ? 3'd7 : {2'd0, how == 4'd3 && passes};
                endcase
                FINISH: begin
                    running  <= 1'b0;
                    valid    <= !how[1];
                    distance <= acc[WORD+26:0];
                    is_last  <= how[0];
                end
                default: ;
            endcase
        end
        if (start) begin
            running <= 1'b1;
            works   <= 1'b0;
            number  <= 3'd0;
            count   <= 3'd0;
            at      <= 3'd0;
            goal    <= 9'h100;
            {ending, sealed, idled, known, resting, cut} <= 6'd0;
            {whole, first} <= 2'b11;
        end
        if (rst || start) valid <= 1'b0;
        if (rst) begin
            running <= 1'b0;
            count   <= 3'd0;
            sealed  <= 1'b0;
            resting <= 1'b0;
        end
    end

    wire unused = &{1'b0, wide};
endmodule

`default_nettype wire
