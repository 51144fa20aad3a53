// SPDX-License-Identifier: MIT
/*
 * axes, for any stream and any host, with anything at all in place of the products and of the pins: no point is taken
 * before an origin under enable, nor after enable fell or a flag rose; while none may be taken step_dir is cleared;
 * flags stay until an origin; a period passes from one point to the next; outputs come 13 cycles after their point,
 * stay for its period, and are off where nothing may move. In runs of any length: axes_inside.v.
 */
module axes_proof (
    input wire         clk,
    input wire         again,
    input wire         enable,
    input wire         origin,
    input wire [159:0] data,
    input wire         tvalid,
    input wire         tlast,
    input wire [4:0]   tuser
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire rst = !started || again;
`ifdef COVER // what narrows the search for examples
    always @* assume (enable && !again && tvalid);
`endif
    wire [3:0] outputs;
    wire tready, placed, moving, too_fast, late, lost, elsewhere, cut;
    axes #(.PULSE(1), .SETUP(1)) dut (
        .clk(clk), .rst(rst), .enable(enable), .origin(origin), .period(20'd16), .scales(96'd0), .largest(96'd0),
        .s_axis_tdata(data), .s_axis_tvalid(tvalid), .s_axis_tready(tready), .s_axis_tlast(tlast),
        .s_axis_tuser(tuser),
        .outputs(outputs), .placed(placed), .moving(moving), .too_fast(too_fast), .late(late), .lost(lost),
        .elsewhere(elsewhere), .cut(cut)
    );
endmodule

module multiply #(
    parameter WORD = 35, parameter LATENCY = 3
) (
    input wire clk, input wire [WORD-1:0] a, input wire [WORD-1:0] b, output wire [2*WORD-1:0] product
);
    assign product = $anyseq;
endmodule

module step_dir #(
    parameter WIDTH = 31, parameter PULSE = 50, parameter SETUP = 50
) (
    input wire clk, input wire rst, input wire clear, input wire origin, input wire [WIDTH-1:0] modulus,
    input wire [WIDTH-1:0] advance, output wire step, output wire dir, output wire [31:0] position, output wire lost,
    output wire moving
);
    assign {step, dir, position, moving} = $anyseq;
    reg gone = 0; // lost stays until origin
    wire now = $anyseq;
    always @(posedge clk) gone <= !rst && !origin && lost;
    assign lost = gone || (now && !clear);
endmodule
