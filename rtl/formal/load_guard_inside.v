// SPDX-License-Identifier: MIT
    // Read inside load_guard, by its proof; written from its header, in numbers instead of bits. What is right is
    // said here anew; bad is raised by all that is not, by nothing else, and stays; a run is ready only after a right
    // close, with all that it needs since clear (EXACT) or since the close before.
    localparam signed [63:0] UNIT = 64'sd1 <<< (WORD - 2), TOP = 64'sd1 <<< (WORD - 1);
    localparam signed [63:0] WIDE = 64'sd1 <<< (WORD + 26), INVERSE = 64'sd1 <<< (WORD + 3);
    wire signed [63:0] number = data;
    wire               part   = number >= 0 && number <= UNIT;  // from 0 to 1
    wire               place  = number >= -TOP && number < TOP; // a coordinate
    reg [WORD-2:0]     knot_latest = 0;                         // of this load; its lower bits: of a right one all
    wire [2:0]         deg = number % 8;
    wire [6:0]         most = number / 8 % 128;
    reg                right;                                   // but for the order of knots, and a close
    always @* begin
        right = 0;
        if (EXACT != 0) right = space != 4 && space != 6 && !(space == 7 && index > 1);
        else if (space == 0) right = index < MAX_POINTS + 6 && part;
        else if (space == 1)
            right = index / 128 < 5 && index % 128 < MAX_POINTS + 5 && number >= 0 && number < INVERSE;
        else if (space == 2 && index % 4 == 3)
            right = index / 4 < MAX_POINTS && number <= UNIT && number >= UNIT / 1024;
        else if (space == 2) right = index / 4 < MAX_POINTS && place;
        else if (space == 3 && index == 0)
            right = number >= 0 && number < 2048 && deg >= 1 && deg <= 5 && most >= deg && most < MAX_POINTS
                    && (number < 1024 || RATIONAL != 0);
        else if (space == 3) right = index < 3 && part;
        else if (space == 4 && index % 4 == 0) right = number >= 0 && number < 64'sd4294967296;
        else if (space == 4) right = number >= -WIDE && number < WIDE;
        else if (space == 5) case (index)
            0:          right = number > 0 && number < 64'sd4294967296;
            2, 3:       right = number > 0 && number < TOP;
            4:          right = number > 0 && number < 2 * TOP;
            1, 5, 6, 7: right = 0;
            default:    right = index < 14 && place;
        endcase
        else if (space == 7) right = index == 0;
    end
    reg         open = 1, good = 1, began = 0; // nothing closed since; no mistake since clear; a reset was
    reg [15:0]  writes = 0;                    // since clear or the latest close
    reg [31:0]  sum = 0;
    // Knots, and points (DIM coordinates and a weight), that have come in their turn since the latest index 0.
    reg  [7:0] knots = 0, points = 0;
    reg  [1:0] part_now = 0;                                    // of the point that is under way: what comes next
    wire       in_turn = space == 0 ? open && index == knots : space != 2 || (open && index == 4 * points + part_now);
    wire       ordered = EXACT != 0 || index == 0
                         || (in_turn && (space != 0 || number >= $signed({1'b0, knot_latest})));
    wire [31:0] sum_before = open ? sum : 0;
    wire        closing = space == 7;
    wire        matches = open && writes != 0 && data == {16'd0, writes, sum};
    // Which of 64 places in spaces 3, 4 and 5 have been written.
    reg  [63:0] here = 0;
    wire [63:0] this = space >= 3 && space <= 5 && index < 16 ? 64'd1 << {space[1:0], index[3:0]} : 64'd0;
    wire [63:0] have = !open && EXACT == 0 ? 64'd0 : here;
    wire [15:0] of_3 = here[63:48], of_4 = here[15:0], of_5 = here[31:16];
    wire        whole = of_3[0] && of_3[1] && of_3[2] && of_5[4] && &of_5[11:8] && (DIM == 2 || &of_5[13:12])
                        && (EXACT != 0 ? of_5[5] && of_5[6] && of_5[7] && of_5[14] && (DIM == 2 || of_3[3])
                                       : of_5[0] && of_4[0]);
    reg  [8:0]  told = 0; // last point and degree
    wire [7:0]  end_of = told / 8;
    wire        every = EXACT != 0 || (points == end_of + 1 && part_now == 0 && knots == end_of + told % 8 + 2);
    always @(posedge clk) begin
        began <= 1;
        if (load) begin
            if (!open) {knots, points, part_now} <= 0;
            if (space == 0) knots <= index + 1;
            if (space == 2) begin
                points   <= index / 4 + (index % 4 == 3);
                part_now <= index % 4 == 3 ? 0 : index % 4 == DIM - 1 ? 3 : index % 4 + 1;
            end
            if (space == 3 && index == 0) told <= data;
            good   <= good && right && ordered && (!closing || matches);
            open   <= !closing;
            writes <= open ? writes + 1 : 1;
            sum    <= {sum_before[30:0], sum_before[31]} ^ data[31:0] ^ data[63:32] ^ {space, index};
            here   <= have | this;
            if (space == 0) knot_latest <= data[WORD-2:0];
        end
        if (rst || clear) begin
            {open, good} <= 2'b11;
            {writes, sum, here, knot_latest, knots, points, part_now} <= 0;
        end
    end
    wire keeps = began && !rst;
    always @* if (keeps) begin
        assert (bad == !good);
        assert (ready == (!open && good && whole && every));
        assert (closes == (load && closing && right && matches && good));
        // What makes these inductive.
        assert (closed == !open && count == writes && checksum == sum && knot_before == knot_latest);
        if (EXACT == 0 && good)
            assert (next_knot == knots && knots < MAX_POINTS + 7 && next_place == 4 * points + part_now
                    && (!here[48] || shape == told));
        assert (seen == {of_5[13:8], of_5[4], of_3[0], of_3[1], of_3[2], EXACT != 0 ? of_5[5] : of_5[0],
                         EXACT != 0 ? of_5[6] : of_4[0]});
        assert (EXACT == 0 || and_seen == {of_5[7], of_5[14], of_3[3]});
        cover (ready && writes == (EXACT != 0 ? 13 : 20));
        cover (!good && writes == 3);
    end
