// SPDX-License-Identifier: MIT
/*
 * uart_bridge, with anything at all in place of the receiver, the transmitter and the bus: whatever comes in is
 * answered within a bound of cycles after the line has become quiet, nothing else is, and the bus is asked as
 * AXI4-Lite wants. The bounds are in uart_bridge_inside.v.
 */
module uart_bridge_proof (
    input wire        clk,
    input wire        alarm,
    input wire        awready,
    input wire        wready,
    input wire        arready,
    input wire        bvalid,
    input wire        rvalid,
    input wire [1:0]  bresp,
    input wire [1:0]  rresp,
    input wire [31:0] rdata
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire        tx, heard;
    wire [8:0]  awaddr, araddr;
    wire [2:0]  awprot, arprot;
    wire [31:0] wdata;
    wire [3:0]  wstrb;
    wire        awvalid, wvalid, arvalid, bready, rready;
    uart_bridge #(.DIVIDER(4), .GAP(48), .BUS_CYCLES(8)) dut (
        .clk(clk), .rst(!started), .rx(1'b1), .tx(tx), .alarm(alarm), .heard(heard), .m_axil_awaddr(awaddr),
        .m_axil_awprot(awprot), .m_axil_awvalid(awvalid), .m_axil_awready(awready), .m_axil_wdata(wdata),
        .m_axil_wstrb(wstrb), .m_axil_wvalid(wvalid), .m_axil_wready(wready), .m_axil_bresp(bresp),
        .m_axil_bvalid(bvalid), .m_axil_bready(bready), .m_axil_araddr(araddr), .m_axil_arprot(arprot),
        .m_axil_arvalid(arvalid), .m_axil_arready(arready), .m_axil_rdata(rdata), .m_axil_rresp(rresp),
        .m_axil_rvalid(rvalid), .m_axil_rready(rready)
    );
    axil_properties #(.MASTER(1), .ADDRESS(9)) properties (
        .clk(clk), .rst(!started), .awaddr(awaddr), .awvalid(awvalid), .awready(awready), .wdata(wdata), .wstrb(wstrb),
        .wvalid(wvalid), .wready(wready), .bresp(bresp), .bvalid(bvalid), .bready(bready), .araddr(araddr),
        .arvalid(arvalid), .arready(arready), .rdata(rdata), .rresp(rresp), .rvalid(rvalid), .rready(rready),
        .addresses(addresses), .data(data), .reads(reads)
    );
    // One transfer at a time.
    wire [2:0] addresses, data, reads;
    wire       writing = awvalid + addresses == 1 && wvalid + data == 1 && !arvalid && reads == 0;
    wire       reading = arvalid + reads == 1 && !awvalid && !wvalid && addresses == 0 && data == 0;
    always @* if (started) begin
        if (bready) assert (writing || reading);
        else assert (!awvalid && !wvalid && !arvalid && addresses == 0 && data == 0 && reads == 0);
        cover (heard && bvalid);
    end
endmodule

module uart_rx #(parameter DIVIDER = 4) (
    input wire clk, input wire rst, input wire line, output wire [7:0] data, output wire valid, output wire failed,
    output wire active
);
    assign data = $anyseq;
    assign valid = $anyseq;
    assign failed = $anyseq;
    assign active = $anyseq;
    always @* assume (!(valid && failed));
endmodule

module uart_tx #(parameter DIVIDER = 4) (
    input wire clk, input wire rst, input wire [7:0] data, input wire valid, output wire ready, output wire line
);
    assign ready = $anyseq;
    assign line = 1'b1;
endmodule
