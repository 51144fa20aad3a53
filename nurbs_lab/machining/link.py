"""Order of the passes, links between them, and rapid moves at a safe height."""

import itertools
import math
from functools import cache

import numpy as np
from scipy.interpolate import BSpline

from nurbs_lab.common.checks import lengths
from nurbs_lab.machining import _kernels_order
from nurbs_lab.machining.program import TOGETHER_MM, Move
from nurbs_lab.nurbs.curve import trusted_curve

NEAR_MM = 4.0  # mm: a pass that begins this close to the end of the last one is linked without a rapid move
LIFTS = (0.0, 0.1, 0.3, 1.0, 3.0)  # mm: heights of a link, tried in this order
LEADS = (2.0, 1.0, 0.5, 0.0)  # mm: lengths of lead-in and lead-out, tried in this order
UP_MM = 2.0  # mm: height of a lead
TURN_MM = 0.2  # mm: a link that turns takes at least the room of one of this length
SHORT_MM = 16.0  # mm: longer rapid moves travel at the safe height
CHECKS = 49  # points of a link that are checked for collision
_T = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, CHECKS))  # denser at the ends, near the part


@cache
def _knots(count):
    """Degree and clamped even knots for so many control points: a cubic, or a line through two."""
    degree = min(count - 1, 3)
    return degree, np.concatenate([[0.0] * degree, np.linspace(0.0, 1.0, count - degree + 1), [1.0] * degree])


_BASIS = {count: BSpline(_knots(count)[1], np.eye(count), 3)(_T) for count in (4, 6)}


def link(paths, bare, floor, safe_height, feed, machine, direction, through_stock=False) -> tuple[Move, ...]:
    """The moves of a program that cuts all passes.

    A pass that begins near the end of the one before is reached by a cubic spline with the tangents of both,
    lifted if it would gouge or dip below the floor. Otherwise the tool leaves along a tangential lead-out
    that turns upwards, makes a rapid move above everything in between, and comes down along a tangential
    lead-in. With ``through_stock`` the passes keep their order and all rapid moves travel at the safe height,
    because material other than the part may be in the way.
    """
    if direction == "climb":  # waterlines have the material on their left
        paths = [path if path.level is None else path.reversed() for path in paths]
    if not through_stock:
        paths = _ordered(paths)
    curves = [path.curve() for path in paths]
    starts, out = _with_tangents(curves, 0, 1, 1.0), _with_tangents(curves, -1, -2, -1.0)
    gaps = np.linalg.norm(starts[1:, 0] - out[:-1, 0], axis=1)
    near = np.flatnonzero(gaps < NEAR_MM)
    links = dict(zip(near, _links(bare, floor, out[near], starts[near + 1]), strict=True))
    alone = np.array([i for i in range(-1, len(curves)) if links.get(i) is None])
    ins = dict(zip(alone[:-1] + 1, _leads(bare, floor, starts[alone[:-1] + 1], -1.0), strict=True))
    outs = dict(zip(alone[1:], _leads(bare, floor, out[alone[1:]], 1.0), strict=True))
    tops = dict.fromkeys(ins, safe_height) if through_stock else _tops(bare, outs, ins, safe_height)
    moves, last = [], None
    for i, curve in enumerate(curves):
        if i in ins:
            begin = ins[i].control_points[0]
            top = tops[i] if i else safe_height
            way = [(*begin[:2], top), begin]
            if i:
                way = [last, (*last[:2], top), *way]
            legs = [leg for leg in itertools.pairwise(way) if math.dist(*leg) > TOGETHER_MM]
            moves += [Move("rapid", _spline(leg), machine.rapid_speed) for leg in legs]
            if through_stock:
                moves[-1] = Move("plunge", _spline(legs[-1]), feed)
            moves.append(Move("plunge", ins[i], feed))
        moves.append(Move("cut", curve, feed))
        if i in outs or i in links:
            moves.append(Move("link", outs[i] if i in outs else links[i], feed))
        last = moves[-1].curve.control_points[-1]
    moves.append(Move("rapid", _spline((last, (*last[:2], safe_height))), machine.rapid_speed))
    return tuple(moves)


def _ordered(paths):
    ends = np.array([path.points[[0, -1]] for path in paths])
    order, turned = _kernels_order.nearest_first(ends, np.array([path.level is None for path in paths]))
    return [paths[i].reversed() if back else paths[i] for i, back in zip(order, turned, strict=True)]


def _with_tangents(curves, end, next_to_it, sign):
    """Point and unit tangent at one end of every curve, ``(n, 2, 3)``."""
    points = np.array([curve.control_points[end] for curve in curves])
    along = sign * (np.array([curve.control_points[next_to_it] for curve in curves]) - points)
    return np.stack([points, along / lengths(along)[:, None]], axis=1)


def _spline(points):
    return trusted_curve(*_knots(len(points)), np.array(points))


def _first_free(bare, floor, candidates):
    """For each row of candidates ``(n, tries, count, 3)`` the first that is safe, else None.

    A safe curve does not collide with the part and does not dip below the floor.
    """
    n, tries, count, _ = candidates.shape
    chosen, open_ = [None] * n, np.arange(n)
    for k in range(tries):
        points = np.einsum("sk,nkd->nsd", _BASIS[count], candidates[open_, k])
        low = (points[..., 2] < floor - TOGETHER_MM).any(axis=1)
        hit = low | bare.collides(points)
        for i in open_[~hit]:
            chosen[i] = _spline(candidates[i, k])
        open_ = open_[hit]
    return chosen


def _links(bare, floor, out, starts):
    """A spline from each end to the next start with the tangents of both, None where none is safe."""
    p, q = out[:, 0], starts[:, 0]
    tangents = np.stack([out[:, 1], starts[:, 1]], axis=1)
    gap, ahead = lengths(q - p), np.einsum("ni,nti->nt", q - p, tangents).min(axis=1)
    # no longer than a way straight ahead, or it would go back; a way that turns needs room
    reach = np.where(ahead > 0.5 * gap, gap, np.maximum(gap, TURN_MM))[:, None] / 7.0
    along, into = reach * out[:, 1], reach * starts[:, 1]
    rows = np.stack([p, p + along, p + 3.0 * along, q - 3.0 * into, q - into, q], axis=1)
    tries = np.repeat(rows[:, None], len(LIFTS), axis=1)
    straight_back = ahead <= -0.99 * gap  # without a lift, C' would vanish where it turns
    tries[:, :, 2:4, 2] += np.where(straight_back[:, None], np.maximum(LIFTS, LIFTS[1]), LIFTS)[:, :, None]
    return _first_free(bare, floor, tries)


def _leads(bare, floor, ends, side):
    """Lead-in (``side`` -1) or lead-out (1): tangential to the pass at the part, vertical in the air."""
    lead = np.array(LEADS)[None, :, None]
    p, along = ends[:, None, 0], side * ends[:, None, 1] * lead
    up = np.array([0.0, 0.0, UP_MM])
    first = p + along / 2 + np.where(lead > 0.0, 0.0, up / 4)
    rows = np.stack([np.broadcast_to(p, along.shape), first, p + along + up / 2, p + along + up], axis=2)
    rows = rows if side > 0 else rows[:, :, ::-1]
    found = _first_free(bare, floor, rows)
    return [lead if lead is not None else _spline(row[-1]) for lead, row in zip(found, rows, strict=True)]


def _tops(bare, outs, ins, safe_height):
    """Height of the rapid move to each pass that is reached by one, by the number of the pass."""
    tops = dict.fromkeys(ins, safe_height)
    numbers = np.array([i for i in ins if i > 0], int)
    ends = [(outs[i - 1].control_points[-1], ins[i].control_points[0]) for i in numbers]
    ways = np.reshape(ends, (-1, 2, 3))
    short = lengths(ways[:, 1, :2] - ways[:, 0, :2]) < SHORT_MM
    ways = ways[short]
    t = np.linspace(0.0, 1.0, CHECKS)[:, None]
    places = ways[:, None, 0, :2] + t * (ways[:, None, 1, :2] - ways[:, None, 0, :2])
    under = bare.heights(places.reshape(-1, 2)).reshape(-1, CHECKS).max(axis=1) + UP_MM
    under = np.clip(under, ways[:, :, 2].max(axis=1), safe_height)
    tops.update(zip(numbers[short].tolist(), under.tolist(), strict=True))
    return tops
