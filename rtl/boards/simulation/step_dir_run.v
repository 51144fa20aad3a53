/*
 * Bench of step_dir.v in Verilog, for its length: random distances, period after period, until STEPS steps have been on
 * the pins. The sum of all advances is kept beside it; after each period the position is compared with the sum, and in every
 * cycle the pins with their least times. Every 16th stretch of periods goes on at the largest speed, each in a random
 * direction.
 *
 * Format    finished: high at the end; wrong: checks that failed; pins: steps on the pins, forward less back; expected: the
 *           sum in steps; fewest: least cycles between two steps.
 * Rounding  none.
 * Latency   none.
 * Flags     wrong.
 */
`default_nettype none

module step_dir_run #(
    parameter PULSE  = 1,
    parameter SETUP  = 2,
    parameter PERIOD = 250,
    parameter STEPS  = 1000000,
    parameter SEED   = 1
) (
    output reg                finished,
    output integer            wrong,
    output reg signed [63:0]  pins,
    output reg signed [63:0]  expected,
    output integer            fewest
);
    localparam WIDTH = 31, MODULUS = PERIOD * 1024, FASTEST = MODULUS / (2 * PULSE + 1);

    reg                     clk, clear;
    reg  signed [WIDTH-1:0] modulus, advance;
    wire                    step, dir, lost, moving;
    wire signed [31:0]      position;
    step_dir #(.WIDTH(WIDTH), .PULSE(PULSE), .SETUP(SETUP)) dut (
        .clk(clk), .clear(clear), .modulus(modulus), .advance(advance), .step(step), .dir(dir), .position(position),
        .lost(lost), .moving(moving)
    );

    integer           seed, made, period;
    reg signed [63:0] sum;
    time              rose, fell, turned; // in half cycles

    task check(input good);
        if (good !== 1'b1) wrong = wrong + 1;
    endtask

    always #1 clk = !clk;
    always @(posedge step) begin
        check($time - fell >= 2 * PULSE && $time - turned >= 2 * SETUP);
        if (made > 0 && ($time - rose) / 2 < fewest) fewest = ($time - rose) / 2;
        made = made + 1;
        pins = pins + (dir ? -1 : 1);
        rose = $time;
    end
    always @(negedge step) if (!clear) begin
        check($time - rose == 2 * PULSE);
        fell = $time;
    end
    always @(dir) if (!clear) begin
        check(!step && $time - fell >= 2 * PULSE);
        turned = $time;
    end

    initial begin
        {clk, clear, finished} = 3'b010;
        {made, wrong, period, pins, sum, rose, fell, turned} = 0;
        fewest  = 1 << 30;
        seed    = SEED;
        modulus = MODULUS;
        advance = 0;
        #3 clear = 1'b0;
        #999;
        while (made < STEPS) begin
            if (period % 256 < 16) advance = $dist_uniform(seed, -FASTEST, FASTEST);
            else if (period % 16 == 0) advance = $random(seed) < 0 ? -FASTEST : FASTEST;
            if (period % 256 == 5) advance = $dist_uniform(seed, -3, 3);
            #(2 * PERIOD);
            sum      = sum + advance * PERIOD;
            expected = (sum + MODULUS / 2 + (64'sd1 <<< 24) * MODULUS) / MODULUS - (64'sd1 <<< 24);
            check(position == expected);
            check(pins - position <= 4 && position - pins <= 4);
            check(moving || advance == 0);
            period = period + 1;
        end
        advance = 0;
        #(32 * PULSE + 2 * SETUP + 16);
        check(!moving && !lost && !step);
        check(pins == position);
        finished = 1'b1;
    end
endmodule

`default_nettype wire
