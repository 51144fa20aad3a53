/*
 * Watches the load bus: a curve that cannot be right raises bad, and ready tells that a run has all it needs.
 *
 * What it knows: knots come in order, from 0 to 1, and do not decrease; weights are above 0 and at most 1; numbers fit
 * their words; the degree is 1 to 5, with more points than that and no more than fit; weights only where cu divides;
 * spaces and indices exist.
 *
 * Format    as on the load bus of stepper.v, with the data 64 bits wide in two's complement.
 * Rounding  none.
 * Latency   1 clock.
 * Flags     bad: sticky until clear, which also forgets what was loaded.
 */
`default_nettype none

module load_guard #(
    // As in cu.v.
    parameter WORD       = 35,
    parameter MAX_POINTS = 64,
    parameter RATIONAL   = 1
) (
    input  wire        clk,
    input  wire        rst,
    input  wire        clear,
    input  wire        load,
    input  wire [2:0]  space,
    input  wire [9:0]  index,
    input  wire [63:0] data,
    output reg         bad,
    output wire        ready
);
    generate if (WORD % 2 == 0 || WORD < 17 || WORD > 35) begin : check_word
        load_guard_WORD_must_be_odd_and_from_17_to_35 stop ();
    end
    if (MAX_POINTS < 2 || MAX_POINTS > 64) begin : check_points
        load_guard_MAX_POINTS_must_be_from_2_to_64 stop ();
    end endgenerate

    localparam [63:0] ONE = 64'd1 << (WORD - 2);
    localparam [63:0] SPEEDS = (ONE << 17) - 64'd32768; // from here on vt would round beyond its word

    reg [63:0] knot_before;
    reg [3:0]  seen; // shape, first u, last u, number of periods

    wire unit_fits   = data <= ONE;
    wire signed_fits = data[63:WORD-1] == {65-WORD{data[WORD-1]}};
    wire [5:0] low   = index[5:0];
    reg  wrong;
    always @* case (space)
        3'd0: wrong = index > MAX_POINTS + 5 || !unit_fits || (index != 10'd0 && data < knot_before);
        3'd1: wrong = index[9:7] > 3'd4 || index[6:0] > MAX_POINTS + 4 || data >= ONE << 5;
        3'd2: wrong = index[9:2] > MAX_POINTS - 1
                    || (index[1:0] == 2'd3 ? data == 64'd0 || !unit_fits : !signed_fits);
        3'd3: wrong = index > 10'd2 || (index != 10'd0 ? !unit_fits
                    : data >= (RATIONAL != 0 ? 64'd2048 : 64'd1024) || data[2:0] == 3'd0 || data[2:0] > 3'd5
                      || data[9:3] > MAX_POINTS - 1 || data[9:3] < {4'd0, data[2:0]});
        3'd4: wrong = index > 10'd6 || data >= (index == 10'd3 ? 64'd1 << 32 : SPEEDS);
        3'd5: wrong = index > 10'd3 || (index == 10'd0 ? data == 64'd0 || data >= 64'd1 << 32
                    : index == 10'd1 ? data > 64'd7 : data == 64'd0 || data >= ONE << 1);
        default: wrong = 1'b1;
    endcase

    assign ready = &seen && !bad;

    always @(posedge clk) begin
        if (load) begin
            if (wrong) bad <= 1'b1;
            if (space == 3'd0) knot_before <= data;
            if (space == 3'd3 && low == 6'd0) seen[0] <= 1'b1;
            if (space == 3'd3 && low == 6'd1) seen[1] <= 1'b1;
            if (space == 3'd3 && low == 6'd2) seen[2] <= 1'b1;
            if (space == 3'd5 && low == 6'd0) seen[3] <= 1'b1;
        end
        if (rst || clear) begin
            bad  <= 1'b0;
            seen <= 4'd0;
        end
    end
endmodule

`default_nettype wire
