"""Curves in the languages of controllers: one class for each dialect of G-code, and one for Heidenhain.

A dialect turns positions (already in its units, one column for each axis letter) into lines. A curve that the
dialect cannot express exactly is approximated within the tolerance, as is one that is an arc within it where
the dialect has arcs; one that it cannot express is refused.
"""

import itertools

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.interchange import _pieces
from nurbs_lab.interchange._moves import HELIX_MM, WHOLE, bisecting, circle_through
from nurbs_lab.mesh.read import UNITS
from nurbs_lab.nurbs.refinement import project

LARGEST = 1e6  # coordinate; controllers hold five or six digits before the point
PLANES = {"XY": "G17", "ZX": "G18", "YZ": "G19"}
CENTRE = dict(zip("XYZ", "IJK", strict=True))
WEIGHT_DIGITS = KNOT_DIGITS = 12
COOLANTS = {"off": (), "mist": ("M7",), "flood": ("M8",)}
LEAST_RADIUS_MM = 2.5e-3  # of an arc: LinuxCNC refuses one of up to 1 to 2 µm
MOST_TURN = 11 / 6 * np.pi  # radians of a block: of a longer one, the rounding of its ends moves the centre
PLACES = 18  # of a Bezier piece, where it is compared with one arc


def number(value, digits):
    """Fixed-point, without an exponent and without zeros at the end."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    return "0" if text == "-0" else text


def _signed(value, digits=8):
    return f"{'+' if value >= 0 else ''}{number(value, digits)}"


class G1:
    """Straight moves; the other dialects inherit the frame of a program from it."""

    unit_words = "G21", "G20"  # mm, inch
    comment, end, length_word = "({})", "M2", "G43 H{} "
    name, tail, reset = "%\nO{}", ("%",), "G40 G80"
    offsets = 54, 55, 56, 57, 58, 59  # G words of those of a setup
    straight_word, rapid_word = "G1 ", "G0 "
    written = staticmethod(number)
    degree = 1  # up to which curves are exact

    def __init__(self, units, axes, tolerance, setup=None):
        self.axes, self.tolerance, self.unit_word = axes, tolerance, self.unit_words[units == "inch"]
        self.setup, self.unit_mm, self.digits = setup, UNITS[units], 7 if units == "mm" else 9
        if setup:
            self.digits = setup.digits if units == "mm" else setup.digits + 1
        self.position = self.feed = self.plane = None

    def exact(self, curve):
        """Whether the dialect expresses this curve without an approximation."""
        return curve.degree <= self.degree

    def begin(self, title):
        setup = self.setup
        if setup and setup.number:
            yield from self.name.format(setup.number).split("\n")
        yield self.comment.format(title)
        yield f"{self.unit_word} G17 G90 G94"
        if not setup:
            return
        yield f"{self.reset} G{self.offsets[setup.offset - 54]}"
        yield f"T{setup.tool} M6"
        yield f"S{number(setup.spindle_rpm, 3)} M{3 if setup.clockwise else 4}"
        high = f"Z{number(setup.safe_z_mm / self.unit_mm, self.digits)}"
        yield f"G0 {self.length_word.format(setup.tool)}{high}"
        yield from COOLANTS[setup.coolant]

    def numbered(self, lines):
        """The lines as the file holds them."""
        return lines

    def shut_down(self):
        return () if not self.setup else ("M5",) if self.setup.coolant == "off" else ("M9", "M5")

    def finish(self):
        yield from self.shut_down()
        yield self.end
        if self.setup and self.setup.number:
            yield from self.tail

    def words(self, point, letters=None):
        numbers = zip(letters or self.axes, point, strict=True)
        return " ".join(f"{letter}{self.written(value, self.digits)}" for letter, value in numbers)

    def rounded(self, points):
        if np.abs(points).max(initial=0) > LARGEST:
            raise ValueError(f"items: a coordinate is above {LARGEST:g}, too large to write; shift the part")
        return np.round(points, self.digits) + 0.0

    def feed_word(self, feed):
        """The word of the feed after a space where the feed changes, else nothing."""
        word = f" F{number(feed, 6)}"
        changed, self.feed = word != self.feed, word
        return word if changed else ""

    def rapid(self, points):
        points = self.rounded(points)
        self.position = points[-1]
        return (self.rapid_word + self.words(point) for point in points.tolist())

    def straight(self, points, feed):
        points = self.rounded(points)
        moved = (np.diff(points, axis=0, prepend=self.position[None]) != 0).any(axis=1)
        self.position = points[-1]
        for point in points[moved].tolist():
            yield self.straight_word + self.words(point) + self.feed_word(feed)

    def curve(self, curve, feed):
        yield from self.straight(_pieces.chord_points(curve, self.tolerance), feed)

    def cubics(self, curve, most=np.inf):
        """The curve as polynomial cubic pieces within the tolerance, ``(m, 4, dim)``."""
        if curve.degree < 3:
            curve = curve.elevate_degree(3 - curve.degree)
        return _pieces.cubic_rows(_pieces.bezier_rows(curve), self.tolerance, most)


class Round(G1):
    """G2 and G3 where a curve is a circle or a helix within the tolerance; `others` is for the rest."""

    def curve(self, curve, feed):
        rows = _pieces.bezier_rows(curve)
        points = _pieces.evaluated(rows, np.arange(PLACES) / PLACES).reshape(-1, curve.dim)
        points = np.vstack([points, project(rows[-1:, -1])])
        within = _pieces.MARGIN * (self.tolerance or 10 * HELIX_MM)
        kept = len(rows) == 1 and self.exact(curve) and not curve.rational  # as short as an arc, and exact
        for columns in () if kept else self.planes():
            arc = circle_through(points, columns, within)
            if arc is not None and lengths(arc[0] - points[0, columns]) > LEAST_RADIUS_MM / self.unit_mm:
                yield from self.straight(points[:1], feed)
                return (yield from self.turns(points[-1], *arc, columns, feed))
        return (yield from self.others(curve, rows, feed))

    def planes(self):
        return [[self.axes.find(letter) for letter in pair] for pair in PLANES if set(pair) <= set(self.axes)]

    def turns(self, end, centre, turn, columns, feed):
        """To a point, by an angle about a centre: in whole turns, or in blocks of MOST_TURN at most."""
        start, count = self.position.copy(), round(abs(turn) / (2 * np.pi))
        if count == 0 or lengths((end - start)[columns]) > 2 * 10.0**-self.digits:
            count = int(np.ceil(abs(turn) / MOST_TURN))
        a, b = start[columns] - centre, np.array([[0, 1], [-1, 0]]) @ (centre - start[columns])
        for part in np.arange(1, count + 1) / count:
            point = start + part * (end - start)
            if part < 1:
                point[columns] = centre + np.cos(part * turn) * a + np.sin(part * turn) * b
            yield from self.arc(point, centre, turn / count, columns, feed)

    def arc(self, end, centre, turn, columns, feed):
        """A whole turn, which ends where it starts, or a part; straight where the arc is too flat."""
        (end,) = self.rounded(end[None])
        if abs(turn) > MOST_TURN:
            end[columns] = self.position[columns]
        p, q = self.position[columns], end[columns]
        radius, chord = (lengths(v) for v in (centre - p, q - p))
        flat = abs(turn) <= WHOLE or chord**2 < 8 * radius * 10.0**-self.digits
        if (flat and abs(turn) < np.pi) or radius > LARGEST:
            yield from self.straight(end[None], feed)
        else:
            yield from self.turned(end, np.array(bisecting(p, q, centre)), turn, columns, feed)

    def turned(self, end, centre, turn, columns, feed):
        if self.plane != (plane := PLANES["".join(self.axes[i] for i in columns)]):
            self.plane = plane
            yield plane
        words = " ".join(
            f"{CENTRE[self.axes[i]]}{number(value, self.digits)}"
            for i, value in sorted(zip(columns, centre - self.position[columns], strict=True))
        )
        self.position = end
        yield f"G{3 if turn > 0 else 2} {self.words(end)} {words}{self.feed_word(feed)}"


class Arcs(Round):
    """Arcs where a curve is in a plane of two axes too, straight moves elsewhere."""

    def others(self, curve, rows, feed):
        flat = np.ptp(project(rows).reshape(-1, curve.dim), axis=0) < 10.0**-self.digits
        for columns in self.planes():
            if all(flat[i] for i in range(curve.dim) if i not in columns):
                least, plane = LEAST_RADIUS_MM / self.unit_mm, rows[..., [*columns, -1]]
                ends, centres = _pieces.biarcs(plane, self.tolerance, least)
                return (yield from self._in_plane(rows, columns, ends, centres, feed))
        return (yield from G1.curve(self, curve, feed))

    def _in_plane(self, rows, columns, ends, centres, feed):
        points = np.tile(project(rows)[0, 0], (len(ends), 1))
        points[:, columns] = ends
        yield from self.straight(points[:1], feed)
        for (p, q), end, centre in zip(itertools.pairwise(ends), points[1:], centres, strict=True):
            a, b = p - centre, q - centre
            turn = np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b) if np.isfinite(centre).all() else 0.0
            yield from self.arc(end, centre, turn, columns, feed)


class LinuxCnc(G1):
    """G5.2: every rational Bezier piece is a block of its own, because a block has uniform knots."""

    degree = 3

    def curve(self, curve, feed):
        columns = [self.axes.find(letter) for letter in "XY"]
        if -1 in columns:
            raise ValueError(f"axes: G5.2 moves X and Y, got {self.axes!r}; take dialect='g1' or 'arcs'")
        others = [i for i in range(curve.dim) if i not in columns]
        if (np.ptp(curve.control_points[:, others], axis=0) > 10.0**-self.digits).any():
            raise ValueError("items: a curve leaves the plane XY; take dialect='arcs' or dialect='g1'")
        if curve.degree <= self.degree:
            rows = _pieces.bezier_rows(curve)
            points, weights = project(rows), rows[..., -1] / rows[..., -1].max(axis=1)[:, None]
        else:
            points = self.cubics(curve)
            weights = np.ones(points.shape[:2])
        yield from self.straight(points[:1, 0], feed)
        yield from self.feed_word(feed).split()
        points = self.rounded(points)
        self.position = points[-1, -1]
        for piece, weight in zip(points[..., columns], weights.tolist(), strict=True):
            yield f"G5.2 P{number(weight[0], WEIGHT_DIGITS)} L{len(piece)}"
            for point, w in zip(piece[1:], weight[1:], strict=True):
                yield f"{self.words(point, 'XY')} P{number(w, WEIGHT_DIGITS)}"
            yield "G5.3"


class Fanuc(Round):
    """G06.2: order, and in every block a knot, a control point and its weight."""

    degree = 3
    end = "M30"

    def others(self, curve, rows, feed):
        if not self.exact(curve):
            curve = _pieces.joined(self.cubics(curve))
        curve = curve.clamped()
        points = self.rounded(curve.control_points)
        yield from self.straight(points[:1], feed)
        yield from self.feed_word(feed).split()
        # Knots from zero, and about as long as the control polygon, so that rounding them moves no point.
        size = max(1.0, lengths(np.diff(curve.control_points, axis=0)).sum())
        low, high = curve.domain
        knots = np.round((curve.knots - low) * (size / (high - low)), KNOT_DIGITS)
        yield from self.blocks(curve, points, knots)
        self.position = points[-1]
        yield "G1"

    def blocks(self, curve, points, knots):
        weights = curve.weights / curve.weights.max()
        head = f"G6.2 P{curve.degree + 1} "
        for knot, point, weight in zip(knots, points, weights, strict=False):
            block = f"K{number(knot, KNOT_DIGITS)} {self.words(point)}"
            yield head + block + (f" R{number(weight, WEIGHT_DIGITS)}" if curve.rational else "")
            head = ""
        yield from (f"K{number(knot, KNOT_DIGITS)}" for knot in knots[-curve.degree - 1 :])


class Siemens(Fanuc):
    """BSPLINE: control points after the start, their weights PW, and PL, the length of a span of the knots.

    The block of the i-th control point holds the span from knot i + p - 1 to knot i + p, which is empty for
    the last p - 1. The start has the weight 1, and no weight may be larger than 3.
    """

    unit_words = "G710", "G700"  # of F too; G71 and G70 are those of lengths
    comment, length_word = "; {}", "D1 "
    name, tail, reset = "%_N_MPF{}_MPF", (), "G40"
    offsets = 54, 55, 56, 57, 505, 506  # G58 and G59 are shifts of another kind
    largest_weight = 3.0

    def exact(self, curve):
        weights = curve.clamped().weights
        return curve.degree <= self.degree and weights.max() <= self.largest_weight * weights[0]

    def blocks(self, curve, points, knots):
        head, p = f"BSPLINE SD={curve.degree} ", curve.degree
        weights, spans = curve.weights / curve.weights[0], np.diff(knots)
        for i in range(1, len(points)):
            block = f"{self.words(points[i])} PL={number(spans[i + p - 1], KNOT_DIGITS)}"
            yield head + block + (f" PW={number(weights[i], WEIGHT_DIGITS)}" if curve.rational else "")
            head = ""


class Heidenhain(Round):
    """C and CP; SPL: polynomial cubics, X(t) = K3 t^3 + K2 t^2 + K1 t + X, where t runs from 1 to 0."""

    unit_words = "MM", "INCH"
    comment, end = "; {}", "M30"
    straight_word = rapid_word = "L "
    written = staticmethod(_signed)
    degree = 3
    largest = 9.9  # of a K without an exponent, less what rounding adds
    name = "NURBS_LAB"

    def exact(self, curve):
        return curve.degree <= self.degree and not curve.rational

    def begin(self, title):
        yield f"BEGIN PGM {self.name} {self.unit_word}"
        yield self.comment.format(title)
        if setup := self.setup:
            high = _signed(setup.safe_z_mm / self.unit_mm, self.digits)
            yield f"TOOL CALL {setup.tool} Z S{number(setup.spindle_rpm, 3)}"
            yield f"L Z{high} R0 FMAX M{3 if setup.clockwise else 4}"
            yield from COOLANTS[setup.coolant]

    def finish(self):
        yield from (*self.shut_down(), self.end, f"END PGM {self.name} {self.unit_word}")

    def numbered(self, lines):
        count, before = 0, ""
        for line in lines:
            goes_on = before.endswith("~")
            yield line if goes_on else f"{count} {line}"
            count, before = count + (not goes_on), line

    def feed_word(self, feed):
        tenths = 10 if self.unit_word == "INCH" else 1  # F is in tenths of an inch
        return super().feed_word(tenths * feed)

    def rapid(self, points):
        self.feed = "FMAX"
        return (f"{line} FMAX" for line in super().rapid(points))

    def turned(self, end, centre, turn, columns, feed):
        """About the written pole: C to its end, or CP by an angle, which may miss it by rounding."""
        letters, (centre,) = [self.axes[i] for i in columns], self.rounded(centre[None])
        yield f"CC {self.words(centre, letters)}"
        rise = [i for i in range(len(end)) if i not in columns and end[i] != self.position[i]]
        where = f"C {self.words(end[columns], letters)}"
        if rise:
            where = f"CP IPA{_signed(np.degrees(turn))} {self.words(end[rise], [self.axes[i] for i in rise])}"
            (x, y), end = self.position[columns] - centre, end.copy()
            end[columns] = centre + np.cos(turn) * np.array([x, y]) + np.sin(turn) * np.array([-y, x])
        (self.position,) = self.rounded(end[None])
        yield f"{where} DR{'+' if turn > 0 else '-'}{self.feed_word(feed)}"

    def others(self, curve, rows, feed):
        pieces = self.cubics(curve, most=self.largest)
        yield from self.straight(pieces[:1, 0], feed)
        pieces += np.repeat(self.rounded(pieces[:, [0, 3]]) - pieces[:, [0, 3]], 2, axis=1)
        for piece, (end, *powers) in zip(pieces, _pieces.power_coefficients(pieces), strict=True):
            lines = [f"SPL {self.words(end)}"]
            for i, axis in enumerate(self.axes):
                lines.append(" ".join(f"K{n}{axis}{_signed(powers[n - 1][i])}" for n in (3, 2, 1)))
            lines[-1] += self.feed_word(feed)
            self.position = piece[-1]
            yield from " ~\n".join(lines).split("\n")


DIALECTS = {"g1": G1, "arcs": Arcs, "linuxcnc": LinuxCnc, "siemens": Siemens, "fanuc": Fanuc}
DIALECTS["heidenhain"] = Heidenhain
