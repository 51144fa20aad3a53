/*
 * The whole: a curve and a feed go in through AXI4-Lite, the points of the tool path come out on AXI4-Stream.
 *
 * Registers, 32 bits, whole words only:
 *   00 CONTROL   write 1: go; write 2: forget the curve and all flags
 *   04 STATUS    [0] busy [1] the latest run has ended [8] overflow [9] division by zero [10] a step back
 *                [11] bad curve, or go without one; the flags stay until forgotten
 *   08 LOAD_LOW  the lower half of a number for the load bus
 *   0C LOAD_HIGH the upper half; numbers have 64 bits in two's complement
 *   10 LOAD_AT   write {space[2:0], index[9:0]}: load the number there (spaces: stepper.v); refused while busy
 *   14 CYCLES    clocks of the latest run, from go to the last point taken
 *   18 SHAPE     {HISTORY[3:0], ARRANGEMENT[3:0], DIM[7:0], WORD[7:0]} as built
 * A refused or unknown access answers SLVERR.
 *
 * Stream, one beat a point: u in bits 0 to 39, then each coordinate in 40 bits, all sign-extended; TLAST with the end
 * of the curve, or with the point at which a flag stopped the run.
 *
 * Format    as in cu.v.
 * Rounding  none of its own.
 * Latency   as in stepper.v.
 * Flags     as in STATUS.
 */
`default_nettype none

module nurbs_interpolator #(
    // As in cu.v.
    parameter WORD        = 35,
    parameter DIM         = 3,
    parameter MAX_POINTS  = 64,
    parameter RATIONAL    = 1,
    // As in adams.v.
    parameter ARRANGEMENT = 2,
    parameter HISTORY     = 0
) (
    input  wire                  clk,
    input  wire                  rst,

    input  wire [4:0]            s_axil_awaddr,
    input  wire [2:0]            s_axil_awprot,
    input  wire                  s_axil_awvalid,
    output wire                  s_axil_awready,
    input  wire [31:0]           s_axil_wdata,
    input  wire [3:0]            s_axil_wstrb,
    input  wire                  s_axil_wvalid,
    output wire                  s_axil_wready,
    output reg  [1:0]            s_axil_bresp,
    output reg                   s_axil_bvalid,
    input  wire                  s_axil_bready,
    input  wire [4:0]            s_axil_araddr,
    input  wire [2:0]            s_axil_arprot,
    input  wire                  s_axil_arvalid,
    output wire                  s_axil_arready,
    output reg  [31:0]           s_axil_rdata,
    output reg  [1:0]            s_axil_rresp,
    output reg                   s_axil_rvalid,
    input  wire                  s_axil_rready,

    output wire [(DIM+1)*40-1:0] m_axis_tdata,
    output wire                  m_axis_tvalid,
    input  wire                  m_axis_tready,
    output wire                  m_axis_tlast
);
    localparam [2:0] CONTROL = 3'd0, STATUS = 3'd1, LOAD_LOW = 3'd2, LOAD_HIGH = 3'd3, LOAD_AT = 3'd4, CYCLES = 3'd5,
                     SHAPE = 3'd6;
    localparam [1:0] OKAY = 2'b00, SLVERR = 2'b10;
    localparam [31:0] AS_BUILT = {8'd0, HISTORY[3:0], ARRANGEMENT[3:0], DIM[7:0], WORD[7:0]};

    // ---- Writes: address and data are taken together.

    wire       write     = s_axil_awvalid && s_axil_wvalid && !s_axil_bvalid;
    wire [2:0] write_at  = s_axil_awaddr[4:2];
    wire       whole     = &s_axil_wstrb && s_axil_awaddr[1:0] == 2'd0;
    wire       busy;
    wire       allowed   = whole && (write_at == CONTROL || write_at == LOAD_LOW || write_at == LOAD_HIGH
                                     || write_at == LOAD_AT) && !(busy && write_at != LOAD_LOW && write_at != LOAD_HIGH);
    wire       act       = write && allowed;
    wire       go        = act && write_at == CONTROL && s_axil_wdata[0];
    wire       forget    = act && write_at == CONTROL && s_axil_wdata[1];
    wire       load      = act && write_at == LOAD_AT;
    reg [63:0] number;

    assign s_axil_awready = write;
    assign s_axil_wready  = write;
    assign s_axil_arready = !s_axil_rvalid;

    // ---- The machine.

    wire                bad, complete, done, overflow, by_zero, backward;
    wire [WORD-2:0]     u;
    wire [DIM*WORD-1:0] point;

    load_guard #(.WORD(WORD), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL)) load_guard_inst (
        .clk(clk), .rst(rst), .clear(forget), .load(load), .space(s_axil_wdata[12:10]), .index(s_axil_wdata[9:0]),
        .data(number), .bad(bad), .ready(complete)
    );
    stepper #(
        .WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL), .ARRANGEMENT(ARRANGEMENT),
        .HISTORY(HISTORY)
    ) stepper_inst (
        .clk(clk), .rst(rst), .load(load), .load_space(s_axil_wdata[12:10]), .load_index(s_axil_wdata[9:0]),
        .load_data(number[WORD+14:0]), .go(go && complete), .busy(busy), .done(done), .overflow(overflow),
        .by_zero(by_zero), .backward(backward), .valid(m_axis_tvalid), .ready(m_axis_tready), .u_out(u),
        .point_out(point), .last(m_axis_tlast)
    );

    assign m_axis_tdata[39:0] = {{41-WORD{1'b0}}, u};
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : axis
        assign m_axis_tdata[40*(i+1)+:40] = {{40-WORD{point[i*WORD+WORD-1]}}, point[i*WORD+:WORD]};
    end endgenerate

    reg        ended, refused;
    reg [2:0]  faults; // of all runs
    reg [31:0] cycles;
    always @(posedge clk) begin
        if (act && write_at == LOAD_LOW) number[31:0] <= s_axil_wdata;
        if (act && write_at == LOAD_HIGH) number[63:32] <= s_axil_wdata;
        if (busy) cycles <= cycles + 32'd1;
        if (done) begin
            ended  <= 1'b1;
            faults <= faults | {backward, by_zero, overflow};
        end
        if (go) begin
            ended   <= !complete;
            refused <= refused || !complete;
            cycles  <= 32'd0;
        end
        if (rst || forget) begin
            ended   <= 1'b0;
            refused <= 1'b0;
            faults  <= 3'd0;
        end
    end

    // ---- Answers.

    always @(posedge clk) begin
        if (s_axil_bready) s_axil_bvalid <= 1'b0;
        if (write) begin
            s_axil_bvalid <= 1'b1;
            s_axil_bresp  <= allowed ? OKAY : SLVERR;
        end
        if (s_axil_rready) s_axil_rvalid <= 1'b0;
        if (s_axil_arvalid && s_axil_arready) begin
            s_axil_rvalid <= 1'b1;
            s_axil_rresp  <= s_axil_araddr[4:2] == 3'd7 || s_axil_araddr[1:0] != 2'd0 ? SLVERR : OKAY;
            case (s_axil_araddr[4:2])
                STATUS:    s_axil_rdata <= {20'd0, bad || refused, faults, 6'd0, ended, busy};
                LOAD_LOW:  s_axil_rdata <= number[31:0];
                LOAD_HIGH: s_axil_rdata <= number[63:32];
                CYCLES:    s_axil_rdata <= cycles;
                SHAPE:     s_axil_rdata <= AS_BUILT;
                default:   s_axil_rdata <= 32'd0;
            endcase
        end
        if (rst) begin
            s_axil_bvalid <= 1'b0;
            s_axil_rvalid <= 1'b0;
        end
    end

    wire unused = &{1'b0, s_axil_awprot, s_axil_arprot, number[63:WORD+15]};
endmodule

`default_nettype wire
