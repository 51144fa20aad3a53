// SPDX-License-Identifier: MIT
/*
 * Registers of the board behind AXI4-Lite: what moves the motors, not what computes the path.
 *
 * Registers, 32 bits, whole words only:
 *   00 IDENTITY  read: 4E4C in the upper half, the version of this table in the lower one
 *   04 CLOCK     read: frequency of the clock in Hz
 *   08 CONTROL   write 1: enable the drivers, refused while the stop input is pressed; 2: disable them, the origin is
 *                forgotten; 4: origin, refused while anything moves or the drivers are disabled: the tool stands at
 *                the next point, flags and sums are cleared
 *   0C STATUS    read: [0] enabled [1] within a run, or a step is due [2] the origin is set, and STEPS hold [4] to [7]
 *                outputs that are on [8] stop input pressed [9] stopped by it [10] too fast [11] late [12] steps lost
 *                [13] the host was silent [14] a run began elsewhere [15] cut while the tool moved
 *   10 PERIOD    cycles of a period, LEAST_PERIOD to 2^20 - 1, 50000 after a reset; written only while no
 *                origin is set
 *   14 SCALE_X   18 SCALE_Y   1C SCALE_Z    steps of a coordinate from the next origin on, see axes.v; written only
 *                while nothing moves, as LARGEST
 *   20 POINTS    24 CHECKSUM                read: of the points since the origin, see axes.v
 *   28 STEPS_X   2C STEPS_Y   30 STEPS_Z    read: steps from the origin, two's complement; after a stop the last
 *                ones; those of y and z are of the cycle in which x was read last
 *   34 LARGEST_X 38 LARGEST_Y 3C LARGEST_Z  the most that an axis moves in a period, in 1/1024 of a step; 0 after a
 *                reset
 * A refused or unknown access answers SLVERR.
 *
 * Format    as above.
 * Rounding  none.
 * Latency   a write takes effect 2 cycles after address and data are there, a read is answered a cycle after its
 *           address.
 * Flags     in STATUS.
 */
`default_nettype none

module board_registers #(
    // Frequency of clk, in Hz.
    parameter integer CLOCK_HZ     = 50000000,
    // Least cycles of a period, 16 to 50000: what the path needs for a point under an override, see README.md.
    parameter integer LEAST_PERIOD = 1500
) (
    input  wire        clk,
    input  wire        rst,

    input  wire [5:0]  s_axil_awaddr,
    input  wire        s_axil_awvalid,
    output wire        s_axil_awready,
    input  wire [31:0] s_axil_wdata,
    input  wire [3:0]  s_axil_wstrb,
    input  wire        s_axil_wvalid,
    output wire        s_axil_wready,
    output wire [1:0]  s_axil_bresp,
    output wire        s_axil_bvalid,
    input  wire        s_axil_bready,
    input  wire [5:0]  s_axil_araddr,
    input  wire        s_axil_arvalid,
    output wire        s_axil_arready,
    output wire [31:0] s_axil_rdata,
    output wire [1:0]  s_axil_rresp,
    output wire        s_axil_rvalid,
    input  wire        s_axil_rready,

    output wire        on,
    output wire        off,
    output wire        origin,
    output reg  [19:0] period,
    output reg  [95:0] scales,
    output reg  [95:0] largest,
    input  wire        enabled,
    input  wire        pressed,
    input  wire        tripped,
    input  wire        silent,
    input  wire        moving,
    input  wire        placed,
    input  wire [3:0]  outputs,
    input  wire        too_fast,
    input  wire        late,
    input  wire        lost,
    input  wire        elsewhere,
    input  wire        cut,
    input  wire [31:0] points_taken,
    input  wire [31:0] checksum,
    input  wire [95:0] positions
);
    generate if (LEAST_PERIOD < 16 || LEAST_PERIOD > 50000) begin : check_period
        board_registers_LEAST_PERIOD_must_be_from_16_to_50000 stop ();
    end endgenerate

    localparam [3:0] IDENTITY = 4'd0, CLOCK = 4'd1, CONTROL = 4'd2, STATUS = 4'd3, PERIOD = 4'd4, SCALE_X = 4'd5,
                     SCALE_Y = 4'd6, SCALE_Z = 4'd7, POINTS = 4'd8, CHECKSUM = 4'd9, STEPS_X = 4'd10,
                     STEPS_Y = 4'd11, STEPS_Z = 4'd12, LARGEST_X = 4'd13, LARGEST_Y = 4'd14, LARGEST_Z = 4'd15;
    localparam [31:0] THIS = 32'h4E4C_0006, HZ = CLOCK_HZ, LEAST = LEAST_PERIOD;

    wire        write;
    wire [3:0]  write_at, read_at;
    wire [31:0] data;
    reg  [31:0] answer;
    reg  [63:0] steps_y_z; // of the cycle in which x was read
    wire        orders   = write_at == CONTROL && ((data == 32'd1 && !pressed) || data == 32'd2
                                                   || (data == 32'd4 && !moving && enabled));
    wire        times    = write_at == PERIOD && !placed && data[31:20] == 12'd0 && data >= LEAST;
    wire        sizes    = ((write_at >= SCALE_X && write_at <= SCALE_Z) || write_at >= LARGEST_X) && !moving;
    wire        allowed  = orders || times || sizes;
    assign on     = write && orders && data[0];
    assign off    = write && orders && data[1];
    assign origin = write && orders && data[2];
    axil_slave axil_slave_inst (
        .clk(clk), .rst(rst),
        .s_axil_awaddr(s_axil_awaddr), .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready),
        .s_axil_wdata(s_axil_wdata), .s_axil_wstrb(s_axil_wstrb), .s_axil_wvalid(s_axil_wvalid),
        .s_axil_wready(s_axil_wready), .s_axil_bresp(s_axil_bresp), .s_axil_bvalid(s_axil_bvalid),
        .s_axil_bready(s_axil_bready), .s_axil_araddr(s_axil_araddr), .s_axil_arvalid(s_axil_arvalid),
        .s_axil_arready(s_axil_arready), .s_axil_rdata(s_axil_rdata), .s_axil_rresp(s_axil_rresp),
        .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready),
        .write(write), .write_at(write_at), .write_data(data), .write_allowed(allowed), .read_at(read_at),
        .read_data(answer), .read_allowed(1'b1)
    );

    always @(posedge clk) begin
        if (write && write_at == PERIOD) period <= data[19:0];
        if (write && write_at == SCALE_X) scales[31:0] <= data;
        if (write && write_at == SCALE_Y) scales[63:32] <= data;
        if (write && write_at == SCALE_Z) scales[95:64] <= data;
        if (write && write_at == LARGEST_X) largest[31:0] <= data;
        if (write && write_at == LARGEST_Y) largest[63:32] <= data;
        if (write && write_at == LARGEST_Z) largest[95:64] <= data;
        if (s_axil_arvalid && s_axil_arready && read_at == STEPS_X) steps_y_z <= positions[95:32];
        if (rst) begin
            period  <= 20'd50000;
            scales  <= 96'd0;
            largest <= 96'd0;
        end
    end

    always @* case (read_at)
        IDENTITY:  answer = THIS;
        CLOCK:     answer = HZ;
        STATUS:    answer = {16'd0, cut, elsewhere, silent, lost, late, too_fast, tripped, pressed, outputs, 1'b0,
                              placed, moving, enabled};
        PERIOD:    answer = {12'd0, period};
        SCALE_X:   answer = scales[31:0];
        SCALE_Y:   answer = scales[63:32];
        SCALE_Z:   answer = scales[95:64];
        POINTS:    answer = points_taken;
        CHECKSUM:  answer = checksum;
        STEPS_X:   answer = positions[31:0];
        STEPS_Y:   answer = steps_y_z[31:0];
        STEPS_Z:   answer = steps_y_z[63:32];
        LARGEST_X: answer = largest[31:0];
        LARGEST_Y: answer = largest[63:32];
        LARGEST_Z: answer = largest[95:64];
        default:   answer = 32'd0;
    endcase
endmodule

`default_nettype wire
