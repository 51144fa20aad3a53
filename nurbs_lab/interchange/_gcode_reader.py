"""Reading the programs of machine tools: one grammar, one table of commands and one modal state.

The state is that of RS274/NGC, with the words of Fanuc, Siemens, Heidenhain and printers. A command takes its
own words out of a block, so that what is left can only belong to the move. What moves in coordinates of the
program do not show is left out and named once; what would change them is refused by its line and word.
"""

import math
import warnings
from array import array
from collections import Counter
from functools import partial

import numpy as np

from nurbs_lab.interchange._arcs import bezier, bisecting, centre_of_radius
from nurbs_lab.interchange._gcode_flow import Flow
from nurbs_lab.interchange._gcode_splines import WORDS, OpenSpline
from nurbs_lab.interchange._gcode_table import ENDS, G_WORDS, LETTERED, M_WORDS, PLANES, REFUSED, SYSTEMS
from nurbs_lab.interchange._gcode_words import POWERS, evaluated, lines_of, words_of
from nurbs_lab.interchange._move_table import CUT, NO_FEED, RAPID, MoveTable
from nurbs_lab.machining.program import Program

AXES, CENTRES = "XYZ", "IJK"
OTHER_AXES = set("ABCUVWE")
IGNORED = set("NSTDHO")
MOST_COORDINATE = 1e6  # mm
MOTIONS = {0: "rapid", 10: "line", 20: "arc", 30: "arc"}  # alone in most blocks
JOINS_MM = 1e-3  # from the last move to the start of a spline that names it
#: Of a centre to both ends of an arc, in mm and of its radius: LinuxCNC and grbl accept the first, and the
#: arc is closed exactly; up to the second it is closed too, and named; beyond, it is refused.
APART = (5e-3, 1e-3), (5e-2, 1e-2)


def read(path):
    lines, head = lines_of(path.read_bytes())
    interpreter = _Interpreter(lines, head)
    moves = interpreter.run()
    for said in interpreter.said():
        warnings.warn(f"path: {path.name}: {said}", stacklevel=3)
    return Program(moves)


class _Interpreter:
    """The state of a controller, and the moves so far."""

    def __init__(self, lines, head):
        self.lines, self.flow, self.line, self.ended = lines, Flow(lines), 0, False
        self.position, self.known = [0.0, 0.0, 0.0], [False] * 3
        self.motion, self.plane, self.unit, self.absolute, self.absolute_arcs = None, 17, 1.0, True, False
        self.clockwise, self.pole, self.mirrored = True, None, None
        self.feed, self.feed_unit = NO_FEED, 1 / 60
        self.heidenhain = head is not None
        if head == "INCH":
            self.unit, self.feed_unit = 25.4, 1 / 600  # Heidenhain counts tenths of an inch
        self.offsets = [[0.0] * 3 for _ in (*SYSTEMS, "G54.1")]
        self.system, self.shift = 0, [0.0] * 3
        self.spline = None
        self.kinds, self.starts, self.ends, self.feeds, self.places = (array(c) for c in "bdddq")
        self.curves, self.left_out, self.open_start, self.loose = {}, Counter(), [], []

    def run(self):
        flow, lines = self.flow, self.lines
        try:
            while flow.place < len(lines) and not self.ended:
                self.line = flow.place + 1
                if not flow.words or not flow.follow():
                    self._line(lines[flow.place])
                    flow.place += 1
            self._close_spline()
        except (ValueError, RecursionError, OverflowError) as error:
            said = str(error) if isinstance(error, ValueError) else "a number or its nesting is too large"
            raise ValueError(said if said.startswith("line ") else f"line {self.line}: {said}") from None
        if not self.kinds:
            raise ValueError("it holds no move")
        starts, ends = (np.array(points).reshape(-1, 3) for points in (self.starts, self.ends))
        return MoveTable(self.kinds, starts, ends, self.feeds, self.places, self.curves)

    def said(self):
        """What a person has to know about the moves."""
        if not self.ended:
            yield "it has no end of a program (M2, M30, % or END PGM); it may be cut off"
        for (word, why), count in self.left_out.items():
            yield f"{word} in {count} of its blocks is {why}"
        if self.open_start:
            yield (
                f"{len(self.open_start)} of its cuts begin where the program does not say, the first in line "
                f"{self.open_start[0]}, and are left out; give their axes a position first"
            )
        if self.loose:
            apart, line = max(self.loose)
            yield f"{len(self.loose)} of its arcs miss their ends by up to {apart:.3g} mm, in line {line}"

    # --- one line

    def _line(self, text):
        if text[:1] == "/":
            text = text.lstrip("/0123456789").strip()
            self.left_out["/", "an optional block, which is read"] += 1
        if text[:1] == "%":
            self.ended = bool(self.kinds) or self.motion is not None
            return
        if not text:
            return
        words, settings = words_of(text.replace(":", "O", 1) if text[0] == ":" else text)
        parameters, block, codes, machine, lettered = self.flow.parameters, {}, [], [], None
        for letter, value in words:
            number = evaluated(value, parameters) if callable(value) else value
            if letter == "G":
                codes.append(round(10 * number))
            elif letter == "M":
                machine.append(number)
            elif letter in LETTERED:
                lettered = LETTERED[letter]
            elif letter in block:
                raise ValueError(f"{letter}{number:g} follows another {letter}; one block holds one of each")
            elif letter not in IGNORED:
                block[letter] = number
        for key, value in [(evaluated(k, parameters), evaluated(v, parameters)) for k, v in settings]:
            parameters[key] = value
        if len(codes) == 1 and codes[0] in MOTIONS and not machine and not lettered:
            self._start(MOTIONS[codes[0]])
            self.clockwise = codes[0] == 20 if codes[0] >= 20 else self.clockwise
        elif codes or machine or lettered:
            self._commands(codes, machine, lettered, block)
        if "F" in block:
            self._set_feed(block.pop("F"))
        for letter in block.keys() & OTHER_AXES:
            del block[letter]
            self.left_out[letter, "another axis than X, Y and Z, and left out"] += 1
        if block:
            self._spline_row(block) if self.motion in WORDS else self._move(block)

    def _set_feed(self, value):
        self.feed = value * self.unit * self.feed_unit
        if not 0 < self.feed < math.inf:
            raise ValueError(f"the feed of F{value:g} is not positive; mend it")

    def _commands(self, codes, machine, lettered, block):
        """Each command takes its letters; motions come last, as what is left of the block is theirs."""
        for number in machine:
            for letter in M_WORDS.get(int(number), ""):
                block.pop(letter, None)
            if self.heidenhain and number in (91, 92):
                self._machine(number, None, [block.pop(axis, None) for axis in AXES], block)
            if number in (97, 98):
                raise ValueError(f"M{number:g} calls a subroutine; write its moves out")
            self.ended |= number in ENDS
        motions = []
        for code in codes:
            if self._is_setting(code, block):
                continue
            kind, value, letters = G_WORDS.get(code, ("refused", None, ""))
            taken = {letter: block.pop(letter) for letter in letters if letter in block}
            if kind == "motion":
                motions.append((value, code))
            elif kind in ("plane", "unit", "absolute", "absolute_arcs", "system"):
                setattr(self, kind, value)
            elif kind != "nothing":
                getattr(self, f"_{kind}")(code, value, taken, block)
        for motion, code in motions:
            self._start(motion)
            self.clockwise = code == 20 if motion == "arc" else self.clockwise
        if lettered == "pole":
            self.pole = [block.pop(letter, 0.0) * self.unit for letter in "XY"]
        elif lettered:
            self._start(lettered)

    def _is_setting(self, code, block):
        """Whether G5 or G5.1 of this block is Fanuc's mode and no curve of LinuxCNC."""
        mode = "Q" in block if code == 51 else code == 50 and "P" in block and "Q" not in block
        if mode:
            for letter in "PQR" if code == 50 else "PQRXYZ":
                block.pop(letter, None)
        return mode

    def _refused(self, code, value, taken, block):
        why = REFUSED.get(code, "is not among the words that this reader knows; write its moves out")
        raise ValueError(f"G{code / 10:g} {why}")

    def _dwell(self, code, value, taken, block):
        for letter in "P" if "P" in block else "XUFS":
            block.pop(letter, None)

    def _machine(self, code, value, taken, block):
        word = f"M{code:g}" if self.heidenhain else f"G{code / 10:g}"
        self.left_out[word, "a position of the machine, and left out"] += 1

    def _start(self, motion):
        if motion != self.motion:
            self._close_spline()
            self.mirrored, self.motion = None, motion

    def _offset(self, code, value, taken, block):
        given = [i for i, axis in enumerate(AXES) if axis in taken]
        if value == "none":
            self.shift = [0.0] * 3
        elif value == "G52":
            for i in given:
                self.shift[i] = taken[AXES[i]] * self.unit
        elif value == "G92":
            for i in given:
                self.shift[i] += self.position[i] - self._absolute(i, taken[AXES[i]])
                self.known[i] = True
        else:
            system = int(taken.get("P", 0)) or self.system + 1
            if taken.get("L") not in (2, 20) or not 1 <= system <= len(SYSTEMS) or taken.get("R"):
                raise ValueError(
                    "G10 is read with L2 or L20 and P1 to P9 only, which sets a shift; write others out"
                )
            for i in given:
                here = (
                    self.position[i] - self.shift[i] if taken["L"] == 20 else 2 * taken[AXES[i]] * self.unit
                )
                self.offsets[system - 1][i] = here - taken[AXES[i]] * self.unit

    def _absolute(self, i, value):
        return value * self.unit + self.offsets[self.system][i] + self.shift[i]

    # --- moves

    def _target(self, block):
        """The end of a move, whose words are taken out of the block, and whether its start is known."""
        end, known = self.position.copy(), True
        for i, axis in enumerate(AXES):
            if axis in block:
                value = block.pop(axis)
                if self.absolute:
                    end[i] = value * self.unit + self.offsets[self.system][i] + self.shift[i]
                    known &= self.known[i]
                    self.known[i] = True
                else:
                    end[i] += value * self.unit
                if not abs(end[i]) <= MOST_COORDINATE:
                    raise ValueError(f"{axis}{value:g} is beyond {MOST_COORDINATE:g} mm; mend it")
        return end, known

    def _move(self, block):
        if self.motion is None:
            raise ValueError(f"{_words(block)} belongs to no move; give the block one of G0 to G3")
        end, known = self._target(block)
        make = None
        if self.motion not in ("rapid", "line"):
            make = getattr(self, f"_{self.motion}")(end, block)
        if block:
            raise ValueError(f"{_words(block)} is not known in such a move; mend or remove it")
        self._add(self.position, end, known, make)

    def _add(self, start, end, known, make=None):
        self.position = end
        rapid = self.motion == "rapid"
        if make is None and (start == end or (rapid and not known)):
            return
        if not rapid and self.feed == NO_FEED:
            raise ValueError("the move has no feed; give it a word F")
        if not known:
            self.open_start.append(self.line)
            return
        if make:
            self.curves[len(self.kinds)] = make
        self.kinds.append(RAPID if rapid else CUT)
        self.starts.extend(start)
        self.ends.extend(end)
        self.feeds.append(NO_FEED if rapid else self.feed)
        self.places.append(self.line)

    def _arc(self, end, rest):
        axes = a, b, along = PLANES[self.plane]
        start, last, turns = (self.position[a], self.position[b]), (end[a], end[b]), rest.pop("P", 1)
        if turns != int(turns) or not 1 <= turns <= 1000:
            raise ValueError(f"P{turns:g} is no number of turns from 1 to 1000; mend it")
        i, j = CENTRES[a], CENTRES[b]
        if not rest.get(CENTRES[along], 1.0):
            del rest[CENTRES[along]]  # zero, as some posts write
        if "R" in rest:
            radius = rest.pop("R") * self.unit
            centre, apart = centre_of_radius(start, last, radius, self.clockwise)
            if apart > APART[0][0]:
                long = math.dist(start, last)
                self._close(apart, radius, f"R{radius:g} joins no ends {long:g} mm apart")
        elif i in rest or j in rest or self.pole:
            offset = rest.pop(i, 0.0) * self.unit, rest.pop(j, 0.0) * self.unit
            base = (self._absolute(a, 0.0), self._absolute(b, 0.0)) if self.absolute_arcs else start
            centre = self.pole or (base[0] + offset[0], base[1] + offset[1])
            radius, other = math.dist(start, centre), math.dist(last, centre)
            if not abs(other - radius) <= APART[0][0] or radius == 0:
                ends = f"{radius:g} mm from the start of its arc and {other:g} mm from its end"
                self._close(abs(other - radius), radius, f"the centre is {ends}")
            centre = bisecting(start, last, centre)
        else:
            raise ValueError(f"the arc has neither a radius R nor a centre {i}, {j}; give it one")
        return centre, self.clockwise, int(turns), axes

    def _close(self, apart, radius, said):
        """Note an arc that does not close, or refuse it."""
        small, large = (max(absolute, relative * abs(radius)) for absolute, relative in APART)
        if not apart <= large or radius == 0:
            raise ValueError(f"{said}; mend it, or give the centre" if said[0] == "R" else f"{said}; mend it")
        if apart > small:
            self.loose.append((apart, self.line))

    def _cubic(self, end, rest):
        """G5: I, J from the start to the first inner control point, P, Q from the end to the second.

        Without I and J it goes on from the last G5 with the same tangent.
        """
        if self.mirrored and "I" not in rest and "J" not in rest:
            rest |= zip("IJ", self.mirrored, strict=True)
        p, q = rest.get("P", 0.0), rest.get("Q", 0.0)
        points = self.position, self._beside(self.position, rest, "IJ"), self._beside(end, rest, "PQ"), end
        self.mirrored = -p, -q
        return partial(bezier, points)

    def _quadratic(self, end, rest):
        """G5.1: offsets I, J of the middle control point from the start."""
        points = self.position, self._beside(self.position, rest, "IJ"), end
        return partial(bezier, points)

    def _beside(self, point, rest, names):
        if self.plane != 17 or not any(name in rest for name in names):
            raise ValueError(f"the curve needs the plane G17 and its words {', '.join(names)}; give them")
        x, y = (self.unit * rest.pop(name, 0.0) for name in names)
        if not max(abs(x), abs(y)) <= MOST_COORDINATE:
            raise ValueError(f"{', '.join(names)} go beyond {MOST_COORDINATE:g} mm; mend them")
        return point[0] + x, point[1] + y, point[2]

    def _powers(self, end, rest):
        """SPL: the powers of t, which runs from 1 to 0."""
        powers = np.zeros((4, 3))
        powers[0] = end
        for name, letter in POWERS.items():
            powers[int(name[1]), AXES.index(name[2])] = rest.pop(letter, 0.0) * self.unit
        self._require_start(powers.sum(axis=0))
        d, k1, k2, _ = powers
        return partial(bezier, [self.position, d + 2 * k1 / 3 + k2 / 3, d + k1 / 3, d])

    def _require_start(self, point):
        if not (apart := math.dist(point, self.position)) <= JOINS_MM:
            raise ValueError(f"the spline begins {apart:g} mm from where the last move ends; mend it")

    # --- splines of many blocks

    def _spline_row(self, block):
        if self.spline is None:
            self.spline, self.spline_known = OpenSpline(self.motion, self.position, self.line), True
        moved = bool(block.keys() & set(AXES))
        self.position, known = self._target(block)
        self.spline_known &= known
        self.spline.add(tuple(self.position) if moved else None, block)
        if block:
            raise ValueError(f"{_words(block)} is not known in such a spline; mend or remove it")

    def _close_spline(self):
        spline, self.spline = self.spline, None
        if spline is None:
            return
        line, self.line = self.line, spline.line
        try:
            start, end, make = spline.closed()
            self.position = spline.start
            if self.spline_known:
                self._require_start(start)
            self._add(spline.start, list(end), self.spline_known, make)
        except ValueError as error:
            raise ValueError(f"line {self.line}: the spline that begins here is refused: {error}") from None
        self.line = line


def _words(block):
    return " ".join(f"{letter}{number:g}" for letter, number in block.items())
