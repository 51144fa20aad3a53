// SPDX-License-Identifier: MIT
/*
 * axil_slave, for any owner and any master that keeps the rules: it keeps those of the slave (axil_properties.v), and
 * does what axil_slave_inside.v says.
 */
module axil_slave_proof (
    input wire        clk,
    input wire [5:0]  awaddr,
    input wire        awvalid,
    input wire [31:0] wdata,
    input wire [3:0]  wstrb,
    input wire        wvalid,
    input wire        bready,
    input wire [5:0]  araddr,
    input wire        arvalid,
    input wire        rready,
    input wire        write_allowed,
    input wire [31:0] read_data,
    input wire        read_allowed,
    input wire        again
);
    reg started = 0;
    always @(posedge clk) started <= 1;
    wire rst = !started || again; // a reset may come at any time

    wire        awready, wready, bvalid, arready, rvalid, write;
    wire [1:0]  bresp, rresp;
    wire [31:0] rdata, write_data;
    wire [3:0]  write_at, read_at;
    axil_slave dut (
        .clk(clk), .rst(rst), .s_axil_awaddr(awaddr), .s_axil_awvalid(awvalid), .s_axil_awready(awready),
        .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
        .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready), .s_axil_araddr(araddr),
        .s_axil_arvalid(arvalid), .s_axil_arready(arready), .s_axil_rdata(rdata), .s_axil_rresp(rresp),
        .s_axil_rvalid(rvalid), .s_axil_rready(rready), .write(write), .write_at(write_at), .write_data(write_data),
        .write_allowed(write_allowed), .read_at(read_at), .read_data(read_data), .read_allowed(read_allowed)
    );
    wire [2:0] addresses, data, reads;
    axil_properties properties (
        .clk(clk), .rst(rst), .awaddr(awaddr), .awvalid(awvalid), .awready(awready), .wdata(wdata), .wstrb(wstrb),
        .wvalid(wvalid), .wready(wready), .bresp(bresp), .bvalid(bvalid), .bready(bready), .araddr(araddr),
        .arvalid(arvalid), .arready(arready), .rdata(rdata), .rresp(rresp), .rvalid(rvalid), .rready(rready),
        .addresses(addresses), .data(data), .reads(reads)
    );

    // What makes the properties inductive.
    always @* if (started && !again)
        assert (addresses == bvalid + !awready && data == bvalid + !wready && reads == rvalid);

    reg [3:0] writes = 0, answers = 0;
    always @(posedge clk) begin
        writes  <= rst ? 0 : writes + (bvalid && bready);
        answers <= rst ? 0 : answers + (rvalid && rready);
    end
    always @* if (!rst) begin
        cover (bvalid && !bready && bresp == 2);
        cover (writes == 3 && bvalid && bresp == 0);
        cover (answers == 3 && rvalid && rresp == 0);
        cover (rvalid && rresp == 2 && bvalid);
        cover (data > addresses && writes == 1);
        cover (addresses > data && writes == 1);
        cover (addresses == 2 && data == 2);
    end
endmodule
