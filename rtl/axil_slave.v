// SPDX-License-Identifier: MIT
/*
 * AXI4-Lite for a set of 16 registers of 32 bits: the owner says what each holds and which accesses it allows.
 *
 * A request is answered OKAY if it is for a whole word and the owner allows it, else SLVERR, and then nothing is
 * written. One write and one read may be on their way at a time.
 *
 * Format    write_at, read_at: which register.
 * Rounding  none.
 * Latency   a write takes effect 2 cycles after address and data are there; all READY signals are registers, and so is
 *           all that answers. Every request is taken within 3 cycles, if the master takes answers at once.
 * Flags     none.
 *
 * write is high for the cycle in which write_data takes effect. write_allowed is sampled for write_at and write_data,
 * read_data and read_allowed for read_at, all in the same cycle.
 */
`default_nettype none

module axil_slave (
    input  wire        clk,
    input  wire        rst,

    input  wire [5:0]  s_axil_awaddr,
    input  wire        s_axil_awvalid,
    output wire        s_axil_awready,
    input  wire [31:0] s_axil_wdata,
    input  wire [3:0]  s_axil_wstrb,
    input  wire        s_axil_wvalid,
    output wire        s_axil_wready,
    output reg  [1:0]  s_axil_bresp,
    output reg         s_axil_bvalid,
    input  wire        s_axil_bready,
    input  wire [5:0]  s_axil_araddr,
    input  wire        s_axil_arvalid,
    output wire        s_axil_arready,
    output reg  [31:0] s_axil_rdata,
    output reg  [1:0]  s_axil_rresp,
    output reg         s_axil_rvalid,
    input  wire        s_axil_rready,

    output wire        write,
    output wire [3:0]  write_at,
    output reg  [31:0] write_data,
    input  wire        write_allowed,
    output wire [3:0]  read_at,
    input  wire [31:0] read_data,
    input  wire        read_allowed
);
    localparam [1:0] OKAY = 2'b00, SLVERR = 2'b10;

    // Address and data of a write are taken when each comes, and wait for one another in registers.
    reg        address_held, data_held;
    reg [5:0]  address;
    reg [3:0]  strobes;
    wire       complete = address_held && data_held && !s_axil_bvalid;
    assign     write_at = address[5:2];
    assign     write    = complete && &strobes && address[1:0] == 2'd0 && write_allowed;
    assign     read_at  = s_axil_araddr[5:2];

    assign s_axil_awready = !address_held;
    assign s_axil_wready  = !data_held;
    assign s_axil_arready = !s_axil_rvalid;

    always @(posedge clk) begin
        if (!address_held) address <= s_axil_awaddr;
        if (!data_held) {strobes, write_data} <= {s_axil_wstrb, s_axil_wdata};
        address_held <= !rst && !complete && (address_held || s_axil_awvalid);
        data_held    <= !rst && !complete && (data_held || s_axil_wvalid);
        if (s_axil_bready) s_axil_bvalid <= 1'b0;
        if (complete) begin
            s_axil_bvalid <= 1'b1;
            s_axil_bresp  <= write ? OKAY : SLVERR;
        end
        if (s_axil_rready) s_axil_rvalid <= 1'b0;
        if (s_axil_arvalid && s_axil_arready) begin
            s_axil_rvalid <= 1'b1;
            s_axil_rresp  <= read_allowed && s_axil_araddr[1:0] == 2'd0 ? OKAY : SLVERR;
            s_axil_rdata  <= read_data;
        end
        if (rst) begin
            s_axil_bvalid <= 1'b0;
            s_axil_rvalid <= 1'b0;
        end
    end
endmodule

`default_nettype wire
