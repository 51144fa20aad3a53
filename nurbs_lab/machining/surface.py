"""Samples of a part's surface: which of them a cutter reaches, and how much a program leaves there."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import maximum_filter

from nurbs_lab.common.box_tree import order_along, tree_along
from nurbs_lab.common.checks import lengths
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining._kernels_contact import ROUNDING
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import NEEDLE, Contact, contact
from nurbs_lab.machining.field import empty_field, require_size
from nurbs_lab.machining.part import SINGLE
from nurbs_lab.machining.program import TOGETHER_MM

MOST_SAMPLES = 1e7
ROBERTS = np.array([[0.7548776662466927], [0.5698402909980532]])  # 1 / g and 1 / g**2, g**3 = g + 1
VALLEY = 1.0  # steps of a grid: so much lower a tip near a node is in a valley that the grid misses


@dataclass(frozen=True, eq=False)
class Samples:
    """Points ``(n, 3)`` on the part outside its undercuts, and their normals.

    Each represents the area ``share``; ``undercut`` is the area of the undercuts.
    """

    points: np.ndarray
    normals: np.ndarray
    share: float
    undercut: float

    def __getitem__(self, chosen):
        return Samples(self.points[chosen], self.normals[chosen], self.share, self.undercut)


def sample_surface(part, spacing) -> Samples:
    """Samples outside undercuts, each for an area of ``spacing`` squared or less.

    They follow one another in equal steps of the area along the triangles, in an order in which neighbours
    are close together. Inside the triangles they are points of Roberts' sequence R2.
    """
    corners, outward = part.tree.corners.reshape(-1, 3, 3), -1.0 if part.volume < 0.0 else 1.0
    order, areas = order_along(corners.mean(axis=1)), 0.5 * lengths(part.tree.normals)
    up = outward * part.normals[order, 2] >= -SINGLE
    undercut, order = float(areas[order[~up]].sum()), order[up]
    ends = np.cumsum(areas[order])
    whole = ends[-1] if len(ends) else 0.0
    wanted = whole / max(spacing, 1e-50) ** 2
    require_size(wanted, MOST_SAMPLES, "scallop or spacing is too small", "samples of the part")
    count = int(np.ceil(wanted))
    share = whole / max(count, 1)
    points, normals = np.empty((2, count, 3))

    def kernel(block):
        number = np.arange(block.start, block.stop)
        triangle = order[np.searchsorted(ends, (number + 0.5) * share)]
        u, v = np.modf(0.5 + number * ROBERTS)[0]
        u, v = np.where(u + v > 1.0, (1.0 - u, 1.0 - v), (u, v))[..., None]
        a, b, c = corners[triangle].swapaxes(0, 1)
        points[block], normals[block] = a + u * (b - a) + v * (c - a), outward * part.normals[triangle]

    over_blocks(kernel, count, "sampling")
    return Samples(points, normals, share, undercut)


def tips_over(touch, samples):
    """Tips ``(n, 3)`` of a cutter in contact with the samples, as `Contact` has them."""
    (a, r, c, w), normals = touch.shape, samples.normals
    across = lengths(normals[:, :2])[:, None]
    out = np.divide(normals[:, :2], across, out=np.zeros_like(normals[:, :2]), where=across > ROUNDING)
    off = np.column_stack([a * out + r * normals[:, :2], r * (normals[:, 2] - 1.0)])
    if c < np.inf:  # where the part is steeper than the side of a cone, the rim touches
        steep = across[:, 0] > c * normals[:, 2].clip(0.0)
        off[steep] = np.column_stack([w * out, np.full(len(out), -kernels.rise(w, touch.shape))])[steep]
    off[:, :2] += TOGETHER_MM * normals[:, :2]  # or rounding lifts the cutter onto vertical walls
    return samples.points + off + (0.0, 0.0, touch.allowance)


def deepened(field, touch, samples):
    """A field of tips with nodes in valleys that are narrower than its grid, where the cutter fits.

    These nodes are moved to the lowest tips in contact with samples near them.
    """
    tips = tips_over(touch, samples)
    least = field.z[field.index(tips[:, :2])] - VALLEY * field.step
    low = (tips[:, 2] < least) & (field.floor < least)
    tips, least = tips[low], least[low]
    tips = tips[~touch.collides(np.column_stack([tips[:, :2], least]))]  # the others take longer to lower
    tips[:, 2] = touch.heights(tips[:, :2], field.floor)
    tips = tips[np.argsort(-tips[:, 2])]
    at, z, places = field.places().reshape(*field.z.shape, 2), field.z.copy(), field.index(tips[:, :2])
    at[places], z[places] = tips[:, :2], tips[:, 2]
    return replace(field, z=z, at=at)


def reached(touch, samples, floor, tolerance):
    """Which samples the cutter reaches within the tolerance, and the tip at each of them.

    The tip is that of a cutter in contact with the sample, lifted until its distance from the sample is the
    tolerance. It must neither gouge the part nor lie below the floor.
    """
    r, tips = touch.shape[1], tips_over(touch, samples)
    up = r * samples.normals[:, 2].clip(0.0)
    tips[:, 2] += np.sqrt(up * up + tolerance * (2.0 * r + tolerance)) - up
    found = tips[:, 2] >= floor
    found[found] = ~touch.collides(tips[found])
    return found, tips


def at_rest(touch, roomy, samples, floor, tolerance, spacing):
    """Which samples the cutter reaches, its nearest tips, how far from them they leave the samples, all tips.

    In a fillet that is too small for it, or between two edges, it rests on the part at a distance from the
    samples. Its tips are those in contact with samples and those on a grid of this ``spacing``, wherever the
    cutter is over a sample that it does not reach, all of the contact ``roomy``. No gap exceeds a diameter.
    """
    fits, tips = reached(roomy, samples, floor, tolerance)
    found, radius, gaps, points = fits.copy(), touch.shape[3], np.zeros(len(fits)), samples.points[~fits]
    found[~fits], _ = reached(touch, samples[~fits], floor, tolerance)
    low, high = touch.part.bounds[:, :2] + [[-radius], [radius]]
    field = empty_field(low, high, max(spacing, np.sqrt((high - low).prod() / MOST_SAMPLES)), floor, "")
    field.z[field.index(points[:, :2])] = np.inf
    xy = field.places()[np.isinf(maximum_filter(field.z, 2 * int(radius / field.step) + 1)).ravel()]
    places = swept(touch, np.vstack([tips[fits], np.column_stack([xy, roomy.heights(xy, floor)])]))
    gaps[~fits], resting = left_over([places], points, 2.0 * radius)
    tips[~fits] = np.where((gaps[~fits] < 2.0 * radius)[:, None], resting, tips[~fits])
    return found, tips, np.where(found, 0.0, gaps.clip(0.0)), places


def visible(part, samples, floor, tolerance):
    """Which samples are seen from above and lie above the floor: a thin enough cutter reaches them."""
    above = samples.points + TOGETHER_MM * samples.normals + (0.0, 0.0, tolerance)
    return (samples.points[:, 2] >= floor - tolerance) & ~Contact(part, NEEDLE, 0.0).collides(above)


def standing(touch, cutter, points, above, height, done, places):
    """Points above which a cutter at rest takes more than ``height``.

    Returned are their numbers, the tips there, how much it takes, and how much stands above the points.
    Beside a pass that comes near a point, a pillar may stand on it. ``above (n,)`` is how high the stock is
    over the points. ``done`` are cutters at their tips, and ``places`` this one at tips at rest.
    """
    some = np.flatnonzero((above > height) & (above < np.inf) & (height < cutter.radius))
    points, above, ball = points[some], above[some], Cutter("ball", diameter=2.0 * height)
    far = points.copy()  # the highest over each of them that is so near the part
    far[:, 2] = contact(touch.part, ball).heights(points[:, :2]) + height
    stand = far[:, 2] < points[:, 2] + above
    stand[stand] = left_over(done, far[stand], SINGLE * height, 0.0)[0] > 0.0
    some, tops = some[stand], points[stand]
    above, _ = left_over(done, tops, above[stand], upright=True)
    tops[:, 2] += above
    over = swept(cutter, np.column_stack([tops[:, :2], touch.heights(tops[:, :2])]))
    deep, tips = left_over([over, places], tops, -height)
    stand = deep < -height
    return some[stand], tips[stand], -deep[stand], above[stand]


def swept(cutter, tips):
    """A cutter at all of ``tips (n, 3)``: its shape, and its tips in the order of a tree over them."""
    order, boxes = tree_along(tips, tips, tips)
    return cutter.shape, tips[order], boxes


def left_over(done, points, reach=np.inf, enough=-np.inf, upright=False):
    """Distance ``(n,)`` of each point to the nearest of the cutters ``done``, and the tip of that one.

    It is negative inside. If ``upright``, it is the height of the lowest one over the point. Larger ones than
    ``reach`` are returned as ``reach``, of no tip, and the first one found that is less than ``enough`` will
    do; both are a number or one for each point.
    """
    out, nearest = np.full(len(points), reach, float), np.zeros((len(points), 3))
    enough = np.full(len(points), enough, float)

    def kernel(block):
        for one in done:
            kernels.left(points[block], *one, enough[block], upright, out[block], nearest[block])

    over_blocks(kernel, len(points), "measuring what is left")
    return out, nearest
