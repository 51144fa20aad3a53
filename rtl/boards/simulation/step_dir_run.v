// SPDX-License-Identifier: MIT
/*
 * Bench of step_dir.v in Verilog, for its length: random distances, period after period, until STEPS steps have been
 * on the pins. The sum of all advances is kept beside it; after each period the position is compared with the sum, and
 * in every cycle the pins with their least times. Now and then all is cleared: the position is then that of the pins,
 * and all times are kept. Every 16th stretch of periods goes on at the largest speed, each in a random direction.
 *
 * Format    finished: high at the end; wrong: checks that failed; pins: steps on the pins, forward less back;
 *           expected: the sum in steps; fewest: least cycles between two steps.
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

    reg                     clk, rst, clear, origin;
    reg  signed [WIDTH-1:0] modulus, advance;
    wire                    step, dir, lost, moving;
    wire signed [31:0]      position;
    step_dir #(.WIDTH(WIDTH), .PULSE(PULSE), .SETUP(SETUP)) dut (
        
        .clk(clk), .rst(rst), .clear(clear), .origin(origin), .modulus(modulus), .advance(advance),
        .step(step), .dir(dir), .position(position),
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
    always @(negedge step) if (!rst) begin
        check($time - rose == 2 * PULSE);
        fell = $time;
    end
    always @(dir) if (!rst) begin
        check(!step && $time - fell >= 2 * PULSE);
        turned = $time;
    end

    initial begin
        {clk, rst, clear, origin, finished} = 5'b01000;
        {made, wrong, period, pins, sum, rose, fell, turned} = 0;
        fewest  = 1 << 30;
        seed    = SEED;
        modulus = MODULUS;
        advance = 0;
        #3 rst = 1'b0;
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
            if (period % 64 == 63) begin
                clear = 1'b1;
                #(2 * $dist_uniform(seed, 1, 3));
                advance = 0;
                clear = period % 128 == 63;
                #(4 * PULSE + 4);
                check(!moving && pins == position);
                sum      = position * MODULUS;
                expected = position;
                clear    = 1'b0;
                if (period % 256 == 255) begin
                    origin = 1'b1;
                    #2 origin = 1'b0;
                    check(position == 0);
                    {sum, pins, expected} = 0;
                end
            end
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
