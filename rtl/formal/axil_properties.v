// SPDX-License-Identifier: MIT
/*
 * The rules of AXI4-Lite, for both sides of a bus: with MASTER = 0 those of the slave are asserted and those of the
 * master assumed, with MASTER = 1 the other way round.
 *
 * Master  VALID is low in reset and stays high until READY, with its address or data as they were.
 * Slave   An answer comes after the request, one for each, at most MOST are owed; none comes in reset. It stays with
 *         its response and data until it is taken, and is never EXOKAY. Without a wait for the master, a request is
 *         taken and an answer given within PATIENCE cycles. As at most one read is owed, reads are answered in their
 *         order.
 */
module axil_properties #(
    parameter MASTER   = 0,
    parameter ADDRESS  = 6,
    parameter MOST     = 2,
    parameter PATIENCE = 3
) (
    input wire               clk,
    input wire               rst,
    input wire [ADDRESS-1:0] awaddr,
    input wire               awvalid,
    input wire               awready,
    input wire [31:0]        wdata,
    input wire [3:0]         wstrb,
    input wire               wvalid,
    input wire               wready,
    input wire [1:0]         bresp,
    input wire               bvalid,
    input wire               bready,
    input wire [ADDRESS-1:0] araddr,
    input wire               arvalid,
    input wire               arready,
    input wire [31:0]        rdata,
    input wire [1:0]         rresp,
    input wire               rvalid,
    input wire               rready,
    // Requests taken and not yet answered.
    output reg [2:0]         addresses,
    output reg [2:0]         data,
    output reg [2:0]         reads
);
    reg               reset_was = 1; // in this cycle or the one before
    reg               aw_waits = 0, w_waits = 0, ar_waits = 0, b_waits = 0, r_waits = 0;
    reg [ADDRESS-1:0] aw_was, ar_was;
    reg [35:0]        w_was;
    reg [1:0]         b_was;
    reg [33:0]        r_was;
    initial {addresses, data, reads} = 0;
    // Cycles that each channel has waited while the master let it.
    reg [3:0]         aw_late = 0, w_late = 0, ar_late = 0, b_late = 0, r_late = 0;
    wire              untaken = bvalid && !bready;

    always @(posedge clk) begin
        reset_was <= rst;
        aw_waits  <= !rst && awvalid && !awready;
        w_waits   <= !rst && wvalid && !wready;
        ar_waits  <= !rst && arvalid && !arready;
        b_waits   <= !rst && bvalid && !bready;
        r_waits   <= !rst && rvalid && !rready;
        aw_was    <= awaddr;
        w_was     <= {wdata, wstrb};
        ar_was    <= araddr;
        b_was     <= bresp;
        r_was     <= {rresp, rdata};
        addresses <= rst ? 0 : addresses + (awvalid && awready) - (bvalid && bready);
        data      <= rst ? 0 : data + (wvalid && wready) - (bvalid && bready);
        reads     <= rst ? 0 : reads + (arvalid && arready) - (rvalid && rready);
        aw_late   <= rst || awready || !awvalid || untaken || (addresses > data && !wvalid) ? 0 : aw_late + 1;
        w_late    <= rst || wready || !wvalid || untaken || (data > addresses && !awvalid) ? 0 : w_late + 1;
        ar_late   <= rst || arready || !arvalid || (rvalid && !rready) ? 0 : ar_late + 1;
        b_late    <= rst || bvalid || addresses == 0 || data == 0 ? 0 : b_late + 1;
        r_late    <= rst || rvalid || reads == 0 ? 0 : r_late + 1;
    end

    wire master_kept = (!reset_was || !(awvalid || wvalid || arvalid))
                       && (!aw_waits || (awvalid && awaddr == aw_was))
                       && (!w_waits || (wvalid && {wdata, wstrb} == w_was))
                       && (!ar_waits || (arvalid && araddr == ar_was));
    wire slave_kept  = (!reset_was || !(bvalid || rvalid))
                       && (!b_waits || (bvalid && bresp == b_was))
                       && (!r_waits || (rvalid && {rresp, rdata} == r_was))
                       && (!bvalid || (addresses != 0 && data != 0 && bresp != 2'b01))
                       && (!rvalid || (reads != 0 && rresp != 2'b01))
                       && addresses <= MOST && data <= MOST && reads <= 1
                       && aw_late < PATIENCE && w_late < PATIENCE && ar_late < PATIENCE && b_late < PATIENCE
                       && r_late < PATIENCE;
    generate if (MASTER != 0) begin : master
        always @* assume (rst || slave_kept);
        always @* if (!rst) assert (master_kept);
    end else begin : slave
        always @* assume (rst || master_kept);
        always @* if (!rst) assert (slave_kept);
    end endgenerate
endmodule
