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

    localparam signed [63:0] LARGEST = (64'sd1 << (WORD - 1)) - 64'sd1;
    wire signed [63:0] a = k_0, b = k_1, c = k_2, d = k_3;
    wire signed [63:0] start = {1'b0, u};
    wire signed [63:0] total = ADAMS != 0 ? 64'sd55 * a - 64'sd59 * b + 64'sd37 * c - 64'sd9 * d
                                          : 64'sd4 * (a + 64'sd2 * b + 64'sd2 * c + d);
    wire signed [63:0] exact = start + ((total + 64'sd128) >>> 8);
    wire signed [63:0] held  = exact < 64'sd0 ? 64'sd0 : exact > LARGEST ? LARGEST : exact;
    always @* assert (u_next == held[WORD-2:0]);
endmodule
