// SPDX-License-Identifier: MIT
/*
 * The program of feed_override.v: the rule of nurbs_lab.motion.override, an instruction a line. Names are those of
 * that rule: V, W of this period, V_OLD, W_OLD of the one before, V_NEXT = V+, CLOSED = q, RAISED = o (V+ - V), rates
 * r and o.
 *
 * Format    code: what to do, and with which number or where to go on.
 * Rounding  none.
 * Latency   1 cycle, as the output of a memory block: code follows at when read is high, and holds otherwise.
 * Flags     none.
 *
 * The accumulator is loaded, added to, stored. LOADS, ADDS, SUBS take the number with the sign s. MULTIPLY: the number
 * times the factor. DIVIDE: the accumulator by the number, into the factor. WRAP: takes the whole period off a time.
 * AT_... chooses the feed's period that HERE, NEXT and LAST speak of.
 */
`default_nettype none

module feed_override_program (
    input  wire        clk,
    input  wire        read,
    input  wire [7:0]  at,
    output reg  [15:0] code
);
    // Instructions.
    localparam [7:0] LOAD = 8'h04, LOADS = 8'h05, ADD = 8'h00, ADDS = 8'h01, SUB = 8'h02, SUBS = 8'h03, STORE = 8'h10,
                     DOUBLE = 8'h20, HALVE = 8'h21, FACTOR = 8'h30, GOAL = 8'h31, FRACTION = 8'h40, MULTIPLY = 8'h50,
                     DIVIDE = 8'h60, WRAP = 8'h70, CALL = 8'h90, SIGN = 8'hB0, AT_NOW = 8'hB1, AT_BEFORE = 8'hB2,
                     AT_AHEAD = 8'hB3, ADVANCE = 8'hB4, RATED = 8'hB5, LEAVE = 8'hB6,
                     EMIT = 8'hC0, EMIT_LAST = 8'hC1, HALT = 8'hC2,
                     JUMP_ALWAYS = 8'h80, JUMP_NEGATIVE = 8'h81, JUMP_POSITIVE = 8'h82, JUMP_ZERO = 8'h83,
                     JUMP_STEADY = 8'h84, JUMP_LEFT = 8'h85, JUMP_IDLED = 8'h86, JUMP_STAYS = 8'h87,
                     JUMP_LAST_ONE = 8'h88, JUMP_KNOWN = 8'h89, RETURN_ALWAYS = 8'hA0;
    // Numbers: of the feed's periods here, next and last, and others.
    localparam [7:0] NONE = 8'd0, HERE = 8'd0, NEXT = 8'd1, LAST = 8'd7, ALPHA = 8'd8, BETA = 8'd9, PRIOR = 8'd10,
                     ONE = 8'd11, TAU = 8'd12, RATE = 8'd13, GIVEN = 8'd14, V = 8'd15, V_OLD = 8'd16, V_NEXT = 8'd17,
                     W = 8'd18, W_OLD = 8'd19, WANTED = 8'd20, RAISED = 8'd21, CLOSED = 8'd22, GAP = 8'd23,
                     MOST = 8'd24, REACH = 8'd25, X = 8'd26, START = 8'd27, GAINED = 8'd28, FOUR = 8'd29, LEFT = 8'd30,
                     LEVEL = 8'd31, TOTAL = 8'd29;
    // Places in the program.
    localparam [7:0] TO_END = 8'd14, TO_REST = 8'd27, TO_BEFORE = 8'd34, TO_GO_ON = 8'd41, TO_KNOWN = 8'd46,
                     TO_SLOW_ENOUGH = 8'd86, TO_NEAR = 8'd111, TO_REACH = 8'd121, TO_RISE = 8'd126, TO_LEAST = 8'd143,
                     TO_SOFTEST = 8'd147, TO_FOUND = 8'd154, TO_CUT = 8'd155, TO_CHANGE = 8'd161, TO_STOP = 8'd179,
                     TO_WHOLE = 8'd182, TO_AT_GOAL = 8'd184, TO_MOVE = 8'd186, TO_PART = 8'd205, TO_SPEED = 8'd218,
                     TO_FALLS = 8'd232, TO_WITHIN = 8'd238;

    always @(posedge clk) if (read) case (at)
        // Before the first period.
        8'd0:    code <= {LOAD, PRIOR};                     // INIT: the period before the first
        8'd1:    code <= {STORE, LAST};
        8'd2:    code <= {GOAL, NONE};                      // which is 1 now
        8'd3:    code <= {FRACTION, NONE};
        8'd4:    code <= {STORE, ONE};
        8'd5:    code <= {STORE, RATE};
        8'd6:    code <= {SUB, RATE};
        8'd7:    code <= {STORE, TAU};
        8'd8:    code <= {STORE, GIVEN};
        8'd9:    code <= {HALT, NONE};

        // A period at rate 1, as planned.
        8'd10:   code <= {LOAD, HERE};                      // FAST
        8'd11:   code <= {ADVANCE, NONE};
        8'd12:   code <= {JUMP_LAST_ONE, TO_END};
        8'd13:   code <= {EMIT, NONE};
        8'd14:   code <= {EMIT_LAST, NONE};                 // END

        // A period whose rate is another, or changes.
        8'd15:   code <= {LOAD, TAU};                       // SLOW: V, the speed now
        8'd16:   code <= {FACTOR, NONE};
        8'd17:   code <= {CALL, TO_SPEED};
        8'd18:   code <= {STORE, V};
        8'd19:   code <= {JUMP_STEADY, TO_GO_ON};
        8'd20:   code <= {JUMP_LEFT, TO_BEFORE};
        8'd21:   code <= {JUMP_IDLED, TO_REST};
        8'd22:   code <= {LOAD, PRIOR};                     // the first period: from rest the rate is the command
        8'd23:   code <= {JUMP_POSITIVE, TO_REST};
        8'd24:   code <= {GOAL, NONE};
        8'd25:   code <= {FRACTION, NONE};
        8'd26:   code <= {STORE, RATE};
        8'd27:   code <= {LOAD, V};                         // REST: V- = V, W- = r V
        8'd28:   code <= {STORE, V_OLD};
        8'd29:   code <= {LOAD, RATE};
        8'd30:   code <= {FACTOR, NONE};
        8'd31:   code <= {MULTIPLY, V};
        8'd32:   code <= {STORE, W_OLD};
        8'd33:   code <= {JUMP_ALWAYS, TO_GO_ON};
        // BEFORE: V- = W-, at the start of the feed's period before
        8'd34:   code <= {AT_BEFORE, NONE};
        8'd35:   code <= {LOAD, TAU};
        8'd36:   code <= {FACTOR, NONE};
        8'd37:   code <= {CALL, TO_SPEED};
        8'd38:   code <= {STORE, V_OLD};
        8'd39:   code <= {STORE, W_OLD};
        8'd40:   code <= {AT_NOW, NONE};
        8'd41:   code <= {LOAD, LEFT};                      // GO_ON: W, as the period before left it, or r V
        8'd42:   code <= {JUMP_KNOWN, TO_KNOWN};
        8'd43:   code <= {LOAD, RATE};
        8'd44:   code <= {FACTOR, NONE};
        8'd45:   code <= {MULTIPLY, V};
        8'd46:   code <= {STORE, W};                        // KNOWN
        8'd47:   code <= {LOAD, TAU};                       // V+, the speed at tau + r
        8'd48:   code <= {ADD, RATE};
        8'd49:   code <= {WRAP, NONE};
        8'd50:   code <= {FACTOR, NONE};
        8'd51:   code <= {AT_AHEAD, NONE};
        8'd52:   code <= {CALL, TO_SPEED};
        8'd53:   code <= {STORE, V_NEXT};
        8'd54:   code <= {AT_NOW, NONE};
        8'd55:   code <= {GOAL, NONE};
        8'd56:   code <= {MULTIPLY, V};                     // o V
        8'd57:   code <= {STORE, WANTED};
        8'd58:   code <= {MULTIPLY, V_NEXT};                // o (V+ - V)
        8'd59:   code <= {SUB, WANTED};
        8'd60:   code <= {STORE, RAISED};
        8'd61:   code <= {MULTIPLY, V_OLD};                 // W - W- - o (V - V-)
        8'd62:   code <= {SUB, WANTED};
        8'd63:   code <= {ADD, W};
        8'd64:   code <= {SUB, W_OLD};
        8'd65:   code <= {STORE, CLOSED};
        8'd66:   code <= {FRACTION, NONE};
        8'd67:   code <= {SUB, RATE};
        8'd68:   code <= {SIGN, NONE};                      // s
        8'd69:   code <= {LOADS, CLOSED};                   // q
        8'd70:   code <= {STORE, CLOSED};
        8'd71:   code <= {LOAD, WANTED};
        8'd72:   code <= {SUB, W};
        8'd73:   code <= {STORE, GAP};
        8'd74:   code <= {LOADS, GAP};                      // g
        8'd75:   code <= {STORE, GAP};
        8'd76:   code <= {LOAD, ALPHA};
        8'd77:   code <= {SUBS, RAISED};
        8'd78:   code <= {STORE, MOST};
        8'd79:   code <= {LOAD, CLOSED};                    // x = min(q + beta, g)
        8'd80:   code <= {ADD, BETA};
        8'd81:   code <= {STORE, X};
        8'd82:   code <= {SUB, GAP};
        8'd83:   code <= {JUMP_NEGATIVE, TO_SLOW_ENOUGH};
        8'd84:   code <= {LOAD, GAP};
        8'd85:   code <= {STORE, X};
        8'd86:   code <= {LOAD, BETA};                      // is x below 22 beta?
        8'd87:   code <= {DOUBLE, NONE};
        8'd88:   code <= {DOUBLE, NONE};
        8'd89:   code <= {ADD, BETA};
        8'd90:   code <= {DOUBLE, NONE};
        8'd91:   code <= {ADD, BETA};
        8'd92:   code <= {STORE, LEVEL};
        8'd93:   code <= {LOAD, X};
        8'd94:   code <= {HALVE, NONE};
        8'd95:   code <= {SUB, LEVEL};
        8'd96:   code <= {JUMP_NEGATIVE, TO_NEAR};
        8'd97:   code <= {LOAD, BETA};                      // no: (g - 2 beta) beta / x + (x - beta) / 2
        8'd98:   code <= {DIVIDE, X};
        8'd99:   code <= {LOAD, GAP};
        8'd100:  code <= {SUB, BETA};
        8'd101:  code <= {SUB, BETA};
        8'd102:  code <= {STORE, TOTAL};
        8'd103:  code <= {MULTIPLY, TOTAL};
        8'd104:  code <= {STORE, TOTAL};
        8'd105:  code <= {LOAD, X};
        8'd106:  code <= {SUB, BETA};
        8'd107:  code <= {HALVE, NONE};
        8'd108:  code <= {ADD, TOTAL};
        8'd109:  code <= {STORE, TOTAL};
        8'd110:  code <= {JUMP_ALWAYS, TO_LEAST};
        8'd111:  code <= {LOAD, X};                         // NEAR: min(g, 12 x)
        8'd112:  code <= {DOUBLE, NONE};
        8'd113:  code <= {ADD, X};
        8'd114:  code <= {DOUBLE, NONE};
        8'd115:  code <= {DOUBLE, NONE};
        8'd116:  code <= {STORE, REACH};
        8'd117:  code <= {SUB, GAP};
        8'd118:  code <= {JUMP_NEGATIVE, TO_REACH};
        8'd119:  code <= {LOAD, GAP};
        8'd120:  code <= {STORE, REACH};
        8'd121:  code <= {LOAD, BETA};                      // REACH: the first of beta, 3 beta, 6 beta, ... as large
        8'd122:  code <= {STORE, LEVEL};
        8'd123:  code <= {STORE, TOTAL};
        8'd124:  code <= {SUB, REACH};
        8'd125:  code <= {JUMP_POSITIVE, TO_SOFTEST};
        8'd126:  code <= {LOAD, LEVEL};                     // RISE
        8'd127:  code <= {ADD, BETA};
        8'd128:  code <= {STORE, LEVEL};
        8'd129:  code <= {ADD, TOTAL};
        8'd130:  code <= {STORE, TOTAL};
        8'd131:  code <= {SUB, REACH};
        8'd132:  code <= {JUMP_NEGATIVE, TO_RISE};
        8'd133:  code <= {LOAD, BETA};                      // n beta - (n (n + 1) beta / 2 - g) / n
        8'd134:  code <= {DIVIDE, LEVEL};
        8'd135:  code <= {LOAD, TOTAL};
        8'd136:  code <= {SUB, GAP};
        8'd137:  code <= {STORE, TOTAL};
        8'd138:  code <= {MULTIPLY, TOTAL};
        8'd139:  code <= {STORE, TOTAL};
        8'd140:  code <= {LOAD, LEVEL};
        8'd141:  code <= {SUB, TOTAL};
        8'd142:  code <= {STORE, TOTAL};
        8'd143:  code <= {SUB, X};                          // LEAST: x is at most that
        8'd144:  code <= {JUMP_POSITIVE, TO_SOFTEST};
        8'd145:  code <= {LOAD, TOTAL};
        8'd146:  code <= {STORE, X};
        8'd147:  code <= {LOAD, CLOSED};                    // SOFTEST: x is at least q - beta
        8'd148:  code <= {SUB, BETA};
        8'd149:  code <= {STORE, TOTAL};
        8'd150:  code <= {SUB, X};
        8'd151:  code <= {JUMP_NEGATIVE, TO_FOUND};
        8'd152:  code <= {LOAD, TOTAL};
        8'd153:  code <= {JUMP_ALWAYS, TO_CUT};
        8'd154:  code <= {LOAD, X};                         // FOUND
        8'd155:  code <= {STORE, X};                        // CUT: x = min(x, most)
        8'd156:  code <= {LOAD, MOST};
        8'd157:  code <= {SUB, X};
        8'd158:  code <= {JUMP_POSITIVE, TO_CHANGE};
        8'd159:  code <= {LOAD, MOST};
        8'd160:  code <= {STORE, X};
        8'd161:  code <= {LOAD, X};                         // CHANGE: r'
        8'd162:  code <= {SUB, GAP};
        8'd163:  code <= {JUMP_ZERO, TO_AT_GOAL};
        8'd164:  code <= {LOAD, V_NEXT};
        8'd165:  code <= {JUMP_ZERO, TO_AT_GOAL};
        8'd166:  code <= {LOAD, W};
        8'd167:  code <= {ADD, RAISED};
        8'd168:  code <= {ADDS, X};
        8'd169:  code <= {STORE, X};
        8'd170:  code <= {JUMP_NEGATIVE, TO_STOP};
        8'd171:  code <= {SUB, V_NEXT};
        8'd172:  code <= {JUMP_POSITIVE, TO_WHOLE};
        8'd173:  code <= {LOAD, X};
        8'd174:  code <= {STORE, LEFT};
        8'd175:  code <= {DIVIDE, V_NEXT};
        8'd176:  code <= {LEAVE, NONE};
        8'd177:  code <= {FRACTION, NONE};
        8'd178:  code <= {JUMP_ALWAYS, TO_MOVE};
        8'd179:  code <= {LOAD, V};                         // STOP
        8'd180:  code <= {SUB, V};
        8'd181:  code <= {JUMP_ALWAYS, TO_MOVE};
        8'd182:  code <= {LOAD, ONE};                       // WHOLE
        8'd183:  code <= {JUMP_ALWAYS, TO_MOVE};
        8'd184:  code <= {GOAL, NONE};                      // AT_GOAL
        8'd185:  code <= {FRACTION, NONE};
        8'd186:  code <= {STORE, X};                        // MOVE: tau' = tau + (r + r') / 2
        8'd187:  code <= {RATED, NONE};
        8'd188:  code <= {ADD, RATE};
        8'd189:  code <= {HALVE, NONE};
        8'd190:  code <= {ADD, TAU};
        8'd191:  code <= {WRAP, NONE};
        8'd192:  code <= {STORE, TAU};
        8'd193:  code <= {LOAD, X};
        8'd194:  code <= {STORE, RATE};
        8'd195:  code <= {LOAD, V};
        8'd196:  code <= {STORE, V_OLD};
        8'd197:  code <= {LOAD, W};
        8'd198:  code <= {STORE, W_OLD};
        8'd199:  code <= {SUB, W};                          // what the path is behind the start of the feed's period
        8'd200:  code <= {SUB, GIVEN};
        8'd201:  code <= {JUMP_STAYS, TO_PART};
        8'd202:  code <= {ADD, HERE};
        8'd203:  code <= {ADVANCE, NONE};
        8'd204:  code <= {JUMP_LAST_ONE, TO_END};
        8'd205:  code <= {STORE, X};                        // PART
        8'd206:  code <= {LOAD, TAU};
        8'd207:  code <= {FACTOR, NONE};
        8'd208:  code <= {CALL, TO_SPEED};
        8'd209:  code <= {LOAD, START};
        8'd210:  code <= {ADD, GAINED};
        8'd211:  code <= {STORE, GAINED};
        8'd212:  code <= {MULTIPLY, GAINED};
        8'd213:  code <= {HALVE, NONE};
        8'd214:  code <= {HALVE, NONE};
        8'd215:  code <= {STORE, GIVEN};
        8'd216:  code <= {ADD, X};
        8'd217:  code <= {EMIT, NONE};

        // Subroutine: the speed of the feed at the time in the factor, of the period at.
        8'd218:  code <= {LOAD, HERE};                      // SPEED: four times the distance
        8'd219:  code <= {DOUBLE, NONE};
        8'd220:  code <= {DOUBLE, NONE};
        8'd221:  code <= {STORE, FOUR};
        8'd222:  code <= {LOAD, NEXT};
        8'd223:  code <= {SUB, LAST};
        8'd224:  code <= {STORE, GAINED};
        8'd225:  code <= {JUMP_NEGATIVE, TO_FALLS};
        8'd226:  code <= {LOAD, FOUR};
        8'd227:  code <= {SUB, GAINED};
        8'd228:  code <= {JUMP_POSITIVE, TO_WITHIN};
        8'd229:  code <= {LOAD, FOUR};
        8'd230:  code <= {STORE, GAINED};
        8'd231:  code <= {JUMP_ALWAYS, TO_WITHIN};
        8'd232:  code <= {ADD, FOUR};                       // FALLS
        8'd233:  code <= {JUMP_POSITIVE, TO_WITHIN};
        8'd234:  code <= {LOAD, FOUR};
        8'd235:  code <= {SUB, FOUR};
        8'd236:  code <= {SUB, FOUR};
        8'd237:  code <= {STORE, GAINED};
        8'd238:  code <= {LOAD, FOUR};                      // WITHIN
        8'd239:  code <= {SUB, GAINED};
        8'd240:  code <= {STORE, START};
        8'd241:  code <= {MULTIPLY, GAINED};
        8'd242:  code <= {STORE, GAINED};
        8'd243:  code <= {DOUBLE, NONE};
        8'd244:  code <= {ADD, START};
        8'd245:  code <= {HALVE, NONE};
        8'd246:  code <= {HALVE, NONE};
        8'd247:  code <= {RETURN_ALWAYS, NONE};
        default:     code <= {HALT, NONE};
    endcase
endmodule

`default_nettype wire
