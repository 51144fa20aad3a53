// SPDX-License-Identifier: MIT
/*
 * The interpolator on a Colorlight i5 (Lattice LFE5U-25F, speed grade 6), as the top of the chip: the host speaks
 * over the serial line, three motor drivers take step and direction. README.md beside this file says how to wire and
 * run it.
 *
 * Registers: 000 to 03F of the bridge are those of nurbs_interpolator.v, 100 to 13F those of board_registers.v, 180 to
 * 1BF those of inputs.v.
 *
 * Format    serial line: 8 data bits, no parity, one stop bit. Registers: 32 bits.
 * Rounding  none of its own.
 * Latency   enable_n and step follow stop through gates; all else is synchronous to 50 MHz.
 * contacts: limit and home of x, y and z, in this order, and the probe.
 *
 * tools: outputs that come with the stream, high is on: spindle, coolant, another, and a laser, which is on only while
 * an axis moves. A stop cuts them through gates, as it does enable_n and step; see axes.v for what else turns them
 * off.
 *
 * Flags     led_n: on (low) while the drivers are enabled.
 *
 * Whenever the host has been silent for WATCHDOG cycles while the drivers are enabled, the bridge writes 0 to
 * OVERRIDE: the tool slows down on its path and rests, the drivers keep their torque. An emergency stop, disabling,
 * or a fault of the axes makes the interpolator forget its curve: nothing moves again before the host has loaded,
 * enabled, set the origin, and said go.
 */
`default_nettype none

module colorlight_i5 #(
    // Cycles of a bit on the serial line: 3,000,000 baud as shipped, 2 % slow.
    parameter integer DIVIDER  = 17,
    // Cycles without a byte that break a request off: 10 ms, as USB comes in frames of 1 ms and a host has other work.
    parameter integer GAP      = 500000,
    // Longest silence of the host while the drivers are enabled, in cycles: half a second.
    parameter integer WATCHDOG = 25000000,
    // Cycles of a pulse, and from a change of direction to the next step: 1 microsecond each, 495 kHz at most.
    parameter integer PULSE    = 50,
    parameter integer SETUP    = 50,
    // Bounce of the inputs, in cycles: 0.1 ms.
    parameter integer BOUNCE   = 5000
) (
    input  wire       clk_25,
    input  wire       uart_rx,
    output wire       uart_tx,
    input  wire       stop,
    input  wire [6:0] contacts,
    output wire [2:0] step,
    output wire [2:0] dir,
    output wire [3:0] tools,
    output wire       enable_n,
    output wire       led_n
);
    // ---- Clock and reset. The loop runs at 25 x 2 x 12 = 600 MHz; its analogue values are those of the tool ecppll.

    wire clk, locked, rst;
    (* ICP_CURRENT="12" *) (* LPF_RESISTOR="8" *) (* MFG_ENABLE_FILTEROPAMP="1" *) (* MFG_GMCREF_SEL="2" *)
    EHXPLLL #(
        .CLKI_DIV(1), .CLKFB_DIV(2), .CLKOP_DIV(12), .CLKOP_ENABLE("ENABLED"), .CLKOP_CPHASE(5), .CLKOP_FPHASE(0),
        .FEEDBK_PATH("CLKOP"), .OUTDIVIDER_MUXA("DIVA")
    ) pll (
        .CLKI(clk_25), .CLKFB(clk), .CLKOP(clk), .LOCK(locked), .RST(1'b0), .STDBY(1'b0), .PHASESEL0(1'b0),
        .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1), .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0)
    );
    reset_sync reset_sync_inst (.clk(clk), .ok(locked), .rst(rst));

    // ---- The host.

    wire [8:0]  awaddr, araddr;
    wire [2:0]  awprot, arprot;
    wire [3:0]  wstrb;
    wire [31:0] wdata, path_rdata, board_rdata, inputs_rdata;
    wire [1:0]  path_bresp, path_rresp, board_bresp, board_rresp, inputs_bresp, inputs_rresp;
    wire        awvalid, wvalid, arvalid, bready, rready, heard, expired, silent;
    wire        path_awready, path_wready, path_arready, path_bvalid, path_rvalid;
    wire        board_awready, board_wready, board_arready, board_bvalid, board_rvalid;
    wire        inputs_awready, inputs_wready, inputs_arready, inputs_bvalid, inputs_rvalid, halt;
    // One transfer at a time and its address holds, so the address chooses for all channels. An address beyond the
    // registers becomes one that all refuse, as it is not that of a whole word.
    wire        to_path  = !awaddr[8], to_board = awaddr[8] && !awaddr[7], to_inputs = awaddr[8] && awaddr[7];
    wire [5:0]  register = !awaddr[6] && !(awaddr[7] && !awaddr[8]) ? awaddr[5:0] : 6'd1;
    uart_bridge #(.DIVIDER(DIVIDER), .GAP(GAP)) uart_bridge_inst (
        .clk(clk), .rst(rst), .rx(uart_rx), .tx(uart_tx), .alarm(expired), .heard(heard),
        .m_axil_awaddr(awaddr), .m_axil_awprot(awprot), .m_axil_awvalid(awvalid),
        .m_axil_awready(to_path ? path_awready : to_board ? board_awready : inputs_awready),
        .m_axil_wdata(wdata), .m_axil_wstrb(wstrb), .m_axil_wvalid(wvalid),
        .m_axil_wready(to_path ? path_wready : to_board ? board_wready : inputs_wready),
        .m_axil_bresp(to_path ? path_bresp : to_board ? board_bresp : inputs_bresp),
        .m_axil_bvalid(to_path ? path_bvalid : to_board ? board_bvalid : inputs_bvalid),
        .m_axil_bready(bready),
        .m_axil_araddr(araddr), .m_axil_arprot(arprot), .m_axil_arvalid(arvalid),
        .m_axil_arready(to_path ? path_arready : to_board ? board_arready : inputs_arready),
        .m_axil_rdata(to_path ? path_rdata : to_board ? board_rdata : inputs_rdata),
        .m_axil_rresp(to_path ? path_rresp : to_board ? board_rresp : inputs_rresp),
        .m_axil_rvalid(to_path ? path_rvalid : to_board ? board_rvalid : inputs_rvalid), .m_axil_rready(rready)
    );
    wire enabled, enable, origin;
    watchdog #(.CYCLES(WATCHDOG)) watchdog_inst (
        .clk(clk), .rst(rst), .armed(enabled), .fed(heard), .forget(origin), .expired(expired), .silent(silent)
    );

    // ---- The path: a point on its way at a time, so that a command acts on the next one.

    wire [159:0] point;
    wire         point_valid, point_ready, point_last, placed;
    wire [4:0]   point_user;
    wire [3:0]   outputs;
    nurbs_interpolator #(.DIM(3), .RATIONAL(0), .SLOPE(1), .AHEAD(1)) nurbs_interpolator_inst (
        .clk(clk), .rst(rst), .permit(placed), .halt(halt),
        .s_axil_awaddr(register), .s_axil_awprot(awprot), .s_axil_awvalid(awvalid && to_path),
        .s_axil_awready(path_awready), .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid && to_path),
        .s_axil_wready(path_wready), .s_axil_bresp(path_bresp), .s_axil_bvalid(path_bvalid), .s_axil_bready(bready),
        .s_axil_araddr(register), .s_axil_arprot(arprot), .s_axil_arvalid(arvalid && to_path),
        .s_axil_arready(path_arready), .s_axil_rdata(path_rdata), .s_axil_rresp(path_rresp),
        .s_axil_rvalid(path_rvalid), .s_axil_rready(rready),
        .m_axis_tdata(point), .m_axis_tvalid(point_valid), .m_axis_tready(point_ready), .m_axis_tlast(point_last),
        .m_axis_tuser(point_user)
    );

    // ---- The motors.

    wire        on, off, pressed, tripped, moving, too_fast, late, lost, elsewhere, cut;
    wire [19:0] period;
    wire [95:0] scales, largest, positions;
    wire [31:0] points_taken, checksum;
    board_registers board_registers_inst (
        .clk(clk), .rst(rst),
        .s_axil_awaddr(register), .s_axil_awvalid(awvalid && to_board), .s_axil_awready(board_awready),
        .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid && to_board), .s_axil_wready(board_wready),
        .s_axil_bresp(board_bresp), .s_axil_bvalid(board_bvalid), .s_axil_bready(bready),
        .s_axil_araddr(register), .s_axil_arvalid(arvalid && to_board), .s_axil_arready(board_arready),
        .s_axil_rdata(board_rdata), .s_axil_rresp(board_rresp), .s_axil_rvalid(board_rvalid), .s_axil_rready(rready),
        .on(on), .off(off), .origin(origin), .period(period), .scales(scales), .largest(largest), .enabled(enabled),
        .pressed(pressed), .tripped(tripped), .silent(silent), .moving(moving), .placed(placed),
        .outputs(outputs), .too_fast(too_fast),
        .late(late), .lost(lost), .elsewhere(elsewhere), .cut(cut), .points_taken(points_taken), .checksum(checksum),
        .positions(positions)
    );
    inputs #(.BOUNCE(BOUNCE)) inputs_inst (
        .clk(clk), .rst(rst),
        .s_axil_awaddr(register), .s_axil_awvalid(awvalid && to_inputs), .s_axil_awready(inputs_awready),
        .s_axil_wdata(wdata), .s_axil_wstrb(wstrb), .s_axil_wvalid(wvalid && to_inputs), .s_axil_wready(inputs_wready),
        .s_axil_bresp(inputs_bresp), .s_axil_bvalid(inputs_bvalid), .s_axil_bready(bready),
        .s_axil_araddr(register), .s_axil_arvalid(arvalid && to_inputs), .s_axil_arready(inputs_arready),
        .s_axil_rdata(inputs_rdata), .s_axil_rresp(inputs_rresp), .s_axil_rvalid(inputs_rvalid),
        .s_axil_rready(rready),
        .pins(contacts), .positions(positions), .halt(halt)
    );
    emergency_stop emergency_stop_inst (
        .clk(clk), .rst(rst), .stop(stop), .on(on), .off(off), .enable(enable), .enabled(enabled), .tripped(tripped),
        .pressed(pressed)
    );
    wire [2:0] steps;
    axes #(.PULSE(PULSE), .SETUP(SETUP)) axes_inst (
        .clk(clk), .rst(rst), .enable(enabled), .origin(origin), .period(period), .scales(scales),
        .largest(largest),
        .s_axis_tdata(point), .s_axis_tvalid(point_valid), .s_axis_tready(point_ready), .s_axis_tlast(point_last),
        .s_axis_tuser(point_user), .step(steps), .dir(dir), .outputs(outputs), .positions(positions),
        .points_taken(points_taken), .checksum(checksum), .placed(placed), .moving(moving), .too_fast(too_fast),
        .late(late), .lost(lost), .elsewhere(elsewhere), .cut(cut)
    );
    assign step     = enable ? steps : 3'd0;
    assign tools    = enable ? outputs : 4'd0;
    assign enable_n = !enable;
    assign led_n    = !enabled;

    wire unused = &{1'b0, araddr};
endmodule

`default_nettype wire
