// SPDX-License-Identifier: MIT
/* ui_out: the sum wide enough to be exact, rounded once, held between the ends. */
module ui_out_proof #(
    parameter WORD  = 35,
    parameter ADAMS = 1
) (
    input wire        [WORD-2:0] u,
    input wire signed [WORD-1:0] k_0,
    input wire signed [WORD-1:0] k_1,
    input wire signed [WORD-1:0] k_2,
    input wire signed [WORD-1:0] k_3
);
    wire [WORD-2:0] u_next;
    ui_out #(.WORD(WORD), .ADAMS(ADAMS)) dut (.u(u), .k_0(k_0), .k_1(k_1), .k_2(k_2), .k_3(k_3), .u_next(u_next));

    localparam signed [WORD+10:0] LARGEST = (1 << (WORD - 1)) - 1;
    wire signed [WORD+10:0] a = k_0, b = k_1, c = k_2, d = k_3;
    wire signed [WORD+10:0] start = {1'b0, u};
    wire signed [WORD+10:0] total = ADAMS != 0 ? 55 * a - 59 * b + 37 * c - 9 * d
                                          : 4 * (a + 2 * b + 2 * c + d);
    wire signed [WORD+10:0] exact = start + ((total + 128) >>> 8);
    wire signed [WORD+10:0] held  = exact < 0 ? 0 : exact > LARGEST ? LARGEST : exact;
    always @* assert (u_next == held[WORD-2:0]);
    always @* begin
        cover (exact < 0);
        cover (exact > LARGEST);
        cover (held != 0 && held != LARGEST && exact != start);
    end
endmodule
