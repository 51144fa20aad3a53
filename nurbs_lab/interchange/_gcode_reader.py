"""Reading the programs of machine tools: one grammar, one table of commands and one modal state.

The state is that of RS274/NGC, with the words of Fanuc, Siemens, Heidenhain and printers. A command takes its
own words out of a block, so that what is left can only belong to the move. What moves in coordinates of the
program do not show is left out and named once; what would change them is refused by its line and word.
"""

import math
import re
import warnings
from array import array
from collections import Counter, defaultdict

import numpy as np

from nurbs_lab.interchange import _gcode_table as table
from nurbs_lab.interchange import _gcode_words as spelling
from nurbs_lab.interchange._gcode_commands import OTHER_AXES, PLACED, POLAR, Commands
from nurbs_lab.interchange._gcode_flow import Flow
from nurbs_lab.interchange._gcode_shapes import AXES, WORDS, shown_words, within
from nurbs_lab.interchange._gcode_table import LETTERED
from nurbs_lab.interchange._gcode_words import lines_of, shown, words_of
from nurbs_lab.interchange._moves import CUT, NO_FEED, RAPID, MoveTable, arc_curve
from nurbs_lab.machining.program import Program
from nurbs_lab.mesh.formats.shape import as_utf8

SMALL_MM = 1000.0  # beyond it, numbers without a point are asked for their unit
UNSAID = "from a place that the program does not say, which is taken as 0"
UNIT_CODES = {code for code, (kind, *_) in table.G_WORDS.items() if kind == "unit"}
MARKS, TOOLS = {*"MN", *LETTERED}, set("TDH")  # letters that are no words of a move
ARCS = ("",), ("R",), ("&", "^")  # words of C, CR and CP of Heidenhain
PLACES = tuple(enumerate(("Xxt", "Yyu", "Zzv")))  # by their words, by steps IX or X=IC(), and by X=AC()
MOTIONS = {0: "rapid", 10: "line", 20: "arc", 30: "arc"}  # alone in most blocks


def read(path):
    data = as_utf8(path.read_bytes())
    interpreter = _Interpreter(*lines_of(data))
    moves = interpreter.run(data)
    said = [*interpreter.said()]
    if np.abs(moves.ends).max(initial=0.0) >= SMALL_MM and not re.search(rb"[XYZxyz][-+]?\d*\.", data):
        said.append("its coordinates have no point; they are taken as mm, or inches, and not as thousandths")
    for one in said:
        warnings.warn(f"path: {path.name}: {one}", stacklevel=3)
    return Program(moves)


class _Interpreter(Commands):
    """The state of a controller, and the moves so far."""

    def __init__(self, lines, head):
        self.lines, self.flow, self.line, self.ended, self.begun = lines, Flow(lines), 0, False, False
        #: Of an axis: False until a block gives its position, None once the machine has moved it elsewhere.
        self.position, self.known = [0.0, 0.0, 0.0], [False] * 3
        self.motion, self.unit, self.absolute, self.absolute_arcs = None, 1.0, True, False
        self.before, self.resumed = None, False  # of a cycle: its motion before, which may go on after G80
        self.clockwise, self.pole, self.mirrored, self.polar = None, None, None, False
        self.feed, self.feed_length, self.feed_unit, self.per = NO_FEED, 1.0, 1 / 60, "minute"
        self.spindle, self.surface, self.diameter = 0.0, False, False
        self.cycle, self.hole, self.level, self.retract, self.saved = 0, {}, 0.0, None, {}
        self.by_steps = False  # whether the heights of the cycle are
        self.holes, self.due = None, False  # a cycle that blocks elsewhere call, and whether this one does
        self.alone = MOTIONS if head is None else (10,)  # their motions that need no other word
        self.heidenhain, self.unsaid = head is not None, not head  # whether the unit is not said
        text = "" if self.heidenhain else "\n".join(lines)
        self.printed = spelling.PRINTER.search(text)
        self.lathe = not (self.printed or spelling.MILL.search(text)) and spelling.LATHE.search(text)
        self.plane = 18 if self.lathe else 17
        self.orders = Counter()  # of a printer
        self.fanuc = bool(self.flow.programs) or any("G54.1" in line or "G154" in line for line in lines)
        if head == "INCH":
            self.unit = self.feed_length = 25.4
            self.feed_unit = 1 / 600  # Heidenhain counts tenths of an inch
        self.offsets, self.set_offsets = defaultdict(lambda: [0.0] * 3), set()
        self.system, self.systems, self.shift, self.last_shift = 0, {0: "G54"}, [0.0] * 3, [0.0] * 3
        self.spline, self.codes, self.owned = None, set(), set()  # the letters that M words have taken
        self.kinds, self.starts, self.ends, self.feeds, self.line_numbers = (array(c) for c in "bdddq")
        self.curves, self.left_out, self.open_start, self.loose = {}, Counter(), [], []

    def run(self, data):
        flow, lines = self.flow, self.lines
        try:
            while flow.place < len(lines) and not self.ended:
                self.line = flow.place + 1
                if not (flow.words or flow.programs) or not flow.follow():
                    self._line(lines[flow.place])
                    flow.place += 1
            self._close_spline()
        except (ValueError, RecursionError, OverflowError) as error:
            said = str(error) if isinstance(error, ValueError) else "a number or its nesting is too large"
            written = data.splitlines()[self.line - 1].decode("latin-1").upper()
            said = said.replace(shown(lines[self.line - 1]), shown(written))
            said += "" if ";" in said else "; mend it"
            raise ValueError(said if said.startswith("line ") else f"line {self.line}: {said}") from None
        if not any(line.strip("% /") for line in lines):
            raise ValueError("it holds no block")
        starts, ends = (np.array(points).reshape(-1, 3) for points in (self.starts, self.ends))
        return MoveTable(self.kinds, starts, ends, self.feeds, self.line_numbers, self.curves)

    def said(self):
        """What a person has to know about the moves."""
        subs = ", ".join(f"o<{name.lower()}>" for name in self.flow.subs)
        if not self.kinds:
            yield "it holds no move" + (f"; it defines the subroutines {subs}" if subs else "")
        if not (self.ended or self.printed) and (self.kinds or not subs):
            yield "it has no end of a program (M2, M30, % or END PGM); it may be cut off"
        if self.kinds and self.unsaid and not (self.printed or self.orders or self.codes & UNIT_CODES):
            said = "MM or INCH in BEGIN PGM" if self.heidenhain else "G20 or G21"
            yield f"it has no {said}; its numbers are taken as mm"
        if self.orders:
            said = f"orders of a printer in {self.orders.total()} of its blocks"
            yield f"{said} are left out, and so are their moves: {', '.join(self.orders)}"
        for (word, why), count in self.left_out.items():
            yield f"{word} in {count} of its blocks is {why}"
        if self.open_start:
            yield (
                f"{len(self.open_start)} of its cuts begin where the program does not say, the first in line "
                f"{self.open_start[0]}, and are left out; give their axes a position first"
            )
        turning = 970 in self.codes or self.codes.isdisjoint(10 * code for code in table.CYCLES)
        turned = self.lathe or 960 in self.codes or (990 in self.codes and turning)
        if turned and not self.codes >= {70, 950}:
            yield "G96, G99 or T0101 is of a lathe; without G7 and G95 X is a radius and F by the minute"
        if unread := [f"O{name}" for name, place in self.flow.programs.items() if place in self.flow.unread]:
            yield f"its programs {', '.join(unread)} are not called, and left out"
        if self.loose:
            apart, line = max(self.loose)
            yield f"{len(self.loose)} of its arcs miss their ends by up to {apart:.3g} mm, in line {line}"

    # --- one line

    def _line(self, text):
        if text[:1] == "/":
            text = text.lstrip("/0123456789").strip()
            self.left_out["/", "an optional block, which is read"] += 1
        if text[:1] == "%":
            self._end_of_tape(text)
            return
        of_printers = not self.heidenhain and (self.printed or text[:1] in ("M", "N") or text[1:2].isalpha())
        if not text or (of_printers and self._is_of_printers(text)):
            return
        before = self.motion
        line = "O" + text[1:] if text[0] == ":" else text
        words = words_of(line, self.flow.parameters, not self.heidenhain)
        block, codes, machine, lettered = self._sorted(text, words)
        if len(codes) == 1 and codes[0] in self.alone and not (machine or lettered):
            self._start(MOTIONS[codes[0]])
            self.clockwise = codes[0] == 20 if codes[0] >= 20 else self.clockwise
        elif codes or machine or lettered:
            self._commands(codes, machine, lettered, block)
        self._take_values(block)
        if block and self.heidenhain and not lettered:
            self._start("line")  # L may be left out
        if block:
            self.due |= bool(self.holes and self.holes[1]["P"] == 2)
            self._spline_row(block) if self.motion in WORDS else self._move(block)
        elif before not in WORDS and self.motion not in WORDS:
            for code in set(codes) - self.owned:  # a preamble may well name G0 or G1, or another motion
                alone = len(words) == 1 and MOTIONS.get(code) == self.motion
                if code == 90 or (table.G_WORDS[code][0] == "motion" and (alone or code > 10)):  # G9, too
                    self.left_out[f"G{code / 10:g}", "without an axis, and moves nothing"] += 1
        if self.due:
            self._bore_here()
        if self.per == "move":  # its F belongs to the moves of its own block
            self.feed = NO_FEED

    def _end_of_tape(self, text):
        """A line that begins with %, which stands before a program and behind it."""
        self.ended = self.begun or bool(self.kinds or self.codes) or self.motion is not None
        if self.ended and not self.begun:
            self.left_out["%", "behind the program without one before it; its begin may be cut off"] += 1
        self.begun = True
        if (self.ended and text.strip("% ")) or re.search(r"[ \t][A-Z][-+.]?\d", text):
            raise ValueError(f"{shown(text)} begins another program; give each its own file")

    def _sorted(self, text, words):
        """A block as letters with numbers, G words in tenths, M words, and what a small letter says."""
        self.owned.clear()
        block, codes, machine, lettered, theirs = {}, [], [], [], ""
        for at, (letter, number) in enumerate(words):
            letter = {"U": "x", "W": "z"}.get(letter, letter) if self.lathe else letter  # steps of X and Z
            if letter == "G":
                codes.append(round(10 * number))
                if abs(10 * number - codes[-1]) > 1e-6:
                    raise ValueError(f"G{number:g} is no word that this reader knows; mend it")
            elif letter in theirs:
                theirs = theirs.replace(letter, "")
                self.owned.add(letter)
            elif letter not in MARKS:
                if letter in block:
                    word = spelling.SPELT.get(letter, letter)
                    raise ValueError(f"{word}{number:g} follows another {word}; keep one of them")
                block[letter] = number
            elif letter == "M":
                machine.append(number)
                theirs = table.M_WORDS[self.heidenhain].get(int(number), "")
            elif letter in LETTERED:
                lettered.append(LETTERED[letter])
                given = "".join(one for one, _ in words if one in "R^&")
                if letter == "a" and given not in ARCS[int(number)]:
                    raise ValueError(f"{shown(text)}: C has its end, CR has R too, and CP one of IPA and PA")
            elif letter == "N" and (at or text[0] != "N") and not self.heidenhain:
                raise ValueError(f"{shown(text)} has the number of a block within it; mend it")
        for letter in block.keys() & TOOLS:
            if (number := block.pop(letter)) % 1 or number < 0:
                raise ValueError(f"{letter}{number:g} is no whole number from 0; mend it")
        if block.pop("O", None) is not None and (dict(words).keys() - {"N", "O"} or "#" in text):
            raise ValueError(f"{shown(text)} holds the number of a program; give it its own block")
        return block, codes, machine, lettered

    def _take_values(self, block):
        """Take the speed, the feed and other axes out of a block, and halve a diameter."""
        self.spindle = block.pop("S", self.spindle)
        if self.spindle < 0:
            raise ValueError(f"the speed S{self.spindle:g} is below 0; mend it")
        if "F" in block:
            self._set_feed(block.pop("F"))
        if self.diameter and "X" in block:
            block["X"] /= 2
        for letter in () if OTHER_AXES.isdisjoint(block) else block.keys() & OTHER_AXES:
            del block[letter]
            self.left_out[letter, "another axis than X, Y and Z, and left out"] += 1

    def _is_of_printers(self, text):
        """Leave out an order of a printer, and forget where the axes are that it may have moved."""
        either = spelling.MACRO.match(text) or spelling.ORDER.match(text)
        order = either or (self.printed and spelling.PRINTED.match(text))
        if order and order[1][0] == "G" and order[1][1].isdigit():
            code = round(10 * float(order[1][1:]))
            if code in table.OF_PRINTERS:
                return False
            self._forget((code == 280 and set(order[2]) & set(AXES)) or AXES)
        if order:
            self.orders[order[1]] += 1
        return order

    def _set_feed(self, value):
        length = self.feed_length
        self.feed = value * {"minute": length * self.feed_unit, "turn": length, "move": 1 / 60}[self.per]
        if not 0 <= self.feed < math.inf:
            raise ValueError(f"the feed of F{value:g} is not positive; mend it")

    # --- moves

    def _target(self, block):
        """The end of a move, whose words are taken out of the block, and whether its start is known."""
        if self.polar:
            self.left_out["G16", "read as a radius X and an angle Y, which LinuxCNC does not know"] += 1
            block |= {way: block.pop(axis) for axis, way in zip("XY", "@^", strict=True) if axis in block}
        if not POLAR.isdisjoint(block):
            self._turn(block)
        end, known, cut = self.position.copy(), None not in self.known, self.motion not in ("rapid", "drill")
        for i, (axis, step, fixed) in PLACES:
            word = axis if self.absolute and axis in block else fixed
            if word in block:
                end[i] = self._absolute(i, block.pop(word))
                if self.known[i] is False and (cuts := self.kinds.count(CUT) + cut):
                    self.left_out[axis, UNSAID] += cuts
                known &= bool(self.known[i]) or cut
                self.known[i] = True
            elif axis in block or step in block:
                if self.known[i] is False:
                    self.left_out[f"a step of {axis}", UNSAID] += 1
                end[i] += block.pop(axis if axis in block else step) * self.unit
            else:
                continue
            within(axis, end[i])
        return end, known

    def _move(self, block):
        if self.motion is None:
            raise ValueError(f"{shown_words(block)} belongs to no move; give the block one of G0 to G3")
        if self.motion != "arc" and PLACED.isdisjoint(block):
            raise ValueError(f"{shown_words(block)} is not known without a place; correct or remove it")
        if self.resumed:
            self.left_out["G80", "followed by moves without a word, which go on as before the cycle"] += 1
        if self.motion == "drill":
            self._drill(block)
            return
        end, known = self._target(block)
        curve = feed = None
        if self.motion == "thread":
            feed = self._by_turn(block.pop("K", 0.0) * self.unit)
        elif self.motion not in ("rapid", "line"):
            curve = getattr(self, f"_{self.motion}")(end, block)
        if block:
            raise ValueError(f"{shown_words(block)} is not known in such a move; correct or remove it")
        self._add(end, known, curve, self.motion == "rapid", feed)

    def _add(self, end, known, curve=None, rapid=False, feed=None):
        start, self.position = self.position, end
        if not rapid and feed is None and self.feed == NO_FEED:
            raise ValueError("the move has no feed; give it a word F")
        if start == end and callable(curve) and not np.ptp(curve.control_points, axis=0).any():
            curve = None
        if curve is None and (start == end or (rapid and not known)):
            return
        if rapid:
            feed = NO_FEED
        elif feed is None:
            feed = self.feed if self.per == "minute" else self._feed_of(start, end, curve)
        if not known:
            self.open_start.append(self.line)
            return
        if curve:
            self.curves[len(self.kinds)] = curve
        self.kinds.append(RAPID if rapid else CUT)
        self.starts.extend(start)
        self.ends.extend(end)
        self.feeds.append(feed)
        self.line_numbers.append(self.line)

    def _feed_of(self, start, end, curve):
        """The feed of a move that G95 gives by the turn, or G93 by the inverse of its minutes."""
        if self.per == "turn":
            return self._by_turn(self.feed)
        curve = arc_curve(start, end, *curve) if isinstance(curve, tuple) else curve
        feed, self.feed = self.feed * (curve.length() if curve else math.dist(start, end)), NO_FEED
        return feed

    def _by_turn(self, advance):
        if self.surface or not self.spindle > 0 or not advance > 0:
            raise ValueError("the feed by the turn needs the speed of the spindle, G97 and S, and F or K")
        return advance * self.spindle / 60
