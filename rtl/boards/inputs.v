// SPDX-License-Identifier: MIT
/*
 * Inputs of the machine, switches of limit and home and a probe: without bounce, with the place of an edge, and a
 * halt.
 *
 * Registers, 32 bits, whole words only:
 *   00 LEVELS  read: the inputs without bounce, one a bit
 *   04 WATCH   {16 bits, 16 bits}: the lower half says which inputs are watched, the upper half for each the level
 *              whose coming is its edge; a write clears HIT
 *   08 HIT     read: watched inputs whose edge has come
 *   0C PLACE_X 10 PLACE_Y 14 PLACE_Z  read: positions in the latest cycle in which every watched input was at its
 *              level, while HIT is 0; then they hold: a cycle after the edge
 * A refused or unknown access answers SLVERR.
 *
 * Format    pins: asynchronous. positions: 32 bits an axis, as of axes.v.
 * Rounding  none.
 * Latency   a pin is seen 2 cycles late, but during rst at once: one that changes at its last edge may be read wrong.
 *           Its level changes when it has been seen away from it in BOUNCE more cycles than at it, since it was last
 *           calm: so BOUNCE + 2 cycles after a clean edge, while PLACE is of the cycle after it. A write takes effect
 *           2 cycles after address and data are there, a read is answered a cycle after its address.
 * Flags     halt: HIT is not 0.
 */
`default_nettype none

module inputs #(
    // Number of inputs: 1 to 15.
    parameter integer COUNT  = 7,
    // Cycles of bounce: 1 to 65535.
    parameter integer BOUNCE = 5000
) (
    input  wire             clk,
    input  wire             rst,

    input  wire [5:0]       s_axil_awaddr,
    input  wire             s_axil_awvalid,
    output wire             s_axil_awready,
    input  wire [31:0]      s_axil_wdata,
    input  wire [3:0]       s_axil_wstrb,
    input  wire             s_axil_wvalid,
    output wire             s_axil_wready,
    output wire [1:0]       s_axil_bresp,
    output wire             s_axil_bvalid,
    input  wire             s_axil_bready,
    input  wire [5:0]       s_axil_araddr,
    input  wire             s_axil_arvalid,
    output wire             s_axil_arready,
    output wire [31:0]      s_axil_rdata,
    output wire [1:0]       s_axil_rresp,
    output wire             s_axil_rvalid,
    input  wire             s_axil_rready,

    input  wire [COUNT-1:0] pins,
    input  wire [95:0]      positions,
    output wire             halt
);
    generate if (COUNT < 1 || COUNT > 15) begin : check_count
        inputs_COUNT_must_be_from_1_to_15 stop ();
    end
    if (BOUNCE < 1 || BOUNCE > 65535) begin : check_bounce
        inputs_BOUNCE_must_be_from_1_to_65535 stop ();
    end endgenerate

    localparam [3:0]  LEVELS = 4'd0, WATCH = 4'd1, HIT = 4'd2, PLACE_X = 4'd3, PLACE_Y = 4'd4, PLACE_Z = 4'd5;
    localparam [15:0] ENOUGH = BOUNCE[15:0] - 16'd1;
    localparam        REST   = 16 - COUNT;

    wire        write;
    wire [3:0]  write_at, read_at;
    wire [31:0] data;
    reg  [31:0] answer;
    axil_slave axil_slave_inst (
        .clk(clk), .rst(rst),
        .s_axil_awaddr(s_axil_awaddr), .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready),
        .s_axil_wdata(s_axil_wdata), .s_axil_wstrb(s_axil_wstrb), .s_axil_wvalid(s_axil_wvalid),
        .s_axil_wready(s_axil_wready), .s_axil_bresp(s_axil_bresp), .s_axil_bvalid(s_axil_bvalid),
        .s_axil_bready(s_axil_bready), .s_axil_araddr(s_axil_araddr), .s_axil_arvalid(s_axil_arvalid),
        .s_axil_arready(s_axil_arready), .s_axil_rdata(s_axil_rdata), .s_axil_rresp(s_axil_rresp),
        .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready),
        .write(write), .write_at(write_at), .write_data(data), .write_allowed(write_at == WATCH), .read_at(read_at),
        .read_data(answer), .read_allowed(read_at <= PLACE_Z)
    );

    reg  [COUNT-1:0] settling, seen, levels, watched, edges, hit;
    wire [COUNT-1:0] left, changed; // not calm; its level changes now
    always @(posedge clk) {seen, settling} <= rst ? {pins, pins} : {settling, pins};
    genvar i;
    generate for (i = 0; i < COUNT; i = i + 1) begin : pin
        reg  [15:0] away; // cycles in which it was away, less those in which it was back
        wire        off = seen[i] != levels[i];
        assign left[i]    = off || away != 16'd0;
        assign changed[i] = off && away == ENOUGH;
        always @(posedge clk) begin
            if (off) away <= away + 16'd1;
            else if (away != 16'd0) away <= away - 16'd1;
            if (changed[i]) away <= 16'd0;
            if (rst) away <= 16'd0;
        end
    end endgenerate

    reg [95:0] place;
    assign halt = |hit;
    always @(posedge clk) begin
        levels <= rst ? pins : levels ^ changed;
        hit    <= hit | (changed & watched & (seen ~^ edges));
        if (!halt && (left & watched) == {COUNT{1'b0}}) place <= positions;
        if (write) begin
            watched <= data[COUNT-1:0];
            edges   <= data[16+COUNT-1:16];
            hit     <= {COUNT{1'b0}};
        end
        if (rst) begin
            watched <= {COUNT{1'b0}};
            edges   <= {COUNT{1'b0}};
            hit     <= {COUNT{1'b0}};
        end
    end

    always @* case (read_at)
        LEVELS:  answer = {16'd0, {REST{1'b0}}, levels};
        WATCH:   answer = {{REST{1'b0}}, edges, {REST{1'b0}}, watched};
        HIT:     answer = {16'd0, {REST{1'b0}}, hit};
        PLACE_X: answer = place[31:0];
        PLACE_Y: answer = place[63:32];
        default: answer = place[95:64];
    endcase

    wire unused = &{1'b0, data};
endmodule

`default_nettype wire
