"""Reading the programs of machine tools: ordinary G-code and every dialect that `export` writes.

Most blocks hold nothing but straight moves and arcs. They are read by the thousand as columns, and all others
one by one. What is not a move in coordinates of the program (variables, subroutines, cycles, positions of the
machine itself) is refused by its line and word, with the cure. The offsets of G92, G10 L2 and G54 to G59.3
are plain shifts, zero until they are set.
"""

import math
import warnings
from functools import partial

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.interchange._arcs import arc_curve, bezier, centres_of_radius
from nurbs_lab.interchange._gcode_splines import WORDS, OpenSpline
from nurbs_lab.interchange._gcode_words import POWERS, filled, words_of
from nurbs_lab.interchange._move_table import CUT, NO_FEED, RAPID, MoveTable
from nurbs_lab.machining.program import Program

AXES, CENTRES = "XYZ", "IJK"
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}  # first axis, second axis, axis of a helix
SYSTEMS = [540, 550, 560, 570, 580, 590, 591, 592, 593]  # tenths of G54 to G59.3
INCHES, MILLIMETRES = (200, 700, 7000), (210, 710, 7100)
WITHOUT_MOVES = {40, 43, 49, 50, 61, 64, 80, 94, 97, 98, 600, 601, 602, 641, 642}  # G words that move nothing
MOTIONS = {
    0: "rapid",
    10: "line",
    20: "arc",
    30: "arc",
    50: "cubic",
    51: "quadratic",
    52: "nurbs",
    62: "fanuc",
}
LETTERED = {"m": "rapid", "s": "powers", "b": "siemens"}  # see `_gcode_words`
IGNORED = set("NSTDHO")
MOST_COORDINATE = 1e6
SPLINE_APART = 1e-3  # mm, from the last move to the start of a block SPL
RADII_APART = 0.02  # mm, or a thousandth: from a centre to both ends of an arc
LONG_RUN = 25  # blocks from which on columns are faster
CURES = {
    **dict.fromkeys(("G28", "G30", "G53"), "give the move in coordinates of the program"),
    **dict.fromkeys(("G41", "G42"), "compute the path of the centre of the tool"),
    **dict.fromkeys(("G93", "G95"), "give the feed per minute, G94"),
}


def read(path):
    interpreter = _Interpreter(words_of(path.read_bytes()))
    moves = interpreter.run()
    if interpreter.motion != "end" and not interpreter.words.ended:
        warnings.warn(
            f"path: {path.name} has no end of a program (M2, M30, % or END PGM); it may be cut off",
            stacklevel=3,
        )
    return Program(moves)


class _Interpreter:
    """The state of a controller, and the moves so far."""

    def __init__(self, words):
        self.words = words
        self.position = (0.0, 0.0, 0.0)
        self.placed = False  # whether any position was given
        self.motion, self.plane, self.unit, self.absolute, self.absolute_arcs = None, 17, 1.0, True, False
        self.clockwise = True
        if words.head == "inch":
            self.unit = 25.4
        self.feed, self.feed_unit = NO_FEED, 1 / (600 if words.head == "inch" else 60)
        self.offsets = [[0.0] * 3 for _ in SYSTEMS]
        self.system, self.shift = 0, [0.0] * 3
        self.spline, self.line = None, 0
        self.columns, self.rows, self.curves, self.count = [], [], {}, 0

    def run(self):
        words = self.words
        longest = words.plain_runs().tolist()
        letters, numbers = bytes(words.letters).decode(), words.numbers.tolist()
        first, lines = words.first.tolist(), words.lines.tolist()
        block, blocks = 0, len(first) - 1
        while block < blocks and self.motion != "end":
            stop = longest[block]
            if stop - block > LONG_RUN and self.motion in ("rapid", "line", "arc"):
                block = self._run(block, stop)
                if block == stop:
                    continue
            at = slice(first[block], first[block + 1])
            try:
                self._block(letters[at], numbers[at], lines[block])
            except ValueError as error:
                said = str(error)
                raise ValueError(
                    said if said.startswith("line ") else f"line {lines[block]}: {said}"
                ) from None
            block += 1
        self._close_spline()
        self._add_rows()
        if not self.count:
            raise ValueError("it holds no move")
        kinds, starts, ends, feeds, lines = (
            np.concatenate(column) for column in zip(*self.columns, strict=True)
        )
        return MoveTable(kinds, starts, ends, feeds, lines, self.curves)

    # --- many blocks at once

    def _run(self, block, stop):
        """The straight moves and arcs of plain blocks, as columns; the first block that is not read."""
        words, first = self.words, self.words.first
        at = slice(first[block], first[stop])
        letters, numbers = words.letters[at], words.numbers[at]
        rows = np.repeat(np.arange(stop - block), np.diff(first[block : stop + 1]))

        def given(letter, scale=1.0):
            """The number of a letter in each block, NaN where it has none."""
            chosen = letters == ord(letter)
            values = np.full(stop - block, np.nan)
            values[rows[chosen]] = numbers[chosen] * scale
            return values

        codes = {"rapid": 0, "line": 1, "arc": 2 if self.clockwise else 3}
        motion = filled(given("G"), codes[self.motion])
        feeds = filled(given("F", self.unit * self.feed_unit), self.feed)
        ends = np.empty((stop - block, 3))
        for i, axis in enumerate(AXES):
            moved = given(axis, self.unit)
            if self.absolute:
                ends[:, i] = filled(moved + self._absolute(i, 0.0), self.position[i])
            else:
                ends[:, i] = self.position[i] + np.cumsum(np.nan_to_num(moved))
        starts = np.vstack([self.position, ends[:-1]])
        arc = motion >= 2
        moved = arc | (starts != ends).any(axis=1)
        if not self.placed:
            moved[0] = arc[0]
        axes = a, b, along = PLANES[self.plane]
        flat = starts[:, [a, b]], ends[:, [a, b]]
        offsets = np.column_stack([given(CENTRES[axis], self.unit) for axis in (a, b)])
        radius = given("R", self.unit)
        round_ = ~np.isnan(radius)
        centres = np.nan_to_num(offsets) + self._centre_base(flat[0], a, b)
        centres[round_] = centres_of_radius(*(p[round_] for p in flat), radius[round_], motion[round_] == 2)
        first, second = (lengths(points - centres) for points in flat)
        closed = (np.abs(second - first) <= np.maximum(RADII_APART, 1e-3 * first)) & (first > 0)
        centred = ~np.isnan(offsets).all(axis=1)
        good = np.where(arc, closed & (round_ != centred), ~(round_ | centred))
        good &= np.isnan(given(CENTRES[along]))
        good &= np.abs(ends).max(axis=1) <= MOST_COORDINATE
        good &= ~moved | (motion == 0) | (feeds != NO_FEED)
        count = len(good) if good.all() else int(np.argmin(good))  # the block there is refused by `_block`
        if not count:
            return block
        moved[count:] = False
        self._add_rows()
        kinds = np.where(motion[moved] == 0, RAPID, CUT)
        feeds_moved = np.where(kinds == CUT, feeds[moved], NO_FEED)
        lines = words.lines[block:stop][moved]
        self.columns.append((kinds, starts[moved], ends[moved], feeds_moved, lines))
        numbered = self.count - 1 + np.cumsum(moved)
        for i in np.flatnonzero(arc & moved).tolist():
            curve = partial(arc_curve, starts[i], ends[i], centres[i], motion[i] == 2, 1, axes)
            self.curves[int(numbered[i])] = curve
        self.count += len(kinds)
        last = count - 1
        self.position, self.feed, self.placed = tuple(ends[last].tolist()), float(feeds[last]), True
        self.motion, self.clockwise = ["rapid", "line", "arc", "arc"][int(motion[last])], motion[last] == 2
        return block + count

    def _add_rows(self):
        """Moves that were added one by one become columns too."""
        if self.rows:
            self.columns.append(tuple(map(np.array, zip(*self.rows, strict=True))))
            self.rows = []

    # --- one block

    def _block(self, letters, numbers, line):
        self.line = line
        block, codes, lettered = {}, [], None
        for letter, number in zip(letters, numbers, strict=True):
            if letter == "G":
                codes.append(round(10 * number))
            elif letter == "M":
                self._machine_word(number)
            elif letter in LETTERED:
                lettered = LETTERED[letter]
            elif letter in block:
                raise ValueError(f"{letter}{number:g} follows another {letter}; one block holds one of each")
            elif letter not in IGNORED:
                block[letter] = number
        if "F" in block:
            self.feed = block.pop("F") * self.unit * self.feed_unit
            if not self.feed > 0:
                raise ValueError(
                    f"the feed of F{self.feed / self.unit / self.feed_unit:g} is not positive; mend it"
                )
        setting = None
        for code in codes:
            setting = self._general_word(code) or setting
        if lettered:
            self._start(lettered)
        if setting:
            self._offset(setting, block)
        elif block and self.motion in WORDS:
            self._spline_row(block)
        elif block:
            self._move(block)

    def _machine_word(self, number):
        if number in (2, 30):
            self._close_spline()
            self.motion = "end"
        elif number in (97, 98, 99):
            raise ValueError(f"M{number:g} calls or ends a subroutine; write its moves out")

    def _general_word(self, code):
        """Take over one G word, given in tenths; the name of a setting whose numbers follow in the block."""
        word = f"G{code / 10:g}"
        if code in MOTIONS:
            self._start(MOTIONS[code])
            self.clockwise = code == 20
        elif code == 53:
            self._close_spline()
            self.motion = None
        elif code in (170, 180, 190):
            self.plane = code // 10
        elif code in (*INCHES, *MILLIMETRES):
            self.unit = 25.4 if code in INCHES else 1.0
        elif code in (900, 910):
            self.absolute = code == 900
        elif code in (901, 911):
            self.absolute_arcs = code == 901
        elif code in SYSTEMS:
            self.system = SYSTEMS.index(code)
        elif code in (100, 920):
            return word
        elif code in (921, 922):
            self.shift = [0.0] * 3
        elif code == 40:
            return "dwell"
        elif code % 10 or code // 10 not in WITHOUT_MOVES:
            cure = CURES.get(word, "write its moves out")
            raise ValueError(f"{word} is not among the words that this reader knows; {cure}")
        return None

    def _start(self, motion):
        if motion != self.motion:
            self._close_spline()
        self.motion = motion

    def _offset(self, setting, block):
        given = [i for i, axis in enumerate(AXES) if axis in block]
        if setting == "G92":
            for i in given:
                self.shift[i] += self.position[i] - self._absolute(i, block[AXES[i]])
        elif setting == "G10":
            system = int(block.get("P", 0)) or self.system + 1
            if block.get("L") != 2 or not 1 <= system <= len(SYSTEMS):
                raise ValueError("G10 is read as G10 L2 P1 to P9 only, which sets a shift; write others out")
            for i in given:
                self.offsets[system - 1][i] = block[AXES[i]] * self.unit

    def _absolute(self, i, value):
        return value * self.unit + self.offsets[self.system][i] + self.shift[i]

    def _target(self, block):
        """The end of a move, and what is left of its block."""
        end, rest = list(self.position), block
        for i, axis in enumerate(AXES):
            if axis in rest:
                value = rest.pop(axis)
                end[i] = self._absolute(i, value) if self.absolute else end[i] + value * self.unit
                if not abs(end[i]) <= MOST_COORDINATE:
                    raise ValueError(f"{axis}{value:g} is beyond {MOST_COORDINATE:g} mm; mend it")
        return tuple(end), rest

    def _move(self, block):
        if self.motion is None:
            raise ValueError(f"{_words(block)} belongs to no move; give the block one of G0 to G3")
        end, rest = self._target(block)
        make = None
        if self.motion in ("arc", "cubic", "quadratic", "powers"):
            make = getattr(self, f"_{self.motion}")(end, rest)
        if rest:
            raise ValueError(f"{_words(rest)} is not known in such a move; mend or remove it")
        self._add_one(end, make)

    def _add_one(self, end, make=None):
        start, self.position = self.position, end
        if make is None and (start == end or not self.placed):
            self.placed = True
            return
        self.placed = True
        rapid = self.motion == "rapid"
        if not rapid and self.feed == NO_FEED:
            raise ValueError("the move has no feed; give it a word F")
        if make:
            self.curves[self.count] = make
        kind, feed = (RAPID, NO_FEED) if rapid else (CUT, self.feed)
        self.rows.append((kind, start, end, feed, self.line))
        self.count += 1

    def _arc(self, end, rest):
        axes = a, b, _ = PLANES[self.plane]
        start, clockwise, turns = self.position, self.clockwise, rest.pop("P", 1)
        if turns != int(turns) or not 1 <= turns <= 1000:
            raise ValueError(f"P{turns:g} is no number of turns from 1 to 1000; mend it")
        if "R" in rest:
            radius = rest.pop("R") * self.unit
            ends = np.array([start, end])[:, [a, b]]
            (centre,) = centres_of_radius(*ends[:, None], np.array([radius]), clockwise)
            if np.isnan(centre).any():
                apart = math.dist(*ends.tolist())
                raise ValueError(f"R{radius:g} joins no ends {apart:g} mm apart; mend it, or give the centre")
        else:
            i, j = CENTRES[a], CENTRES[b]
            if i not in rest and j not in rest:
                raise ValueError(f"the arc has neither a radius R nor a centre {i}, {j}; give it one")
            offset = rest.pop(i, 0.0) * self.unit, rest.pop(j, 0.0) * self.unit
            base = self._centre_base((start[a], start[b]), a, b)
            centre = base[0] + offset[0], base[1] + offset[1]
            r0, r1 = (math.hypot(p[a] - centre[0], p[b] - centre[1]) for p in (start, end))
            if not abs(r1 - r0) <= max(RADII_APART, 1e-3 * r0) or r0 == 0:
                raise ValueError(
                    f"the centre is {r0:g} mm from the start of its arc and {r1:g} mm from its end; mend it"
                )
        return partial(arc_curve, start, end, centre, clockwise, int(turns), axes)

    def _centre_base(self, start, a, b):
        """What I, J and K are measured from."""
        return (self._absolute(a, 0.0), self._absolute(b, 0.0)) if self.absolute_arcs else start

    def _cubic(self, end, rest):
        """G5: I, J from the start to the first inner control point, P, Q from the end to the second."""
        points = self.position, self._beside(self.position, rest, "IJ"), self._beside(end, rest, "PQ"), end
        return partial(bezier, points)

    def _quadratic(self, end, rest):
        """G5.1: offsets I, J of the middle control point from the start."""
        points = self.position, self._beside(self.position, rest, "IJ"), end
        return partial(bezier, points)

    def _beside(self, point, rest, names):
        if self.plane != 17 or not any(name in rest for name in names):
            raise ValueError(f"the curve needs the plane G17 and its words {', '.join(names)}; give them")
        x, y = (self.unit * rest.pop(name, 0.0) for name in names)
        return point[0] + x, point[1] + y, point[2]

    def _powers(self, end, rest):
        """SPL: the powers of t, which runs from 1 to 0."""
        powers = np.zeros((4, 3))
        powers[0] = end
        for name, letter in POWERS.items():
            powers[int(name[1]), AXES.index(name[2])] = rest.pop(letter, 0.0) * self.unit
        apart = math.dist(powers.sum(axis=0), self.position)
        if not apart <= SPLINE_APART:
            raise ValueError(f"the spline begins {apart:g} mm from where the last move ends; mend it")
        d, k1, k2, _ = powers
        points = [self.position, d + 2 * k1 / 3 + k2 / 3, d + k1 / 3, d]
        return partial(bezier, points)

    # --- splines of many blocks

    def _spline_row(self, block):
        if self.spline is None:
            self.spline = OpenSpline(self.motion, self.position, self.line)
        self.spline.take_degree(block)
        moved = bool(block.keys() & set(AXES))
        self.position, rest = self._target(block)
        self.spline.add(self.position if moved else None, rest)
        if rest:
            raise ValueError(f"{_words(rest)} is not known in such a spline; mend or remove it")

    def _close_spline(self):
        spline, self.spline = self.spline, None
        if spline is None:
            return
        line, self.line = self.line, spline.line
        try:
            end, make = spline.closed()
            self.position = spline.start
            self._add_one(end, make)
        except ValueError as error:
            raise ValueError(f"line {self.line}: the spline that begins here is refused: {error}") from None
        self.line = line


def _words(block):
    return " ".join(f"{letter}{number:g}" for letter, number in block.items())
