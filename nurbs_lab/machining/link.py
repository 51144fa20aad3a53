"""Order of the passes, and the way from one to the next: links, ramps into material, rapid moves above it."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from nurbs_lab.common.checks import as_kind, as_positive, lengths
from nurbs_lab.machining._kernels_order import nearest_first
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.part import SINGLE
from nurbs_lab.machining.program import TOGETHER_MM, Move, Program
from nurbs_lab.machining.simulate import warned
from nurbs_lab.machining.stock import HALF, Material
from nurbs_lab.motion import Limits
from nurbs_lab.nurbs.curve import trusted_curve

# Lengths of this module are in diameters of the cutter.
NEAR = 2.0  # gap up to which the tool stays down between two passes, and longest leg of a ramp
UP = 0.1  # height to which the tool leaves the part, of rapid moves above all, and of cuts without a ramp
SAFE = 1.0  # height above the part and the stock, at first and at last
ASIDE = (0.6, 1.2, 2.0)  # lengths of a level way into material from beside it
TURNS = np.radians([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])  # and directions
CLOSE = 0.005  # between places at which that is checked
PLUNGE = 1.0 / 3.0  # fraction of the feed: that of ways down into material
RAMP_SLOPE = math.tan(math.radians(5.0))  # of a ramp, at most
MOST_LEGS = 80  # of a ramp; a pass too short for its angle has a steeper one
RIM = 0.25  # so near the rim of the cutter, material is milled off on a way straight down
RAISES = 289  # points of a link, denser at its ends, at which it is raised over the part
_LINE, _LINK = [0.0, 0.0, 1.0, 1.0], [0.0] * 4 + [1 / 3, 2 / 3] + [1.0] * 4
_BASIS = BSpline(_LINK, np.eye(6), 3)(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, RAISES)))
_STRAIGHT = np.array([0.0, 0.001, 1 / 3, 2 / 3, 0.999, 1.0])  # up at once and down at last, if raised


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
    feed : float
        Of cuts and of links.
    machine : Limits
    """

    bare: Contact
    material: Material
    floor: float
    safe_height: float
    feed: float
    machine: Limits

    def ordered(self, paths):
        """Paths in an order of short ways between them.

        Closed waterlines climb: they have the material on their right, and on their left as made. The other
        paths are turned round for a shorter way.
        """
        if not paths:
            return paths
        paths = [path.reversed() if path.closed else path for path in paths]
        ends = np.array([path.points[[0, -1]] for path in paths])
        order, turned = nearest_first(ends, np.array([not path.closed for path in paths]))
        return [paths[i].reversed() if back else paths[i] for i, back in zip(order, turned, strict=True)]

    def program(self, paths, tolerance, stock, warnings=()) -> Program:
        """The program that cuts the paths in this order from a stock."""
        moves, cutter = self.moves(paths), self.material.cutter
        return warned(Program(moves, cutter, self.machine, tolerance, stock, warnings), self.floor)

    def moves(self, paths) -> tuple[Move, ...]:
        """The moves that cut the paths in the order given.

        To a pass that begins near the end of the one before, the tool stays down on the part and cuts as on a
        pass, along a cubic spline with the tangents of both or a straight one, raised over the part; a way
        down of more than a tenth of the diameter into material is a plunge. Otherwise the tool leaves
        straight up, makes rapid moves above part and material, and comes straight down, or, where its core
        would meet material, from a free place beside it or on a ramp above the beginning of the pass.
        """
        curves = [path.curve for path in paths]
        starts, out = _with_tangents(curves, 0, 1, 1.0), _with_tangents(curves, -1, -2, -1.0)
        links = self._links(out[:-1], starts[1:])
        moves, last, up = [], None, np.array([0.0, 0.0, UP * self.size])
        rim = -HALF * self.material.field.step
        for curve, end, link in zip(curves, out[:, 0], [None, *links], strict=True):
            made = [link]
            if link is None:
                if last is not None:
                    moves.append(Move("link", _spline((last, last + up)), self.feed))
                    last = last + up
                made = self._entry(curve, up)
                moves += self._rapids(last, made[0].curve.control_points[0])
            for move in (*made, Move("cut", curve, self.feed)):
                if move.kind == "plunge" and self._deep(move.curve, rim) <= up[2]:
                    move = Move("cut", move.curve, self.feed)
                if move.kind != "link":
                    self.material.cut(move.curve)
                moves.append(move)
            last = end
        moves.append(Move("link", _spline((last, last + up)), self.feed))
        return (*moves, *self._legs((last + up, (*last[:2], self.safe_height))))

    @property
    def size(self):
        """Diameter of the cutter."""
        return self.material.cutter.diameter

    def _deep(self, curve, wider=None):
        """How far above a curve the tip meets no material, as `Material.rest` has it, in mm."""
        return self._over(self.material.along(curve), wider)

    def _over(self, tips, wider=None):
        """How far above tips ``(n, 3)`` they meet no material, in mm."""
        return float((self.material.rest(tips[:, :2], wider) - tips[:, 2]).max())

    def _links(self, out, starts):
        """For each gap the move along the part from pass to pass; None where it is wide or deep."""
        found, gaps = [None] * len(out), lengths(starts[:, 0] - out[:, 0])
        near = np.flatnonzero((gaps > TOGETHER_MM) & (gaps <= NEAR * self.size))
        gentle = UP * self.size
        for way, raised in ((_smooth, [0, 0, 1, 1, 0, 0]), (_straight, [0, 1, 1, 1, 1, 0])):
            rows = self._raised(way(out[near], starts[near]), np.array(raised, float))
            sinks = np.maximum(-np.diff(rows[..., 2] @ _BASIS.T), 0.0).sum(axis=-1)
            good = sinks <= max(gentle, self.material.cutter.corner_radius)
            for i in np.flatnonzero(good):
                kind, share = ("cut", 1.0) if sinks[i] <= gentle else ("plunge", PLUNGE)
                found[near[i]] = Move(kind, _spline(rows[i]), share * self.feed)
            near = near[~good]
        return found

    def _raised(self, rows, raised):
        """Links ``(n, 6, 3)`` of which the points marked by ``raised`` are raised over part and floor."""
        tips = _BASIS @ rows
        least = np.maximum(tips[..., 2], self.floor)
        over = self.bare.heights(tips[..., :2].reshape(-1, 2), least.ravel()).reshape(least.shape)
        lift = ((over - tips[..., 2]) / np.maximum(_BASIS @ raised, 1e-9)).max(axis=-1)
        lift[lift > 0.0] += self.bare.allowance
        rows[..., 2] += lift[:, None] * raised
        return rows

    def _entry(self, curve, up):
        """Moves to the beginning of a pass: straight down, from beside it or on a ramp, by the material."""
        begin = curve.control_points[:1]
        beside = self._aside(curve, up) if self._over(begin) > up[2] else []
        inside = self._over(begin, -RIM * self.size) > up[2]  # its core
        return beside or (self._ramp(curve, up) if inside else [self._down(begin[0], up)])

    def _down(self, begin, up):
        """The way straight down to a place, from where the cutter meets nothing."""
        deep = self._over(begin[None])
        kind, feed = ("link", self.feed) if deep <= 0.0 else ("plunge", PLUNGE * self.feed)
        return Move(kind, _spline((begin + max(up[2], deep) * np.eye(3)[2], begin)), feed)

    def _aside(self, curve, up):
        """A level way into material from a place beside it, first along the pass; none if there is none."""
        begin, then = curve.control_points[:2]
        ahead = math.atan2(then[1] - begin[1], then[0] - begin[0])
        for length, turn in itertools.product(ASIDE, TURNS):
            x, y = math.cos(ahead + turn), math.sin(ahead + turn)
            start = begin - length * self.size * np.array([x, y, 0.0])
            if self.material.rest(start[None, :2])[0] <= start[2]:
                tips = start + np.linspace(0.0, 1.0, int(length / CLOSE) + 1)[:, None] * (begin - start)
                tips = np.concatenate([tips[::16], tips])  # most ways that collide do so at the first few
                if not self.bare.strays(tips, np.array([0, len(tips)]))[0]:
                    down = Move("link", _spline((start + up, start)), self.feed)
                    return [down, Move("cut", _spline((start, begin)), self.feed)]
        return []

    def _ramp(self, curve, up):
        """Way down to the beginning of a pass, back and forth above it, no steeper than the ramp's slope."""
        size, (u0, u1) = self.size, curve.domain
        length = min(NEAR * size, 0.9 * (u1 - u0))  # the parameter is nearly the length
        leg = curve.split(u0 + length)[0]
        height = max(self._deep(leg, -RIM * self.size), 0.0) + 0.5 * up[2]
        count = min(2 * math.ceil(height / (2.0 * length * RAMP_SLOPE)), MOST_LEGS)
        along = np.array([leg.knots[i : i + 3].mean() for i in range(1, len(leg.control_points) + 1)])
        along, curves = (along - leg.domain[0]) / (leg.domain[1] - leg.domain[0]), []
        for k in range(count):
            part = along if k % 2 == 0 else 1.0 - along
            lift = height * (1.0 - (k + part) / count)
            control = leg.control_points + np.column_stack([np.zeros((len(along), 2)), lift])
            one = trusted_curve(3, leg.knots.copy(), control)
            curves.append(one if k % 2 == 0 else one.reverse())
        legs = [Move("plunge", one, PLUNGE * self.feed) for one in curves]
        return [self._down(curves[0].control_points[0], up), *legs]

    def _rapids(self, last, begin):
        """Rapid moves from where the tool is, up, across and down to ``begin``; at first from safe height."""
        top = self.safe_height
        if last is None:
            return self._legs(((*begin[:2], top), begin))
        count = int(2.0 * math.dist(last[:2], begin[:2]) / self.material.field.step) + 2
        xy = last[:2] + np.linspace(0.0, 1.0, count)[:, None] * (begin - last)[:2]
        under = max(self.bare.heights(xy).max(), self.material.rest(xy).max()) + UP * self.size
        top = max(under, last[2], begin[2])
        return self._legs((last, (*last[:2], top), (*begin[:2], top), begin))

    def _legs(self, way):
        legs = [leg for leg in itertools.pairwise(way) if math.dist(*leg) > TOGETHER_MM]
        return [Move("rapid", _spline(leg), self.machine.speed) for leg in legs]


def ways_over(bare, material, floor, top, feed, machine) -> Ways:
    """The `Ways` above part and stock, which are no higher than ``top``."""
    safe = top + SAFE * material.cutter.diameter
    machine, feed = as_kind("machine", machine, Limits), as_positive("feed", feed)
    if feed < (least := SINGLE * machine.speed):
        raise ValueError(f"feed must be at least {least:g} mm/s, a millionth of machine.speed, got {feed:g}")
    return Ways(bare, material, floor, safe, feed, machine)


def _with_tangents(curves, end, next_to_it, sign):
    """Point and unit tangent at one end of every curve, ``(n, 2, 3)``."""
    points = np.array([curve.control_points[end] for curve in curves])
    along = sign * (np.array([curve.control_points[next_to_it] for curve in curves]) - points)
    return np.stack([points, along / lengths(along)[:, None]], axis=1)


def _spline(points):
    """A line from one point to another, or a link of six control points."""
    degree, knots = (1, _LINE) if len(points) == 2 else (3, _LINK)
    return trusted_curve(degree, np.array(knots), np.array(points))


def _smooth(out, starts):
    """A way from each end to the next start, tangent to both, ``(n, 6, 3)``; straight where it turns back."""
    p, q = out[:, 0], starts[:, 0]
    along, into = (lengths(q - p)[:, None] / 7.0 * ends[:, 1] for ends in (out, starts))
    rows = np.stack([p, p + along, p + 3.0 * along, q - 3.0 * into, q - into, q], axis=1)
    ahead = np.minimum(*(((q - p) * ends[:, 1]).sum(axis=1) for ends in (out, starts)))
    back = ahead <= -0.99 * lengths(q - p)  # C' would vanish where it turns
    rows[back] = _straight(out[back], starts[back])
    return rows


def _straight(out, starts):
    """A straight way from each end to the next start, ``(n, 6, 3)``."""
    p, q = out[:, 0], starts[:, 0]
    return p[:, None] + _STRAIGHT[:, None] * (q - p)[:, None]
