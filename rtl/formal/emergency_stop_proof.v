// SPDX-License-Identifier: MIT
/*
 * emergency_stop, for any orders and any stop; written from its header, and told from its ports alone, in runs of any
 * length. Its asynchronous inputs are sampled here as often as the clock: what happens between two edges is left to
 * the bench.
 */
module emergency_stop_proof (input wire clk, input wire again, input wire stop, input wire on, input wire off);
    reg       started = 0, runs = 0, stopped_by = 1, on_before = 0;
    reg [1:0] calm = 0; // edges since stop was high
    wire      rst = !started || again;
    wire      enable, enabled, tripped, pressed;
    wire      accepted = on && !on_before && !stop && calm == 2;
    always @(posedge clk) begin
        started    <= 1;
        on_before  <= on;
        calm       <= stop ? 0 : calm == 2 ? 2 : calm + 1;
        runs       <= !stop && !rst && !off && (accepted || runs);
        stopped_by <= stop || (stopped_by && !rst && !accepted);
    end
    emergency_stop dut (
        .clk(clk), .rst(rst), .stop(stop), .on(on), .off(off), .enable(enable), .enabled(enabled), .tripped(tripped),
        .pressed(pressed)
    );
    initial assume (stop); // power comes with the contact open
    always @* begin
        if (rst) assert (!enable);
        if (stop) assert (!enable && !enabled && tripped && pressed);
        if (started) assert (enable == (runs && !stop && !rst) && enabled == (runs && !stop));
        if (started) assert (pressed == (stop || calm < 2));
        if (started) assert (tripped == (stop || stopped_by));
        if (started) assert (!(enable && tripped));
        cover (enable && calm == 2);
        cover (started && !enable && !tripped);
    end
endmodule
