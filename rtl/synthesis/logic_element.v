// SPDX-License-Identifier: MIT
// A logic element of Cyclone II in arithmetic mode: one bit of a sum, with its own carry.
(* blackbox *)
module logic_element (
    input  wire a,
    input  wire b,
    input  wire subtract,
    input  wire cin,
    output wire sum,
    output wire cout
);
endmodule
