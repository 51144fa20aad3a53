/*
 * Loads nurbs_interpolator through its registers, lets it run and writes one line for each point.
 *
 *   +writes=FILE   lines "address data", hexadecimal
 *   +later=FILE    the same for the banks that are loaded during the run, if SLOPE is 1; the stream waits meanwhile
 *   +result=FILE   lines "cycle last void data outputs", cycles counted from the last write; then "status cycles", hexadecimal
 */
`timescale 1ns / 1ps
`default_nettype none

module path_run #(
    parameter WORD        = 35,
    parameter DIM         = 3,
    parameter ARRANGEMENT = 2,
    parameter SLOPE       = 0
) ();
    reg clk = 1'b0;
    reg rst = 1'b1;
    always #10 clk = !clk;

    reg  [5:0]            address = 6'd0;
    reg  [31:0]           data = 32'd0;
    reg                   write = 1'b0, read = 1'b0;
    wire [31:0]           answer;
    wire                  tvalid, tlast;
    wire [4:0]            tuser;
    reg                   tready = 1'b1;
    wire [(DIM+1)*40-1:0] tdata;

    nurbs_interpolator #(.WORD(WORD), .DIM(DIM), .ARRANGEMENT(ARRANGEMENT), .SLOPE(SLOPE)) dut (
        .clk(clk), .rst(rst), .permit(1'b1), .halt(1'b0),
        .s_axil_awaddr(address), .s_axil_awprot(3'd0), .s_axil_awvalid(write), .s_axil_awready(),
        .s_axil_wdata(data), .s_axil_wstrb(4'hF), .s_axil_wvalid(write), .s_axil_wready(),
        .s_axil_bresp(), .s_axil_bvalid(), .s_axil_bready(1'b1),
        .s_axil_araddr(address), .s_axil_arprot(3'd0), .s_axil_arvalid(read), .s_axil_arready(),
        .s_axil_rdata(answer), .s_axil_rresp(), .s_axil_rvalid(), .s_axil_rready(1'b1),
        .m_axis_tdata(tdata), .m_axis_tvalid(tvalid), .m_axis_tready(tready), .m_axis_tlast(tlast), .m_axis_tuser(tuser)
    );

    reg [8*1024-1:0] name;
    integer file, later, more, result, clocks, idle;
    reg finished, bank;
    reg [31:0] status;

    initial begin
        repeat (2) @(negedge clk);
        rst = 1'b0;
        if (!$value$plusargs("result=%s", name)) $finish;
        result = $fopen(name, "w");
        if (!$value$plusargs("writes=%s", name)) $finish;
        file = $fopen(name, "r");
        if (!$value$plusargs("later=%s", name)) $finish;
        later = $fopen(name, "r");
        // A write takes three cycles: accepted, done, answered.
        while ($fscanf(file, "%h %h", address, data) == 2) begin
            write = 1'b1;
            @(negedge clk);
            write = 1'b0;
            repeat (2) @(negedge clk);
        end
        bank = 1'b1;
        more = $fscanf(later, "%h %h", address, data);
        // No step takes 5000 cycles: a run that stalls ends with its status.
        clocks = 1;
        idle = 0;
        finished = 1'b0;
        while (!finished && idle < 5000) begin
            @(negedge clk);
            clocks = clocks + 1;
            idle = idle + 1;
            if (more == 2 && !dut.held[bank] && !tvalid) begin
                tready = 1'b0;
                while (more == 2 && !tready) begin
                    write = 1'b1;
                    @(negedge clk);
                    write = 1'b0;
                    repeat (2) @(negedge clk);
                    clocks = clocks + 3;
                    tready = address == 6'h10 && data[12:10] == 3'd7; // the bank is closed
                    more = $fscanf(later, "%h %h", address, data);
                end
                tready = 1'b1;
                bank = !bank;
                idle = 0;
            end
            if (tvalid) begin
                $fdisplay(result, "%0d %b %b %h %0d", clocks, tlast, tuser[0], tdata, tuser[4:1]);
                idle = 0;
                finished = tlast;
            end
        end
        repeat (3) @(negedge clk);
        read = 1'b1;
        address = 6'h04;
        @(negedge clk);
        read = 1'b0;
        status = answer;
        @(negedge clk);
        read = 1'b1;
        address = 6'h14;
        @(negedge clk);
        $fdisplay(result, "%h %h", status, answer);
        $fclose(result);
        $finish;
    end
endmodule

`default_nettype wire
