// SPDX-License-Identifier: MIT
/* step_dir, for any distances it may be given, cleared at any time: what step_dir_inside.v says, in runs of any
 * length. */
module step_dir_proof (
    input wire              clk,
    input wire              again,
    input wire              clear,
    input wire              origin,
    input wire signed [7:0] advance
);
    localparam PULSE = 2, MODULUS = 60;
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire               step, dir, lost, moving;
    wire signed [31:0] position;
    step_dir #(.WIDTH(8), .PULSE(PULSE), .SETUP(3)) dut (
        .clk(clk), .rst(!started || again), .clear(clear), .origin(origin), .modulus(8'sd60), .advance(advance),
        .step(step), .dir(dir), .position(position), .lost(lost), .moving(moving)
    );
    always @* assume (advance <= MODULUS / 2 && advance >= -MODULUS / 2); // more than pulses can follow
endmodule
