// SPDX-License-Identifier: MIT
/*
 * nurbs_interpolator, with anything at all in place of the machine behind it and of its guard: what a write orders is
 * told apart, nothing begins while it is busy or may not move, nothing is loaded that is not writable, and a stop of
 * the machine forgets everything (nurbs_interpolator_inside.v). The rules of the bus itself are proved in
 * axil_slave_proof.v, for any owner.
 */
module nurbs_interpolator_proof #(
    parameter SLOPE = 0
) (
    input wire        clk,
    input wire [5:0]  awaddr,
    input wire        awvalid,
    input wire [31:0] wdata,
    input wire [3:0]  wstrb,
    input wire        wvalid,
    input wire        bready,
    input wire        permit,
    input wire        halt
);
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 3) age <= age + 1;
    nurbs_interpolator #(.SLOPE(SLOPE)) dut (
        .clk(clk), .rst(age == 0), .permit(permit), .halt(halt), .s_axil_awaddr(awaddr), .s_axil_awprot(3'd0),
        .s_axil_awvalid(awvalid),
        .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid), .s_axil_bready(bready),
        .s_axil_araddr(6'd0), .s_axil_arprot(3'd0), .s_axil_arvalid(1'b0), .s_axil_rready(1'b1)
    );
endmodule

module load_guard #(
    parameter WORD = 35, parameter MAX_POINTS = 64, parameter RATIONAL = 1, parameter DIM = 3, parameter EXACT = 0
) (
    input wire clk, input wire rst, input wire clear, input wire load, input wire [2:0] space, input wire [9:0] index,
    input wire [63:0] data, output wire bad, output wire ready, output wire closes
);
    assign closes = $anyseq;
    assign bad = $anyseq;
    assign ready = $anyseq;
endmodule

module stepper #(
    parameter WORD = 35, parameter DIM = 3, parameter MAX_POINTS = 64, parameter RATIONAL = 1,
    parameter ARRANGEMENT = 2
) (
    input wire clk, input wire rst, input wire load, input wire [2:0] load_space, input wire [9:0] load_index,
    input wire [WORD+26:0] load_data, input wire go, input wire stop, input wire ready,
    output wire busy, output wire done, output wire [4:0] faults, output wire valid,
    output wire [WORD-2:0] u_out, output wire [DIM*WORD-1:0] point_out,
    output wire last, output wire stopped
);
    assign busy = $anyseq;
    assign done = $anyseq;
    assign faults = $anyseq;
    assign stopped = $anyseq;
    assign valid = $anyseq;
    assign u_out = $anyseq;
    assign point_out = $anyseq;
    assign last = $anyseq;
endmodule

module streamer #(
    parameter WORD = 35, parameter DIM = 3, parameter AHEAD = 0
) (
    input wire clk, input wire rst, input wire load, input wire [2:0] load_space, input wire [9:0] load_index,
    input wire [63:0] load_data, input wire go, input wire stop, input wire [8:0] rate, input wire ready,
    input wire close,
    output wire sampled, output wire resting, output wire busy, output wire done, output wire [4:0] faults,
    output wire valid, output wire [WORD+4:0] position, output wire [DIM*WORD-1:0] point_out, output wire last,
    output wire stopped, output wire [3:0] outputs, output wire writable, output wire [1:0] closed,
    output wire outside,
    output wire starved
);
    assign {sampled, resting, busy, done, faults, valid, position, point_out, last, stopped, outputs, writable, closed,
            outside, starved} = $anyseq;
endmodule
