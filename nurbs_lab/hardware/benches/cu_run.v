/*
 * Loads a curve into cu, evaluates it at a list of parameters and writes one line for each.
 *
 *   +load=FILE     lines "space index data", hexadecimal
 *   +u=FILE        lines "u", hexadecimal
 *   +result=FILE   lines "cycles out_of_range overflow by_zero point", the point hexadecimal
 *   +watch         instead one line a cycle, from start until three cycles after done: "signal=value ..." of
 *                  what goes on inside
 */
`timescale 1ns / 1ps
`default_nettype none

module cu_run #(
    parameter WORD = 35,
    parameter DIM  = 3
);
    reg clk = 1'b0;
    reg rst = 1'b1;
    always #10 clk = !clk;

    reg                 load = 1'b0;
    reg  [1:0]          load_space;
    reg  [9:0]          load_index;
    reg  [WORD+2:0]     load_data;
    reg                 start = 1'b0;
    reg  [WORD-2:0]     u;
    wire                done, out_of_range, overflow, by_zero;
    wire [DIM*WORD-1:0] point;

    cu #(.WORD(WORD), .DIM(DIM)) dut (
        .clk(clk), .rst(rst), .load(load), .load_space(load_space), .load_index(load_index), .load_data(load_data),
        .start(start), .u(u), .busy(), .done(done), .point(point), .out_of_range(out_of_range), .overflow(overflow),
        .by_zero(by_zero)
    );

    reg [8*1024-1:0] name;
    integer file, result, cycles;
    reg watch = 1'b0;

    reg [WORD-2:0] n [0:5]; // cu keeps the last N of a level apart
    always @(posedge clk) if (dut.made_n) begin
        n[dut.r_3] <= dut.n_new;
        if (dut.last_3) n[dut.r_3 + 3'd1] <= dut.share;
    end

    // Before the registers take their new values: what the cycle that ends now has seen.
    always @(posedge clk) if (watch) begin
        $fwrite(result, "start=%b busy=%b done=%b state=%h", start, dut.busy, done, dut.state);
        $fwrite(result, " product=%b", (dut.tag_1[14] && !dut.lost) || dut.tag_1[13] || dut.tag_1[9]);
        $fwrite(result, " u=%h N0=%h N1=%h N2=%h", dut.u_reg, n[0], n[1], n[2]);
        $fdisplay(result, " x=%h y=%h", point[0+:WORD], point[WORD+:WORD]);
    end

    initial begin
        repeat (2) @(negedge clk);
        rst = 1'b0;
        if (!$value$plusargs("load=%s", name)) $finish;
        file = $fopen(name, "r");
        while ($fscanf(file, "%h %h %h", load_space, load_index, load_data) == 3) begin
            load = 1'b1;
            @(negedge clk);
        end
        load = 1'b0;
        if (!$value$plusargs("result=%s", name)) $finish;
        result = $fopen(name, "w");
        if (!$value$plusargs("u=%s", name)) $finish;
        file = $fopen(name, "r");
        while ($fscanf(file, "%h", u) == 1) begin
            start = 1'b1;
            watch = $test$plusargs("watch");
            cycles = 0;
            // 1000 cycles are far more than any point takes: a line is missing rather than the run hanging.
            while (!done && cycles < 1000) begin
                @(negedge clk);
                start = 1'b0;
                cycles = cycles + 1;
            end
            if (done && !watch) $fdisplay(result, "%0d %b %b %b %h", cycles, out_of_range, overflow, by_zero, point);
            repeat (watch ? 4 : 1) @(negedge clk);
            watch = 1'b0;
        end
        $fclose(result);
        $finish;
    end
endmodule

`default_nettype wire
