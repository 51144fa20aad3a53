// SPDX-License-Identifier: MIT
/* watchdog, for any host: what watchdog_inside.v says, in runs of any length. */
module watchdog_proof (input wire clk, input wire again, input wire armed, input wire fed,
                       input wire forget);
    reg started = 0;
    always @(posedge clk) started <= 1;
    watchdog #(.CYCLES(7)) dut (.clk(clk), .rst(!started || again), .armed(armed), .fed(fed), .forget(forget));
endmodule
