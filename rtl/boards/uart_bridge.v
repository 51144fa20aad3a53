// SPDX-License-Identifier: MIT
/*
 * Bridge from a serial line to AXI4-Lite: the host asks, the bridge answers every time.
 *
 * Request, 9 bytes:  A5, number, {write, register[6:0]}, data (4 bytes, lowest first), checksum (2 bytes, highest
 * first)
 * Answer, 9 bytes:   5A, number, code, data (4 bytes, lowest first), checksum (2 bytes, highest first)
 * A block of writes: B5, number, count, count times {register, data (4 bytes)}, checksum. They are carried out in
 * their order once the checksum is right, up to the first one that the bus refuses; data of the answer tells how many
 * were done. The byte address of a register is 4 times its number; data of a read request is ignored, that of a
 * write's answer is 0. The checksum covers all bytes between it and the start: CRC-16 of CCITT, polynomial 1021,
 * start FFFF, highest bit first. A request whose number is not 0 and that of the request answered before is not
 * carried out again: its answer comes again, so that a host may repeat a request whose answer was lost. A session
 * begins with number 0.
 *
 * Codes: 00 to 03 the bus's own (0 done, 2 refused, 3 no such address); of an error, number and data are 0:
 *   10 wrong checksum         11 a stop bit was low         12 the request broke off
 *   13 no start byte          14 bytes came before the answer was out
 *   15 the bus did not answer within BUS_CYCLES (number is that of the request)
 * After an error the bridge waits until the line has been quiet for GAP cycles, then answers once; so whatever comes
 * in is answered as soon as it pauses, and nothing is carried out of a request with an error.
 *
 * Format    of a byte on the line: a start bit, 8 bits, the lowest first, a stop bit; no parity.
 * Rounding  none.
 * Latency   from the stop bit of a request to the start bit of its answer: 3 cycles and those of the bus; 2 more a
 *           write of a block.
 * Flags     heard: high for a cycle for every request with a right checksum.
 *
 * When alarm rises, the bridge writes ALARM_DATA to ALARM_ADDRESS by itself, once, between two requests. A transfer
 * that the bus does not answer stays as it is, as AXI asks for, and all requests are answered with code 15 until it
 * ends.
 */
`default_nettype none

module uart_bridge #(
    // Cycles of a bit: 4 to 65535.
    parameter integer DIVIDER       = 17,
    // Cycles without a byte that end a request: 12 bits, more than the 10 of a byte, to 2^24 - 1.
    parameter integer GAP           = 20 * DIVIDER,
    // Cycles that the bus may take: 1 to 2^24 - 1.
    parameter integer BUS_CYCLES    = 1024,
    // What the bridge writes when alarm rises.
    parameter [8:0]   ALARM_ADDRESS = 9'h020,
    parameter [31:0]  ALARM_DATA    = 32'd0
) (
    input  wire        clk,
    input  wire        rst,
    input  wire        rx,
    output wire        tx,
    input  wire        alarm,
    output wire        heard,

    output reg  [8:0]  m_axil_awaddr,
    output wire [2:0]  m_axil_awprot,
    output reg         m_axil_awvalid,
    input  wire        m_axil_awready,
    output reg  [31:0] m_axil_wdata,
    output wire [3:0]  m_axil_wstrb,
    output reg         m_axil_wvalid,
    input  wire        m_axil_wready,
    input  wire [1:0]  m_axil_bresp,
    input  wire        m_axil_bvalid,
    output wire        m_axil_bready,
    output wire [8:0]  m_axil_araddr,
    output wire [2:0]  m_axil_arprot,
    output reg         m_axil_arvalid,
    input  wire        m_axil_arready,
    input  wire [31:0] m_axil_rdata,
    input  wire [1:0]  m_axil_rresp,
    input  wire        m_axil_rvalid,
    output wire        m_axil_rready
);
    generate if (GAP < 12 * DIVIDER || GAP >= 1 << 24) begin : check_gap
        uart_bridge_GAP_must_be_from_12_DIVIDER_to_2_to_the_24 stop ();
    end
    if (BUS_CYCLES < 1 || BUS_CYCLES >= 1 << 24) begin : check_bus_cycles
        uart_bridge_BUS_CYCLES_must_be_from_1_to_2_to_the_24 stop ();
    end endgenerate

    localparam [7:0]  ASK = 8'hA5, BLOCK = 8'hB5, ANSWER = 8'h5A;
    localparam [7:0]  WRONG_SUM = 8'h10, BAD_STOP = 8'h11, BROKE_OFF = 8'h12, NO_START = 8'h13, TOO_SOON = 8'h14,
                      BUS_SILENT = 8'h15;
    localparam [23:0] QUIET = GAP[23:0] - 24'd1, PATIENCE = BUS_CYCLES[23:0] - 24'd1;

    function [15:0] checked(input [15:0] sum, input [7:0] next); // the checksum with one more byte
        integer i;
        begin
            checked = sum ^ {next, 8'd0};
            for (i = 0; i < 8; i = i + 1) checked = {checked[14:0], 1'b0} ^ (checked[15] ? 16'h1021 : 16'd0);
        end
    endfunction

    wire [7:0] byte_in;
    wire       came, failed, coming;
    uart_rx #(.DIVIDER(DIVIDER)) uart_rx_inst (
        .clk(clk), .rst(rst), .line(rx), .data(byte_in), .valid(came), .failed(failed), .active(coming)
    );
    reg  [7:0] byte_out;
    wire       sending, sent;
    uart_tx #(.DIVIDER(DIVIDER)) uart_tx_inst (
        .clk(clk), .rst(rst), .data(byte_out), .valid(sending), .ready(sent), .line(tx)
    );

    // ---- The conversation.

    localparam [2:0] IDLE = 3'd0, RECEIVE = 3'd1, DRAIN = 3'd2, ACCESS = 3'd3, TELL = 3'd4;
    reg [2:0]  state;
    reg [3:0]  at;                     // bytes of this request or answer that are through
    reg [15:0] sum;
    reg [55:0] asked;                  // the latest seven bytes of the request, the newest highest
    reg [10:0] left;                   // bytes that are to come, but for the start of a block
    reg        block;
    reg [2:0]  field;                  // bytes of this write of a block
    reg [7:0]  count, entry;           // of its writes; the one at hand
    reg [38:0] writes_of [0:255];
    reg [38:0] write;                  // {register, data}
    reg        fetched;
    reg [7:0]  asked_number;
    reg        again;                  // the request is that answered before
    reg [23:0] timer;
    reg        missed, known, launched, writes;
    reg [7:0]  number, code, error;    // the latest answer; error: of a request that is not carried out, or 0
    reg [31:0] answer;
    wire       wrong = error != 8'd0;
    wire        busy, finished;
    wire [1:0]  response;
    wire        anything = came || failed;
    wire [15:0] sum_in   = checked(sum, byte_in);
    wire        opens    = block && at <= 4'd2; // number and count of a block
    wire        whole    = state == RECEIVE && came && !opens && left == 11'd1;
    wire        launch   = state == ACCESS && !launched && !busy && !again && (!block || (fetched && entry != count));
    wire        entered  = block && at == 4'd3 && field == 3'd5; // a write of a block is there
    assign heard   = whole && sum_in == 16'd0;
    assign sending = state == TELL;

    always @* case (at)
        4'd0:    byte_out = ANSWER;
        4'd1:    byte_out = wrong ? 8'd0 : number;
        4'd2:    byte_out = wrong ? error : code;
        4'd3:    byte_out = wrong ? 8'd0 : answer[7:0];
        4'd4:    byte_out = wrong ? 8'd0 : answer[15:8];
        4'd5:    byte_out = wrong ? 8'd0 : answer[23:16];
        4'd6:    byte_out = wrong ? 8'd0 : answer[31:24];
        4'd7:    byte_out = sum[15:8];
        default: byte_out = sum[7:0];
    endcase

    always @(posedge clk) begin
        timer   <= timer + 24'd1;
        fetched <= state == ACCESS && !finished;
        write   <= writes_of[entry];
        if (came && state == RECEIVE) asked <= {byte_in, asked[55:8]};
        if (state == RECEIVE && entered) begin
            writes_of[entry] <= {asked[22:16], asked[55:24]};
            entry            <= entry + 8'd1;
            field            <= 3'd0;
        end else if (state == RECEIVE && came && block && at == 4'd3) field <= field + 3'd1;
        if (anything && (state == ACCESS || state == TELL)) missed <= 1'b1;
        case (state)
            IDLE: begin
                timer <= 24'd0;
                at    <= 4'd1;
                sum   <= 16'hFFFF;
                left  <= 11'd8;
                block <= byte_in == BLOCK;
                field <= 3'd0;
                entry <= 8'd0;
                if (came && (byte_in == ASK || byte_in == BLOCK)) state <= RECEIVE;
                else if (anything) begin
                    state <= DRAIN;
                    error <= failed ? BAD_STOP : NO_START;
                end
            end
            RECEIVE: begin
                if (anything || coming) timer <= 24'd0;
                if (came) begin
                    at   <= block && at == 4'd3 ? 4'd3 : at + 4'd1;
                    sum  <= sum_in;
                    left <= opens ? {1'b0, byte_in, 2'b00} + {3'd0, byte_in} + 11'd2 : left - 11'd1;
                    if (at == 4'd1) asked_number <= byte_in;
                    if (block && at == 4'd2) count <= byte_in;
                end
                if (failed || whole || timer == QUIET) state <= DRAIN;
                error <= failed ? BAD_STOP : whole ? WRONG_SUM : BROKE_OFF;
                if (heard) begin
                    state    <= ACCESS;
                    error    <= 8'd0;
                    launched <= 1'b0;
                    entry    <= 8'd0;
                    again    <= known && asked_number == number;
                end
            end
            DRAIN: begin
                at     <= 4'd0;
                sum    <= 16'hFFFF;
                missed <= 1'b0;
                if (anything || coming) timer <= 24'd0;
                else if (timer >= QUIET) state <= TELL;
            end
            ACCESS: begin
                at       <= 4'd0;
                sum      <= 16'hFFFF;
                writes   <= asked[7];
                launched <= launched || launch;
                if (launch) timer <= 24'd0;
                if (again) state <= TELL;
                else if (block && launched && finished && response == 2'd0) begin
                    launched <= 1'b0;
                    entry    <= entry + 8'd1;
                    timer    <= 24'd0;
                end else if ((launched && finished) || (block && !launched && entry == count)) begin
                    state  <= TELL;
                    known  <= asked_number != 8'd0;
                    number <= asked_number;
                    code   <= block && entry == count ? 8'd0 : {6'd0, response};
                    answer <= block ? {24'd0, entry} : writes ? 32'd0 : m_axil_rdata;
                end else if (timer == PATIENCE) begin
                    state  <= TELL;
                    known  <= 1'b0;
                    number <= asked_number;
                    code   <= BUS_SILENT;
                    answer <= 32'd0;
                end
            end
            TELL: if (sent) begin
                at <= at + 4'd1;
                if (at >= 4'd1 && at <= 4'd6) sum <= checked(sum, byte_out);
                if (at == 4'd8) begin
                    state <= missed || anything ? DRAIN : IDLE;
                    timer <= 24'd0;
                    if (missed || anything) error <= TOO_SOON;
                end
            end
            default: state <= IDLE;
        endcase
        if (rst) begin
            state  <= IDLE;
            known  <= 1'b0;
            missed <= 1'b0;
        end
    end

    // ---- The bus: one transfer at a time.

    reg  alarm_was, alarm_owed, busy_reg, own; // own: the transfer that runs is not the host's
    wire alert = alarm_owed && !busy && state != ACCESS;
    assign busy          = busy_reg;
    assign finished      = busy && !own && (m_axil_bvalid || m_axil_rvalid);
    assign response      = m_axil_bvalid ? m_axil_bresp : m_axil_rresp;
    assign m_axil_awprot = 3'd0;
    assign m_axil_arprot = 3'd0;
    assign m_axil_wstrb  = 4'hF;
    assign m_axil_araddr = m_axil_awaddr;
    assign m_axil_bready = busy;
    assign m_axil_rready = busy;

    always @(posedge clk) begin
        alarm_was <= alarm;
        if (alarm && !alarm_was) alarm_owed <= 1'b1;
        if (m_axil_awready) m_axil_awvalid <= 1'b0;
        if (m_axil_wready) m_axil_wvalid <= 1'b0;
        if (m_axil_arready) m_axil_arvalid <= 1'b0;
        if (m_axil_bvalid || m_axil_rvalid) busy_reg <= 1'b0;
        if (launch || alert) begin
            busy_reg       <= 1'b1;
            own            <= !launch;
            m_axil_awaddr  <= !launch ? ALARM_ADDRESS : {block ? write[38:32] : asked[6:0], 2'b00};
            m_axil_wdata   <= !launch ? ALARM_DATA : block ? write[31:0] : asked[39:8];
            m_axil_awvalid <= !launch || block || asked[7];
            m_axil_wvalid  <= !launch || block || asked[7];
            m_axil_arvalid <= launch && !block && !asked[7];
        end
        if (alert) alarm_owed <= 1'b0;
        if (rst) begin
            alarm_was      <= 1'b0;
            alarm_owed     <= 1'b0;
            busy_reg       <= 1'b0;
            m_axil_awvalid <= 1'b0;
            m_axil_wvalid  <= 1'b0;
            m_axil_arvalid <= 1'b0;
        end
    end
endmodule

`default_nettype wire
