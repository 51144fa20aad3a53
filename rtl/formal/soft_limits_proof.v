// SPDX-License-Identifier: MIT
/*
 * soft_limits, for any numbers, loaded and compared in any order; written from its header, in whole numbers, and told
 * from its ports alone: the flags say what held two cycles before, if no limit was loaded since. For twelve cycles,
 * which suffice to load all limits in any order and to compare.
 */
module soft_limits_proof (
    input wire              clk,
    input wire              load,
    input wire [3:0]        load_index,
    input wire signed [4:0] load_data,
    input wire [2:0]        bound,
    input wire signed [4:0] x, y, x_before, y_before
);
    wire too_far, beyond, bound_beyond;
    soft_limits #(.WORD(5), .DIM(2)) dut (
        .clk(clk), .load(load), .load_index(load_index), .load_data(load_data), .bound(bound),
        .bound_beyond(bound_beyond),
        .point({y, x}), .point_before({y_before, x_before}), .too_far(too_far), .beyond(beyond)
    );
    integer largest, low_x, high_x, low_y, high_y, move_x, move_y;
    reg [4:0]  loaded = 0;
    reg [1:0]  calm = 0; // cycles without a load, up to 3
    reg [1:0]  far_was, beyond_was;
    always @* begin
        move_x = x - x_before;
        move_y = y - y_before;
    end
    wire far_now = move_x > largest || -move_x > largest || move_y > largest || -move_y > largest;
    wire beyond_now = x < low_x || x > high_x || y < low_y || y > high_y;
    always @(posedge clk) begin
        calm       <= load ? 0 : calm == 3 ? 3 : calm + 1;
        far_was    <= {far_was[0], far_now};
        beyond_was <= {beyond_was[0], beyond_now};
        if (load) case (load_index)
            4:  {loaded[0], largest} <= {1'b1, 27'd0, load_data};
            8:  begin low_x <= load_data; loaded[1] <= 1; end
            9:  begin high_x <= load_data; loaded[2] <= 1; end
            10: begin low_y <= load_data; loaded[3] <= 1; end
            11: begin high_y <= load_data; loaded[4] <= 1; end
        endcase
    end
    always @* if (&loaded) begin
        if (calm == 3) assert (too_far == far_was[1] && beyond == beyond_was[1]);
        if (bound < 4) assert (bound_beyond == (bound[0] ? load_data > (bound[1] ? high_y : high_x)
                                                         : load_data < (bound[1] ? low_y : low_x)));
        else if (bound >= 6) assert (bound_beyond == ({27'd0, load_data[4:0]} > largest));
        else assert (!bound_beyond);
        cover (calm == 3 && too_far && !beyond);
        cover (calm == 3 && !too_far && beyond);
    end
endmodule
