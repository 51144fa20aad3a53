/*
 * nurbs_interpolator, with anything at all in place of the machine behind it: the AXI4-Lite slave keeps the rules of the
 * protocol for any master that does. Every accepted request is answered once, in order; an answer holds still until it
 * is taken; READY comes again within two cycles of the answer taken, so that every request is accepted.
 */
module nurbs_interpolator_proof (
    input wire        clk,
    input wire [5:0]  awaddr,
    input wire        awvalid,
    input wire [31:0] wdata,
    input wire [3:0]  wstrb,
    input wire        wvalid,
    input wire        bready,
    input wire [5:0]  araddr,
    input wire        arvalid,
    input wire        rready
);
    reg [1:0] age = 0;
    always @(posedge clk) if (age != 3) age <= age + 1;
    wire rst = age == 0;

    wire        awready, wready, bvalid, arready, rvalid;
    wire [1:0]  bresp, rresp;
    wire [31:0] rdata;
    nurbs_interpolator dut (
        .clk(clk), .rst(rst), .s_axil_awaddr(awaddr), .s_axil_awprot(3'd0), .s_axil_awvalid(awvalid),
        .s_axil_awready(awready), .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid),
        .s_axil_wready(wready), .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready),
        .s_axil_araddr(araddr), .s_axil_arprot(3'd0), .s_axil_arvalid(arvalid), .s_axil_arready(arready),
        .s_axil_rdata(rdata), .s_axil_rresp(rresp), .s_axil_rvalid(rvalid), .s_axil_rready(rready)
    );

    // Requests taken less answers given: 1 while an answer waits, else 0.
    reg [3:0]  reads = 0;
    reg        b_waits = 0, r_waits = 0;
    reg [1:0]  b_was;
    reg [33:0] r_was;
    always @(posedge clk) if (!rst) begin
        reads   <= reads + (arvalid && arready) - (rvalid && rready);
        b_waits <= bvalid && !bready;
        r_waits <= rvalid && !rready;
        b_was   <= bresp;
        r_was   <= {rresp, rdata};
    end
    // Requests whose address or data has been taken, and which wait for their answer: at most one in registers and one
    // answer that nobody has taken.
    reg [3:0] addresses = 0, data = 0;
    reg [2:0] idle_aw = 0, idle_w = 0; // cycles that a request has waited while the master takes answers at once
    always @(posedge clk) if (!rst) begin
        addresses <= addresses + (awvalid && awready) - (bvalid && bready);
        data      <= data + (wvalid && wready) - (bvalid && bready);
        idle_aw   <= awvalid && !awready && bready && wvalid ? idle_aw + 1 : 0;
        idle_w    <= wvalid && !wready && bready && awvalid ? idle_w + 1 : 0;
    end
    always @* if (rst) assert (addresses == 0 && data == 0 && reads == 0 && !b_waits && !r_waits);
    else begin
        assert (addresses == bvalid + !awready);
        assert (data == bvalid + !wready);
        assert (reads == rvalid);
        if (b_waits) assert (bvalid && bresp == b_was);
        if (r_waits) assert (rvalid && {rresp, rdata} == r_was);
        assert (idle_aw <= 3 && idle_w <= 3);
    end
    always @* if (!rst) begin
        cover (bvalid && bresp == 2'd2 && b_waits);
        cover (rvalid && r_waits && rresp == 2'd0);
    end
endmodule

module load_guard #(
    parameter WORD = 35, parameter MAX_POINTS = 64, parameter RATIONAL = 1, parameter EXACT = 0
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
    parameter ARRANGEMENT = 2, parameter HISTORY = 0
) (
    input wire clk, input wire rst, input wire load, input wire [2:0] load_space, input wire [9:0] load_index,
    input wire [WORD+14:0] load_data, input wire go, input wire stop, input wire ready,
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
