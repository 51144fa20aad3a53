// SPDX-License-Identifier: MIT
/*
 * inputs, for any pins, positions and host, with anything at all in place of the bus: each input changes its level,
 * comes and stays as the header says, the place is that of the latest calm cycle and holds. In runs of any length:
 * inputs_inside.v.
 */
module inputs_proof (input wire clk, input wire again, input wire [1:0] pins, input wire [95:0] positions);
    reg started = 0;
    always @(posedge clk) started <= 1;
    inputs #(.COUNT(2), .BOUNCE(3)) dut (
        .clk(clk), .rst(!started || again), .s_axil_awaddr(6'd0), .s_axil_awvalid(1'b0), .s_axil_wdata(32'd0),
        .s_axil_wstrb(4'd0), .s_axil_wvalid(1'b0), .s_axil_bready(1'b1), .s_axil_araddr(6'd0), .s_axil_arvalid(1'b0),
        .s_axil_rready(1'b1), .pins(pins), .positions(positions)
    );
endmodule

module axil_slave (
    input wire clk, input wire rst, input wire [5:0] s_axil_awaddr, input wire s_axil_awvalid,
    output wire s_axil_awready, input wire [31:0] s_axil_wdata, input wire [3:0] s_axil_wstrb,
    input wire s_axil_wvalid, output wire s_axil_wready, output wire [1:0] s_axil_bresp, output wire s_axil_bvalid,
    input wire s_axil_bready, input wire [5:0] s_axil_araddr, input wire s_axil_arvalid, output wire s_axil_arready,
    output wire [31:0] s_axil_rdata, output wire [1:0] s_axil_rresp, output wire s_axil_rvalid,
    input wire s_axil_rready, output wire write, output wire [3:0] write_at, output wire [31:0] write_data,
    input wire write_allowed, output wire [3:0] read_at, input wire [31:0] read_data, input wire read_allowed
);
    wire any = $anyseq;
    assign {write_at, write_data, read_at} = $anyseq;
    assign write = any && write_allowed;
endmodule
