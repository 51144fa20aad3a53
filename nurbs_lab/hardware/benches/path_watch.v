/*
 * path_run, and beside its lines what works when: a line "busy cycle unit row" for each unit that works in a cycle.
 *
 * The units of a row of the paper's circuit, SLOPE = 0: newer and older, the points at both ends of a quotient, from
 * start to done; squares, root and quotient of kout; of the whole circuit hand_over. With SLOPE = 1: slope, point and
 * hand_over. The cycles are those of path_run's lines.
 */
`timescale 1ns / 1ps
`default_nettype none

module path_watch #(
    parameter WORD        = 35,
    parameter DIM         = 3,
    parameter ARRANGEMENT = 2,
    parameter SLOPE       = 0
) ();
    path_run #(.WORD(WORD), .DIM(DIM), .ARRANGEMENT(ARRANGEMENT), .SLOPE(SLOPE)) run ();
    wire watch = run.clocks > 0;

    // Before the registers take their new values: what the cycle that ends now has seen.
    genvar i;
    generate if (SLOPE == 1) begin : exact
        always @(posedge run.clk) if (watch) begin
            if (run.dut.exact.streamer_inst.step || run.dut.exact.streamer_inst.step_busy)
                $fdisplay(run.result, "busy %0d slope 0", run.clocks);
            if (run.dut.exact.streamer_inst.state == 3'd2 || run.dut.exact.streamer_inst.pending)
                $fdisplay(run.result, "busy %0d point 0", run.clocks);
            else if (run.dut.exact.streamer_inst.state == 3'd3 || run.dut.exact.streamer_inst.state == 3'd4)
                $fdisplay(run.result, "busy %0d hand_over 0", run.clocks);
        end
    end else begin : paper
        always @(posedge run.clk) if (watch && run.dut.paper.stepper_inst.state == 4'd2)
            $fdisplay(run.result, "busy %0d hand_over 0", run.clocks);
        for (i = 0; i < (ARRANGEMENT == 1 ? 4 : 1); i = i + 1) begin : row
            wire go      = run.dut.paper.stepper_inst.row[i].slope_inst.go;
            wire newer   = run.dut.paper.stepper_inst.row[i].slope_inst.want_a && go;
            wire older   = ARRANGEMENT == 1 ? run.dut.paper.stepper_inst.row[i].slope_inst.want_b && go
                                            : run.dut.paper.stepper_inst.row[i].slope_inst.second_start;
            wire begins  = run.dut.paper.stepper_inst.row[i].slope_inst.kout_inst.begins;
            wire squared = run.dut.paper.stepper_inst.row[i].slope_inst.kout_inst.radicand_complete;
            wire rooted  = run.dut.paper.stepper_inst.row[i].slope_inst.kout_inst.root_done;
            reg  newer_on = 1'b0, older_on = 1'b0, squares_on = 1'b0, root_on = 1'b0, quotient_on = 1'b0;
            always @(posedge run.clk) begin
                newer_on    <= newer || (newer_on && !run.dut.paper.stepper_inst.row[i].slope_inst.a_now);
                older_on    <= older || (older_on && !run.dut.paper.stepper_inst.row[i].slope_inst.b_done);
                squares_on  <= begins || (squares_on && !squared);
                root_on     <= squared || (root_on && !rooted);
                quotient_on <= rooted || (quotient_on && !run.dut.paper.stepper_inst.row[i].slope_inst.kout_done);
                if (watch && (newer || newer_on)) $fdisplay(run.result, "busy %0d newer %0d", run.clocks, i);
                if (watch && (older || older_on)) $fdisplay(run.result, "busy %0d older %0d", run.clocks, i);
                if (watch && (begins || squares_on)) $fdisplay(run.result, "busy %0d squares %0d", run.clocks, i);
                if (watch && root_on) $fdisplay(run.result, "busy %0d root %0d", run.clocks, i);
                if (watch && quotient_on) $fdisplay(run.result, "busy %0d quotient %0d", run.clocks, i);
            end
        end
    end endgenerate
endmodule

`default_nettype wire
