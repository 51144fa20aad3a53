// SPDX-License-Identifier: MIT
/*
 * The whole: a curve and a feed go in through AXI4-Lite, the points of the tool path come out on AXI4-Stream.
 *
 * Registers, 32 bits, whole words only:
 *   00 CONTROL     write 1: go, while not busy, permit is high and halt low; 2: forget the curve and all flags, at any
 *                  time, which withdraws a beat that waits, as rst does; 4: abort, at any time: the run ends with a
 *                  void beat, at once, or if SLOPE is 1, after the tool has slowed down on its path; if its last
 *                  beat waits already, that one ends it
 *   04 STATUS      [0] busy [1] the latest run has ended [2] a beat waits to be taken [3] the override rests
 *                  [4] the next bank is awaited, and the tool slows down [5] bank 0 is loaded [6] bank 1
 *                  [8] overflow [9] division by zero [10] u decreased [11] bad curve, or go without one
 *                  [12] step too large [13] beyond a limit of an axis, or a bank that would go there
 *                  [14] an abort came while busy; the flags rise at once and stay until forgotten
 *   08 LOAD_LOW    the lower half of a number for the load bus
 *   0C LOAD_HIGH   the upper half; numbers have 64 bits in two's complement
 *   10 LOAD_AT     write {space[2:0], index[9:0]}: load the number there (spaces 0 to 5: stepper.v; 7: load_guard.v);
 *                  refused while busy, but for a bank that is open if SLOPE is 1
 *   14 CYCLES      cycles of the latest run, from go to the last beat taken, 0 before the first: the lower half
 *   18 SHAPE       {RATIONAL, MAX_POINTS[6:0], SLOPE[3:0], ARRANGEMENT[3:0], DIM[7:0], WORD[7:0]} as built
 *   1C CYCLES_HIGH the upper half; while busy read it before and after CYCLES, and again if it changed
 *   20 OVERRIDE    if SLOPE is 1: the feed override, 0 (hold) to 256; above counts as 256, and so does forgetting
 * A refused or unknown access answers SLVERR, and so does a write of CONTROL with more than one bit. CONTROL and
 * LOAD_AT read as 0.
 *
 * permit: the machine may move. When it falls, all is forgotten as by CONTROL = 2, so that no run goes on after a
 * stop. halt: while it is high, a run is aborted as by CONTROL = 4, and go is refused.
 *
 * Stream, one beat a point: u, or piece and t if SLOPE is 1, in bits 0 to 39, then each coordinate in 40 bits, all
 * sign-extended. TLAST ends a run; TUSER[0] marks a void beat: a fault or abort ended the run, the beat repeats the
 * point before, and nothing is to move. TUSER[4:1]: the outputs of the piece, streamer.v; none if SLOPE is 0.
 *
 * Format    u: WORD - 1 bits without sign, WORD - 2 of them fraction; with SLOPE = 1 {bank, piece[4:0], t}, t of WORD
 *           - 1 fraction bits. Coordinates: WORD bits in two's complement, binary point chosen by the loader.
 * Rounding  none of its own.
 * Latency   of a point of the paper's curve: 41 cycles by Adams (cached), 17 with SLOPE = 1; a write takes effect 2
 *           cycles after address and data are there, a read is answered a cycle after its address.
 * Flags     in STATUS.
 */
`default_nettype none

module nurbs_interpolator #(
    // Width of a coordinate: odd, 17 to 35, from 25 if SLOPE is 1.
    parameter integer WORD        = 35,
    // Dimension of the points: 2 or 3.
    parameter integer DIM         = 3,
    // Largest number of control points: 2 to 64.
    parameter integer MAX_POINTS  = 64,
    // 0: no dividers, so no weights other than 1.
    parameter integer RATIONAL    = 1,
    // Of the Adams step: 0 serial, 1 parallel, 2 cached.
    parameter integer ARRANGEMENT = 2,
    // 0: quotients as in the paper; 1: exact, streamer.v.
    parameter integer SLOPE       = 0,
    // If SLOPE is 1: 1 computes a point as the one before is taken, so that OVERRIDE acts on it; 0 as soon as
    // possible.
    parameter integer AHEAD       = 0
) (
    input  wire                  clk,
    input  wire                  rst,
    input  wire                  permit,
    input  wire                  halt,

    input  wire [5:0]            s_axil_awaddr,
    input  wire [2:0]            s_axil_awprot,
    input  wire                  s_axil_awvalid,
    output wire                  s_axil_awready,
    input  wire [31:0]           s_axil_wdata,
    input  wire [3:0]            s_axil_wstrb,
    input  wire                  s_axil_wvalid,
    output wire                  s_axil_wready,
    output wire [1:0]            s_axil_bresp,
    output wire                  s_axil_bvalid,
    input  wire                  s_axil_bready,
    input  wire [5:0]            s_axil_araddr,
    input  wire [2:0]            s_axil_arprot,
    input  wire                  s_axil_arvalid,
    output wire                  s_axil_arready,
    output wire [31:0]           s_axil_rdata,
    output wire [1:0]            s_axil_rresp,
    output wire                  s_axil_rvalid,
    input  wire                  s_axil_rready,

    output wire [(DIM+1)*40-1:0] m_axis_tdata,
    output wire                  m_axis_tvalid,
    input  wire                  m_axis_tready,
    output wire                  m_axis_tlast,
    output wire [4:0]            m_axis_tuser
);
    localparam [3:0] OVERRIDE = 4'd8, CONTROL = 4'd0, STATUS = 4'd1, LOAD_LOW = 4'd2, LOAD_HIGH = 4'd3, LOAD_AT = 4'd4,
                     CYCLES = 4'd5, SHAPE = 4'd6, CYCLES_HIGH = 4'd7;
    generate if (SLOPE < 0 || SLOPE > 1) begin : check_slope
        nurbs_interpolator_SLOPE_must_be_0_quotient_or_1_exact stop ();
    end
    if (ARRANGEMENT < 0 || ARRANGEMENT > 2) begin : check_arrangement
        nurbs_interpolator_ARRANGEMENT_must_be_0_serial_1_parallel_or_2_cached stop ();
    end endgenerate

    localparam [31:0] AS_BUILT = {RATIONAL != 0, MAX_POINTS[6:0], SLOPE[3:0], ARRANGEMENT[3:0], DIM[7:0], WORD[7:0]};

    // ---- The bus.

    wire        write;
    wire [3:0]  write_at, read_at;
    wire [31:0] data;
    reg  [31:0] answer;
    wire        busy, writable;
    wire        orders   = write_at == CONTROL && data[31:3] == 29'd0
                           && (data[2:0] == 3'b100 || data[2:0] == 3'b010
                               || (data[2:0] == 3'b001 && !busy && permit && !halt));
    wire        allowed  = orders || write_at == LOAD_LOW || write_at == LOAD_HIGH
                           || (write_at == LOAD_AT && writable && data[31:13] == 19'd0)
                           || (write_at == OVERRIDE && SLOPE == 1);
    wire        readable = read_at <= (SLOPE == 1 ? OVERRIDE : CYCLES_HIGH);
    wire        go       = write && write_at == CONTROL && data[0];
    reg         permitted;
    wire        forget   = (write && write_at == CONTROL && data[1]) || (permitted && !permit);
    always @(posedge clk) permitted <= permit;
    wire        stop     = halt || (write && write_at == CONTROL && data[2]);
    wire        load     = write && write_at == LOAD_AT;
    reg  [63:0] number;
    axil_slave axil_slave_inst (
        .clk(clk), .rst(rst),
        .s_axil_awaddr(s_axil_awaddr), .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready),
        .s_axil_wdata(s_axil_wdata), .s_axil_wstrb(s_axil_wstrb), .s_axil_wvalid(s_axil_wvalid),
        .s_axil_wready(s_axil_wready), .s_axil_bresp(s_axil_bresp), .s_axil_bvalid(s_axil_bvalid),
        .s_axil_bready(s_axil_bready), .s_axil_araddr(s_axil_araddr), .s_axil_arvalid(s_axil_arvalid),
        .s_axil_arready(s_axil_arready), .s_axil_rdata(s_axil_rdata), .s_axil_rresp(s_axil_rresp),
        .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready),
        .write(write), .write_at(write_at), .write_data(data), .write_allowed(allowed), .read_at(read_at),
        .read_data(answer), .read_allowed(readable)
    );

    // ---- The machine.

    wire                bad, complete, done;
    wire                closes, starved;
    wire [1:0]          held;   // banks
    wire                outside; // a bank that was not closed, as its curve leaves the limits
    reg                 astray;  // since all was forgotten
    wire                loaded = complete && held[0] && !astray;
    wire [4:0]          faults;
    wire                resting;
    reg  [8:0]          rate;
    wire [39:0]         u;
    wire [DIM*WORD-1:0] point;

    load_guard #(
        .WORD(WORD), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL), .DIM(DIM), .EXACT(SLOPE)
    ) load_guard_inst (
        .clk(clk), .rst(rst), .clear(forget), .load(load), .space(data[12:10]), .index(data[9:0]),
        .data(number), .bad(bad), .ready(complete), .closes(closes)
    );
    generate if (SLOPE == 1) begin : exact
        wire [WORD+4:0] position;
        wire            sampled;
        streamer #(.WORD(WORD), .DIM(DIM), .AHEAD(AHEAD)) streamer_inst (
            .clk(clk), .rst(rst || forget), .load(load), .load_space(data[12:10]), .load_index(data[9:0]),
            .load_data(number), .go(go && loaded), .stop(stop), .rate(rate), .sampled(sampled), .resting(resting),
            .busy(busy), .done(done), .faults(faults), .valid(m_axis_tvalid), .ready(m_axis_tready),
            .position(position), .point_out(point), .last(m_axis_tlast), .stopped(m_axis_tuser[0]),
            .outputs(m_axis_tuser[4:1]), .writable(writable), .close(closes),
            .closed(held), .outside(outside), .starved(starved)
        );
        wire [40:0]     wide = {{36-WORD{1'b0}}, position};
        wire            unused = &{1'b0, sampled, wide[40]};
        assign u = wide[39:0];
    end else begin : paper
        wire [WORD-2:0] parameter_out;
        assign {resting, starved, outside, held} = 5'b00001;
        assign writable = !busy;
        wire   unused   = &{1'b0, closes};
        assign m_axis_tuser[4:1] = 4'd0;
        stepper #(
            .WORD(WORD), .DIM(DIM), .MAX_POINTS(MAX_POINTS), .RATIONAL(RATIONAL), .ARRANGEMENT(ARRANGEMENT)
        ) stepper_inst (
            .clk(clk), .rst(rst || forget), .load(load), .load_space(data[12:10]), .load_index(data[9:0]),
            .load_data(number[WORD+26:0]), .go(go && complete), .stop(stop), .busy(busy), .done(done), .faults(faults),
            .valid(m_axis_tvalid), .ready(m_axis_tready), .u_out(parameter_out), .point_out(point),
            .last(m_axis_tlast),
            .stopped(m_axis_tuser[0])
        );
        assign u = {{41-WORD{1'b0}}, parameter_out};
    end endgenerate

    assign m_axis_tdata[39:0] = u;
    genvar i;
    generate for (i = 0; i < DIM; i = i + 1) begin : axis
        assign m_axis_tdata[40*(i+1)+:40] = {{40-WORD{point[i*WORD+WORD-1]}}, point[i*WORD+:WORD]};
    end endgenerate

    reg        ended, refused, aborted;
    wire       over = ended || done; // busy has fallen: no cycle tells neither
    reg [4:0]  seen; // faults of all runs
    reg [63:0] cycles;
    always @(posedge clk) begin
        if (write && write_at == LOAD_LOW) number[31:0] <= data;
        if (write && write_at == LOAD_HIGH) number[63:32] <= data;
        if (write && write_at == OVERRIDE) rate <= |data[31:8] ? 9'd256 : data[8:0];
        if (busy) cycles <= cycles + 64'd1;
        if (busy || done) seen <= seen | faults;
        if (done) ended <= 1'b1;
        if (stop && busy) aborted <= 1'b1;
        if (outside) {refused, astray} <= 2'b11;
        if (go) begin
            ended   <= !loaded;
            refused <= refused || !loaded;
            cycles  <= 64'd0;
        end
        if (rst) {cycles, number} <= 128'd0;
        if (rst || forget) begin
            ended   <= 1'b0;
            refused <= 1'b0;
            aborted <= 1'b0;
            astray  <= 1'b0;
            rate    <= 9'd256;
            seen    <= 5'd0;
        end
    end

    always @* case (read_at)
        STATUS:      answer = {17'd0, aborted, seen[4] || astray, seen[3], bad || refused, seen[2:0], 1'b0,
                               SLOPE == 1 ? held : 2'b00, starved, resting, m_axis_tvalid, over, busy};
        LOAD_LOW:    answer = number[31:0];
        LOAD_HIGH:   answer = number[63:32];
        CYCLES:      answer = cycles[31:0];
        SHAPE:       answer = AS_BUILT;
        CYCLES_HIGH: answer = cycles[63:32];
        OVERRIDE:    answer = {23'd0, rate};
        default:     answer = 32'd0;
    endcase

    wire unused = &{1'b0, s_axil_awprot, s_axil_arprot, number[63:WORD+27]};
endmodule

`default_nettype wire
