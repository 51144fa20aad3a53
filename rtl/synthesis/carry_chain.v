// SPDX-License-Identifier: MIT
// Adders and comparisons as carry chains, one logic element a bit, which synth_intel does not do by itself.

(* techmap_celltype = "$alu" *)
module carry_chain (A, B, CI, BI, X, Y, CO);
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    (* force_downto *) input [A_WIDTH-1:0] A;
    (* force_downto *) input [B_WIDTH-1:0] B;
    input CI, BI;
    (* force_downto *) output [Y_WIDTH-1:0] X, Y, CO;

    wire _TECHMAP_FAIL_ = Y_WIDTH < 3;

    (* force_downto *) wire [Y_WIDTH-1:0] a, b;
    \$pos #(.A_SIGNED(A_SIGNED), .A_WIDTH(A_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_a (.A(A), .Y(a));
    \$pos #(.A_SIGNED(B_SIGNED), .A_WIDTH(B_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_b (.A(B), .Y(b));

    wire [Y_WIDTH:0] carry;
    assign carry[0] = CI;
    genvar i;
    generate for (i = 0; i < Y_WIDTH; i = i + 1) begin : bit
        logic_element le (.a(a[i]), .b(b[i]), .subtract(BI), .cin(carry[i]), .sum(Y[i]), .cout(carry[i+1]));
    end endgenerate
    assign CO = carry[Y_WIDTH:1];
    assign X = a ^ b ^ {Y_WIDTH{BI}};
endmodule

(* techmap_celltype = "$add $sub" *)
module adder (A, B, Y);
    parameter _TECHMAP_CELLTYPE_ = "";
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    (* force_downto *) input [A_WIDTH-1:0] A;
    (* force_downto *) input [B_WIDTH-1:0] B;
    (* force_downto *) output [Y_WIDTH-1:0] Y;
    localparam SUBTRACT = _TECHMAP_CELLTYPE_ == "$sub";
    wire [Y_WIDTH-1:0] x, co;
    \$alu #(.A_SIGNED(A_SIGNED), .B_SIGNED(B_SIGNED), .A_WIDTH(A_WIDTH), .B_WIDTH(B_WIDTH), .Y_WIDTH(Y_WIDTH))
        alu (.A(A), .B(B), .CI(SUBTRACT), .BI(SUBTRACT), .X(x), .CO(co), .Y(Y));
endmodule
