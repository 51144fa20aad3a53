"""Order of the passes, and the way from one to the next: links, ramps into material, rapid moves above it."""

import itertools
import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import BSpline

from nurbs_lab.common.checks import as_choice, as_kind, as_positive, lengths
from nurbs_lab.machining._kernels_order import nearest_first
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.program import TOGETHER_MM, Feeds, Move, Program
from nurbs_lab.machining.simulate import warned
from nurbs_lab.machining.stock import Material
from nurbs_lab.motion import Limits
from nurbs_lab.nurbs.curve import trusted_curve

# Lengths of this module are in diameters of the cutter.
NEAR = 6.0  # gap up to which the tool stays down between two passes
BESIDE = 0.5  # gap up to which a link may cut its way through material, as the passes beside it do
DROP = 0.1  # by which the tool may go down in material without a ramp
LIFTS = (0.0, 0.02, 0.05, 0.15, 0.5)  # heights of a link, tried in this order
LEAD = 0.15  # length of lead-in and lead-out
UP = 0.2  # height of a lead, and of a rapid move above the material and the part
LOW = 5.0  # longer rapid moves travel at the safe height
ASIDE = (0.6, 1.2, 2.0)  # lengths of a level way into material from beside it
TURNS = np.radians([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])  # and directions
CLOSE = 0.005  # between places at which that is checked
RAMP = 3.0  # longest leg of a ramp, which goes back and forth above the beginning of its pass
MOST_LEGS = 80  # of a ramp; a pass too short for its angle has a steeper one
CHECKS = 49  # points of a link that are checked for collision
_T = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, CHECKS))  # denser at the ends, near the part


@cache
def _knots(count):
    """Degree and clamped even knots for so many control points: a cubic, or a line through two."""
    degree = min(count - 1, 3)
    return degree, np.concatenate([[0.0] * degree, np.linspace(0.0, 1.0, count - degree + 1), [1.0] * degree])


_BASIS = {count: BSpline(_knots(count)[1], np.eye(count), 3)(_T) for count in (4, 6)}


@dataclass(frozen=True, eq=False)
class Ways:
    """What decides how the tool gets from one pass to the next.

    Attributes
    ----------
    bare : Contact
        Of the part with the cutter and a margin.
    material : Material
        It is cut as the moves are made.
    floor, safe_height : float
        Heights in mm: of the lowest tip, of rapid moves above everything.
    feeds : Feeds
    direction : {"both", "climb", "conventional"}
    machine : Limits
    """

    bare: Contact
    material: Material
    floor: float
    safe_height: float
    feeds: Feeds
    direction: str
    machine: Limits

    def ordered(self, paths):
        """Paths in an order of short ways between them, with the material on the side asked for.

        Of a waterline it is on the left as made. Paths that may be cut either way are turned round for a
        shorter way.
        """
        if not paths:
            return paths
        free = np.array([path.free(self.direction) for path in paths])
        if self.direction != "conventional":
            paths = [path if either else path.reversed() for path, either in zip(paths, free, strict=True)]
        ends = np.array([path.points[[0, -1]] for path in paths])
        order, turned = nearest_first(ends, free)
        return [paths[i].reversed() if back else paths[i] for i, back in zip(order, turned, strict=True)]

    def program(self, paths, tolerance, stock) -> Program:
        """The program that cuts the paths in this order from a stock."""
        cutter = self.material.cutter
        return warned(Program(self.moves(paths), cutter, self.machine, tolerance, stock))

    def moves(self, paths) -> tuple[Move, ...]:
        """The moves that cut the paths in the order given.

        A pass that begins near the end of the one before is reached by a cubic spline with the tangents of
        both, lifted until it neither gouges nor touches material. Close to the pass before it may cut its way
        on the part as a pass does, and then counts as a cut. Otherwise the tool leaves along a tangential
        lead-out that turns upwards, makes rapid moves above part and material, and comes down along a
        tangential lead-in, or, where there is material, on a ramp above the beginning of the pass.
        """
        curves = [path.curve for path in paths]
        starts, out = _with_tangents(curves, 0, 1, 1.0), _with_tangents(curves, -1, -2, -1.0)
        links = self._free_links(out[:-1], starts[1:])
        ins, outs = self._leads(starts, -1.0), self._leads(out, 1.0)
        moves, last = [], None
        for i, curve in enumerate(curves):
            made = self._linked(links[i - 1]) if i else None
            if made is None:
                if i:
                    moves.append(self._lead_out(outs[i - 1]))
                    last = moves[-1].curve.control_points[-1]
                made = self._entry(curve, ins[i])
                moves += self._rapids(last, made[0].curve.control_points[0])
            made.append(Move("cut", curve, self.feeds.cut))
            for move in made:
                if move.kind != "link":
                    self.material.cut(move.curve)
            moves += made
        moves.append(self._lead_out(outs[-1]))
        last = moves[-1].curve.control_points[-1]
        return (*moves, *self._legs((last, (*last[:2], self.safe_height))))

    def _free_links(self, out, starts):
        """For each gap the links that keep off the part, lowest first: control points ``(tries, 6, 3)``.

        None where the gap is wide or no height is enough.
        """
        size = self.size
        gaps, found = lengths(starts[:, 0] - out[:, 0]), [None] * len(out)
        near = np.flatnonzero(gaps < NEAR * size)
        rows = _link_rows(out[near], starts[near], size)
        for i, row, first in zip(near, rows, self._first_free(rows), strict=True):
            if first >= 0:
                found[i] = row[first:]
        return found

    def _linked(self, rows):
        """Moves along the first of these links that touches no material, or that cuts as a pass does."""
        if rows is None:
            return None
        for row in rows:
            link = _spline(row)
            if self.material.clear(self.material.along(link)):
                return [Move("link", link, self.feeds.link)]
        tips = np.einsum("sk,kd->sd", _BASIS[6], rows[0])
        size = self.size
        sinks = np.maximum(-np.diff(tips[:, 2]), 0.0).sum()
        if math.dist(rows[0][0], rows[0][-1]) > BESIDE * size or sinks > DROP * size:
            return None
        return [Move("cut", _spline(rows[0]), self.feeds.cut)]

    @property
    def size(self):
        """Diameter of the cutter."""
        return self.material.cutter.diameter

    def _leads(self, ends, side):
        """Lead-in (``side`` -1) or lead-out (1): tangential to the pass at the part, vertical in the air."""
        size = self.size
        p, up = ends[:, None, 0], np.array([0.0, 0.0, UP * size])
        along = side * LEAD * size * ends[:, None, 1] * [[1.0], [0.0]]  # the second goes straight up
        first = p + along / 2 + up * [[0.0], [0.25]]
        rows = np.stack([p + 0.0 * along, first, p + along + up / 2, p + along + up], axis=2)
        rows = rows if side > 0 else rows[:, :, ::-1]
        return [row[first:] for row, first in zip(rows, self._first_free(rows), strict=True)]

    def _lead_out(self, rows):
        """The first of these ways up that touches no material; straight up at last."""
        for row in rows[:-1]:
            if self.material.clear(self.material.along(_spline(row))):
                break
        else:
            row = rows[-1]
        return Move("link", _spline(row), self.feeds.link)

    def _entry(self, curve, rows):
        """Moves down to the beginning of a pass: a lead-in where there is no material, otherwise a ramp."""
        for row in rows:
            tips = np.einsum("sk,kd->sd", _BASIS[4], row)
            if (self.material.rest(tips[:, :2]) <= tips[:, 2] + DROP * self.size * _T).all():
                if self.material.clear(tips):
                    return [Move("link", _spline(row), self.feeds.link)]
                return [Move("plunge", _spline(row), self.feeds.plunge)]
        return self._aside(curve) or self._ramp(curve)

    def _aside(self, curve):
        """A level way into material from a place beside it, first along the pass; None if there is none."""
        begin, then = curve.control_points[:2]
        ahead = math.atan2(then[1] - begin[1], then[0] - begin[0])
        for length, turn in itertools.product(ASIDE, TURNS):
            x, y = math.cos(ahead + turn), math.sin(ahead + turn)
            start = begin - length * self.size * np.array([x, y, 0.0])
            if self.material.clear(start[None]):
                tips = start + np.linspace(0.0, 1.0, int(length / CLOSE) + 1)[:, None] * (begin - start)
                tips = np.concatenate([tips[::16], tips])  # most ways that collide do so at the first few
                if not self.bare.collides(tips[None])[0]:
                    above = start + np.array([0.0, 0.0, UP * self.size])
                    down = Move("link", _spline((above, start)), self.feeds.link)
                    return [down, Move("cut", _spline((start, begin)), self.feeds.cut)]
        return None

    def _ramp(self, curve):
        """Way down to the beginning of a pass, back and forth above it, no steeper than the ramp's angle."""
        size, (u0, u1) = self.size, curve.domain
        length = min(RAMP * size, 0.9 * (u1 - u0))  # the parameter is nearly the length
        leg = curve.split(u0 + length)[0]
        tips = self.material.along(leg)
        height = max(float((self.material.rest(tips[:, :2]) - tips[:, 2]).max()), 0.0) + 0.5 * DROP * size
        count = 2 * math.ceil(height / (2.0 * length * math.tan(self.feeds.ramp_angle)))
        count = min(max(count, 2), MOST_LEGS)
        along = np.array([leg.knots[i : i + 3].mean() for i in range(1, len(leg.control_points) + 1)])
        along, moves = (along - leg.domain[0]) / (leg.domain[1] - leg.domain[0]), []
        for k in range(count):
            part = along if k % 2 == 0 else 1.0 - along
            lift = height * (1.0 - (k + part) / count)
            control = leg.control_points + np.column_stack([np.zeros((len(along), 2)), lift])
            one = trusted_curve(3, leg.knots.copy(), control)
            moves.append(Move("plunge", one if k % 2 == 0 else one.reverse(), self.feeds.plunge))
        begin = moves[0].curve.control_points[0]
        top = begin + np.array([0.0, 0.0, UP * size])
        return [Move("plunge", _spline((top, begin)), self.feeds.plunge), *moves]

    def _rapids(self, last, begin):
        """Rapid moves from where the tool is, up, across and down to ``begin``; at first from safe height."""
        top = self.safe_height
        if last is None:
            return self._legs(((*begin[:2], top), begin))
        size = math.dist(last[:2], begin[:2])
        if size < LOW * self.size:
            count = int(2.0 * size / self.material.field.step) + 2
            xy = last[:2] + np.linspace(0.0, 1.0, count)[:, None] * (begin - last)[:2]
            under = max(self.bare.heights(xy).max(), self.material.rest(xy).max()) + UP * self.size
            top = min(max(under, last[2], begin[2]), top)
        return self._legs((last, (*last[:2], top), (*begin[:2], top), begin))

    def _legs(self, way):
        legs = [leg for leg in itertools.pairwise(way) if math.dist(*leg) > TOGETHER_MM]
        return [Move("rapid", _spline(leg), self.machine.speed) for leg in legs]

    def _first_free(self, candidates):
        """Number of the first safe curve in each row of candidates ``(n, tries, count, 3)``, -1 if none is.

        A safe curve does not collide with the part and does not dip below the floor.
        """
        n, tries, count, _ = candidates.shape
        chosen, open_ = np.full(n, -1), np.arange(n)
        for k in range(tries):
            points = np.einsum("sk,nkd->nsd", _BASIS[count], candidates[open_, k])
            low = (points[..., 2] < self.floor - TOGETHER_MM).any(axis=1)
            hit = low | self.bare.collides(points)
            chosen[open_[~hit]] = k
            open_ = open_[hit]
        return chosen


def ways_over(bare, material, floor, top, feed, clearance, direction, machine) -> Ways:
    """The `Ways` above part and stock, with heights up to ``top``, for arguments of `finish` and `rough`."""
    as_choice("direction", direction, ("both", "climb", "conventional"))
    feeds = feed if isinstance(feed, Feeds) else Feeds(as_positive("feed", feed))
    clearance = material.cutter.diameter if clearance is None else as_positive("clearance", clearance)
    machine = as_kind("machine", machine, Limits)
    return Ways(bare, material, floor, top + clearance, feeds, direction, machine)


def _with_tangents(curves, end, next_to_it, sign):
    """Point and unit tangent at one end of every curve, ``(n, 2, 3)``."""
    points = np.array([curve.control_points[end] for curve in curves])
    along = sign * (np.array([curve.control_points[next_to_it] for curve in curves]) - points)
    return np.stack([points, along / lengths(along)[:, None]], axis=1)


def _spline(points):
    return trusted_curve(*_knots(len(points)), np.array(points))


def _link_rows(out, starts, size):
    """Splines from each end to the next start with the tangents of both, one for each lift."""
    lifts = size * np.array(LIFTS)
    p, q = out[:, 0], starts[:, 0]
    tangents = np.stack([out[:, 1], starts[:, 1]], axis=1)
    gap, ahead = lengths(q - p), np.einsum("ni,nti->nt", q - p, tangents).min(axis=1)
    # no longer than a way straight ahead, or it would go back; a way that turns needs room
    reach = np.where(ahead > 0.5 * gap, gap, np.maximum(gap, lifts[1]))[:, None] / 7.0
    along, into = reach * out[:, 1], reach * starts[:, 1]
    rows = np.stack([p, p + along, p + 3.0 * along, q - 3.0 * into, q - into, q], axis=1)
    tries = np.repeat(rows[:, None], len(lifts), axis=1)
    straight_back = ahead <= -0.99 * gap  # without a lift, C' would vanish where it turns
    tries[:, :, 2:4, 2] += np.where(straight_back[:, None], np.maximum(lifts, lifts[1]), lifts)[:, :, None]
    return tries
