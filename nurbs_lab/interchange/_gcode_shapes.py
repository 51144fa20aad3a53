"""Moves that are no straight lines: arcs, Bezier curves, splines of many blocks, cycles and polar words.

Splines take several blocks: G5.2 and G6.2 of LinuxCNC, G06.2 of Fanuc, and BSPLINE of Siemens.
"""

import math

import numpy as np

from nurbs_lab.interchange import _gcode_table as table
from nurbs_lab.interchange._gcode_table import PLANES
from nurbs_lab.interchange._gcode_words import POWERS, SPELT
from nurbs_lab.interchange._moves import bezier, bisecting, centre_of_radius
from nurbs_lab.nurbs import NurbsCurve

AXES, CENTRES, FIXED_CENTRES = "XYZ", "IJK", "oqr"  # the last are Siemens' I=AC()
MOST_COORDINATE = 1e6  # mm
CLEAR_MM = 0.254  # above the last bottom of a hole, where a peck begins
MOST_PECKS = 100_000  # of one block
JOINS_MM = 1e-3  # from the last move to the first control point of a spline that begins there
#: Of a centre to both ends of an arc, in mm, of its radius, and at most in mm: LinuxCNC and grbl accept the
#: first, and the arc is closed exactly; up to the second it is closed too, and named; else it is refused.
APART = (5e-3, 1e-3, 0.5), (5e-2, 1e-2, 0.5)


def uniform(degree, start, points, weights, _):
    """G5.2: uniform knots; the weight of the start is that of the block of G5.2, if it has no point."""
    first = weights.pop(0) if points[0] is None else 1.0
    points = points[len(points) - len(weights) :]
    if None in points:
        raise ValueError("only its first block may have no control point")
    spans = len(points) + 1 - degree
    if spans < 1:
        raise ValueError(f"{len(points) + 1} control points are too few for L{degree + 1}")
    knots = [0] * degree + list(range(spans + 1)) + [spans] * degree
    return knots, [start, *points], [first, *weights]


def by_knots(degree, _, points, weights, given):
    """G6.2: a knot in every block; the last ones have nothing else."""
    points = points[: max(len(points) - degree - 1, 0)]
    if None in given or None in points or not points:
        raise ValueError(f"every block needs its knot K, and all but the last {degree + 1} a control point")
    if len(set(given[: degree + 1])) > 1 or len(set(given[-degree - 1 :])) > 1:
        raise ValueError(f"its first {degree + 1} knots K must be equal, and its last; a block is missing")
    return given, points, weights[: len(points)]


def by_spans(degree, start, points, weights, given):
    """BSPLINE: lengths of the spans of the knots; empty ones may stand before or after them, or all are 1."""
    if points[0] is given[0] is None:  # its degree has a block of its own
        points, weights, given = points[1:], weights[1:], given[1:]
    if None in points or not points:
        raise ValueError("every block needs a control point")
    if math.dist(start, points[0]) > JOINS_MM or given[0] != 0:
        points, weights = [start, *points], [1.0, *weights]
    count = len(points) - degree
    if not any(given):
        given = [1.0] * max(count, 1)
    filled = np.flatnonzero(given) if None not in given else range(len(given))
    spans = given[filled[0] : filled[-1] + 1]
    if None in spans or len(spans) != count:
        raise ValueError(f"its {len(points)} control points need {count} lengths PL of spans, others 0")
    ends = np.r_[0.0, np.cumsum(spans)]
    return np.r_[[0.0] * degree, ends, [ends[-1]] * degree], points, weights


#: Kind -> letters of the degree, of the weight and of the knot; by how much the first is larger; the degree
#: and the weight without a word, which G5.2 needs; and what makes its knots.
WORDS = {"nurbs": ("L", "P", "", 1, 2, 0.0, uniform), "knots": ("P", "R", "K", 1, 3, 1.0, by_knots)}
WORDS["siemens"] = "d", "w", "l", 0, 3, 1.0, by_spans


class Shapes:
    """The part of the interpreter that makes curves of blocks."""

    def _arc(self, end, rest):
        about_pole = self.pole and "R" not in rest
        axes = a, b, along = PLANES[self.pole_plane if about_pole else self.plane]
        start, last, turns = (
            (self.position[a], self.position[b]),
            (end[a], end[b]),
            rest.pop("&" if self.heidenhain else "P", 1),
        )
        if self.clockwise is None:
            raise ValueError("the arc has no direction, and none is before it; give it DR+ or DR-")
        if turns != int(turns) or not 1 <= turns <= 1000:
            raise ValueError(f"P{turns:g} is no number of turns from 1 to 1000; mend it")
        i, j = CENTRES[a], CENTRES[b]
        if not rest.get(CENTRES[along], 1.0):
            del rest[CENTRES[along]]  # zero, as some posts write
        if "R" in rest:
            radius = within("R", rest.pop("R") * self.unit)
            centre, apart = centre_of_radius(start, last, radius, self.clockwise)
            if apart > APART[0][0]:
                long = math.dist(start, last)
                self._close(apart, radius, f"R{radius:g} joins no ends {long:g} mm apart")
        elif about_pole or not rest.keys().isdisjoint((i, j, FIXED_CENTRES[a], FIXED_CENTRES[b])):
            centre = (
                (self.pole[a], self.pole[b]) if self.pole else (self._centre(a, rest), self._centre(b, rest))
            )
            radius, other = math.dist(start, centre), math.dist(last, centre)
            if not abs(other - radius) <= APART[0][0] or radius == 0:
                ends = f"{radius:g} mm from the start of its arc and {other:g} mm from its end"
                self._close(abs(other - radius), radius, f"the centre is {ends}")
            nearer = bisecting(start, last, centre)
            if math.dist(nearer, centre) <= 2 * abs(other - radius):
                centre = nearer
        else:
            raise ValueError(f"the arc has neither a radius R nor a centre {i}, {j}; give it one")
        return centre, self.clockwise, int(turns), axes

    def _centre(self, axis, rest):
        if (fixed := FIXED_CENTRES[axis]) in rest:
            return self._absolute(axis, rest.pop(fixed))
        if self.absolute_arcs and CENTRES[axis] not in rest:
            raise ValueError(f"G90.1 needs {CENTRES[axis]} in every arc; give it")
        base = self._absolute(axis, 0.0) if self.absolute_arcs else self.position[axis]
        return base + rest.pop(CENTRES[axis], 0.0) * self.unit

    def _close(self, apart, radius, said):
        """Note an arc that does not close, or refuse it."""
        small, large = (min(max(least, part * abs(radius)), most) for least, part, most in APART)
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
        both = self._beside(self.position, rest, "IJ", all), self._beside(end, rest, "PQ", all)
        self.mirrored = -p, -q
        return bezier([self.position, *both, end])

    def _quadratic(self, end, rest):
        """G5.1: offsets I, J of the middle control point from the start."""
        return bezier([self.position, self._beside(self.position, rest, "IJ", any), end])

    def _beside(self, point, rest, names, needed):
        if self.plane != 17 or not needed(name in rest for name in names):
            raise ValueError(f"the curve needs the plane G17 and its words {', '.join(names)}; give them")
        x, y = (within(name, self.unit * rest.pop(name, 0.0)) for name in names)
        return point[0] + x, point[1] + y, point[2]

    def _powers(self, end, rest):
        """SPL: the powers of t, which runs from 1 to 0."""
        powers = np.zeros((4, 3))
        powers[0] = end
        for name, letter in POWERS.items():
            powers[int(name[1]), AXES.index(name[2])] = rest.pop(letter, 0.0) * self.unit
        self._require_start(powers.sum(axis=0))
        d, k1, k2, _ = powers
        return bezier([self.position, d + 2 * k1 / 3 + k2 / 3, d + k1 / 3, d])

    def _require_start(self, point):
        if not (apart := math.dist(point, self.position)) <= JOINS_MM:
            raise ValueError(f"the spline begins {apart:g} mm from where the last move ends; mend it")

    def _spline_row(self, block):
        """A block of a spline: its control point, or None, and its words of degree, weight and knot."""
        if self.spline is None:
            self.spline, self.spline_known, self.spline_start = [], True, (self.position, self.line)
        moved = bool(block.keys() & set("XYZxyztuv"))
        plane, given = {AXES[i] for i in PLANES[self.plane][:2]}, block.keys() & set(AXES)
        if moved and self.motion == "nurbs" and not (self.absolute and plane == given):
            said = "the control points of G5.2 need G90 and both words of their plane, and no third"
            raise ValueError(f"{said}; give them")
        self.position, known = self._target(block)
        self.spline_known &= known
        if moved and self.motion == "nurbs" and "P" not in block:
            raise ValueError("the control point has no weight P; give it P1")
        if self.motion == "knots":
            block.pop("Q", None)  # how LinuxCNC is to follow it
        if strange := block.keys() - set(WORDS[self.motion][:3]):
            strange = shown_words({letter: block[letter] for letter in strange})
            raise ValueError(f"{strange} is not known in such a spline; correct or remove it")
        self.spline.append((self.position if moved else None, block))

    def _close_spline(self, by_g53=False):
        rows, self.spline = self.spline, None
        if rows is None:
            return
        last, (start, self.line) = self.line, self.spline_start
        try:
            if self.motion == "nurbs" and not by_g53:
                raise ValueError("it has no G5.3")
            letter, weight, knot, larger, usual, plain, rule = WORDS[self.motion]
            degrees = [int(words[letter]) - larger for _, words in rows if letter in words]
            degree = degrees[-1] if degrees else usual
            points, blocks = zip(*rows, strict=True)
            weights = [words.get(weight, plain) for words in blocks]
            if not 1 <= degree <= 25 or not min(weights) > 0:
                raise ValueError(f"its degree {degree} is not from 1 to 25, or it has no positive weight")
            parts = rule(degree, start, list(points), weights, [w.get(knot) for w in blocks])
            curve, self.position = NurbsCurve(degree, *parts), start
            if self.spline_known:
                self._require_start(parts[1][0])
            self._add(list(parts[1][-1]), self.spline_known, curve)
        except ValueError as error:
            raise ValueError(f"line {self.line}: the spline that begins here is refused: {error}") from None
        self.line = last

    def _turn(self, block):
        """The radius @, the angle ^ and its step & about the pole or the origin, as words of their plane."""
        plane, base = self.pole_plane if self.pole else self.plane, [self._absolute(i, 0.0) for i in range(3)]
        (i, j, _), pole, turned = PLANES[plane], self.pole or base, self.absolute and "^" in block
        x, y = ((self.position[k] - pole[k]) / self.unit for k in (i, j))
        if (
            (not self.pole and (plane != 17 or "&" in block))
            or {AXES[i], AXES[j]} & block.keys()
            or not (x or y or turned)
        ):
            raise ValueError("@ and ^ need G17, no X or Y beside them, and G90 and ^ at the origin; mend it")
        radius, angle, step = math.hypot(x, y), math.degrees(math.atan2(y, x)), block.pop("&", 0.0)
        if self.absolute:
            radius, angle = block.pop("@", radius), block.pop("^", angle) + step
            x, y = ((base[k] - pole[k]) / self.unit for k in (i, j))
        else:
            radius, angle = radius + block.pop("@", 0.0), angle + block.pop("^", 0.0)
        if step:
            block["&"] = max(1, math.ceil(abs(step) / 360 - 1e-9))
            if self.clockwise == (step > 0):
                raise ValueError(f"IPA{step:g} turns against DR; mend it")
        block[AXES[i]] = radius * math.cos(math.radians(angle)) - x
        block[AXES[j]] = radius * math.sin(math.radians(angle)) - y

    def _drill(self, block):
        """A canned cycle: over each place, down to R, to Z in steps of Q, and back up."""
        axis = PLANES[self.plane][2]
        peck, slowly, own = table.CYCLES[self.cycle]
        steps, given = not self.absolute, block.keys() & {AXES[axis], "R"}
        if steps != self.by_steps and not (given or self.fanuc):
            self.left_out["G91", "taken for the heights of the cycle before, too, which Fanuc keeps"] += 1
        if given or not self.fanuc:
            self.by_steps = steps
        base = self.level if self.by_steps else self._absolute(axis, 0.0)
        self.hole |= {letter: block.pop(letter) for letter in (AXES[axis], *own) if letter in block}
        hole = {letter: within(letter, self.unit * value) for letter, value in self.hole.items()}
        times = block.pop("L" if self.plane != 17 or "L" in block else "K", 1)  # K is Fanuc's
        if not {AXES[axis], "R"} <= hole.keys() or (peck and not hole.get("Q", 0) > 0) or self.per == "move":
            raise ValueError(f"the cycle needs {AXES[axis]} and R, and Q if it pecks, but no G93; mend it")
        top = hole["R"] + base
        bottom = hole[AXES[axis]] + (top if self.by_steps else base)
        known = self.known[axis] is not None if self.by_steps else self.known[axis]
        level = max(top, self.level) if known and self.retract != "R" else top
        if not known and self.retract != "R":
            why = "from a height that the program does not say, and comes back to R"
            self.left_out[f"G{self.cycle}", why] += 1
        elif level > top and not self.retract:
            why = "without G98 or G99, and comes back to where it began, as after G98"
            self.left_out[f"G{self.cycle}", why] += 1
        first = top - hole.get("I", 0.0)  # the surface from which Siemens and Heidenhain count their pecks
        depths = _pecks(first - bottom, hole["Q"], hole.get("J", 0.0)) if peck else []
        if not (0 <= times == int(times) and times * (len(depths) + 1) <= MOST_PECKS) or bottom > top:
            raise ValueError(f"its hole is above R, or takes more than {MOST_PECKS} steps; mend it")
        if not known or self.level < top:
            self._along(axis, top, known)
            self.known[axis] = not self.by_steps or self.known[axis]
        for _ in range(int(times)):
            end, known = self._target(rest := dict(block))
            if rest:
                raise ValueError(f"{shown_words(rest)} is not known in a cycle; correct or remove it")
            end[axis] = max(self.position[axis], level) if block else self.position[axis]
            self._add(end, known, rapid=True)
            self._along(axis, top)
            for depth in depths:
                self._along(axis, first - depth, rapid=False)
                if peck == "top":
                    self._along(axis, top)
                self._along(axis, first - depth + CLEAR_MM)
            self._along(axis, bottom, rapid=False)
            if slowly:
                self._along(axis, top, rapid=False)
            self._along(axis, level)

    def _bore_here(self):
        """A hole of a cycle that was defined before; its heights are of the program, its feed is its own."""
        names = "cycle", "hole", "level", "retract", "absolute", "by_steps", "feed"
        before = {name: getattr(self, name) for name in names}
        axis, (cycle, words) = PLANES[self.plane][2], self.holes
        if "K" in words:
            self.feed = self._by_turn(words["K"] * self.unit)
        elif "F" in words:
            self._set_feed(words["F"])
        self.cycle, self.retract, self.absolute = cycle, "level", True
        self.hole = {letter: words[letter] for letter in "IJ" if letter in words}
        self.level = self._absolute(axis, words["L"])
        self._drill({AXES[axis]: words["Z"]} | {letter: words[letter] for letter in "RQ" if letter in words})
        vars(self).update(before)
        self.due, self.holes = False, None if words["P"] == 1 else self.holes

    def _along(self, axis, height, known=True, rapid=True):
        known = known and None not in self.known
        self._add([*self.position[:axis], height, *self.position[axis + 1 :]], known, rapid=rapid)


def _pecks(depth, stroke, less):
    """Depths of the pecks before the last: each is ``less`` less deep, to ``less``; the last two equal."""
    depths = []
    while len(depths) < MOST_PECKS and (left := depth - sum(depths[-1:])) > stroke * (1.0 + 1e-9):
        stroke = 0.5 * left if stroke == less and left < 2.0 * less else stroke
        depths.append(sum(depths[-1:]) + stroke)
        stroke = max(stroke - less, min(stroke, less))
    return depths


def within(word, mm):
    """The value of a word, if it is no larger than a machine."""
    if not abs(mm) <= MOST_COORDINATE:
        raise ValueError(f"{word}{mm:g} is beyond {MOST_COORDINATE:g} mm; mend it")
    return mm


def shown_words(block):
    return " ".join(f"{SPELT.get(letter, letter)}{number:g}" for letter, number in block.items())
