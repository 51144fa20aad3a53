"""Gouges, scallops and unreachable area of a program, measured independently of how it was made."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_kind, as_number, as_positive, lengths
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.values import Value
from nurbs_lab.machining.drop import body_contacts, contact
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.machining.program import Program
from nurbs_lab.machining.simulate import coarse
from nurbs_lab.machining.stock import as_stock, depths, material_of
from nurbs_lab.machining.surface import at_rest, left_over, sample_surface, standing, swept, visible
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.nurbs.measure import samples_along

SPACING = 0.006  # diameters between sampled tips
SAMPLES = 0.03  # diameters between samples of the part, by default
TIMES = 10  # least number of samples for every control point
LEAST_SAMPLES, MOST_SAMPLES = 2e4, 2.5e6  # by default


@dataclass(frozen=True, eq=False, repr=False)
class Verification(Value):
    """Figures of a program on a part; lengths in mm, areas in mm².

    Attributes
    ----------
    gouges : (n, 4) array
        Tips at which a cutter cuts into the part, and how much smaller all round it must be not to do so.
    left : (m,) array
        Material left on each sample of the reached surface, in increasing order: its distance from the
        nearest cutter, however far, or, if the stock is known, the height of that above it or its distance
        from a side of that, if less. The little that a disc leaves there at rest is subtracted. Where
        material above a sample stands out more than is left at any of them, as a pillar beside a pass, it is
        how far.
    areas : (m,) array
        Area that each sample represents.
    points : (m, 3) array
        The samples.
    unreachable : dict
        Area that no cutter of the program and those before it reaches: 'narrow', where a smaller cutter fits,
        and 'undercut', which none reaches from above.
    facing_up : float
        Area outside the faces that look down.
    contacts : tuple of str
        What touches that must not: rapid moves, shank or holder, the part or the stock of the program.
    narrow_points, hidden_points : (k, 3) arrays
        Samples that a smaller cutter would reach, and those that none reaches, without faces that look down.
    bridged : (k,) array
        Material left on each of ``narrow_points`` beyond what the cutters leave there at rest on the part; 0
        in holes deeper than their diameter.
    """

    gouges: np.ndarray
    left: np.ndarray
    areas: np.ndarray
    points: np.ndarray
    unreachable: dict
    facing_up: float
    contacts: tuple[str, ...]
    narrow_points: np.ndarray
    hidden_points: np.ndarray
    bridged: np.ndarray

    @property
    def gouge(self) -> float:
        """Depth of the deepest gouge, in mm."""
        return float(self.gouges[:, 3].max(initial=0.0))

    def report(self) -> str:
        """What is reached, what is left on it, and every gouge and contact."""
        reached = float(self.areas.sum())
        narrow, undercut = self.unreachable["narrow"], self.unreachable["undercut"]
        whole, up = reached + narrow + undercut, self.facing_up
        hidden = max(up - reached - narrow, 0.0)
        return "\n".join(
            [
                f"{reached / whole:.1%} of the surface reached, {narrow / whole:.1%} left for a smaller "
                f"cutter, {undercut / whole:.1%} out of reach on three axes; of what faces up "
                f"{reached / up:.1%}, {narrow / up:.1%} and {hidden / up:.1%}",
                f"left where it is reached: at most {self.percentile(99):.4g} mm on 99 %, "
                f"{self.percentile(100):.4g} mm on all of {len(self.left)} samples",
                f"left elsewhere beyond what the cutters leave at rest: at most "
                f"{self.bridged.max(initial=0.0):.4g} mm on {len(self.bridged)} samples",
                f"deepest gouge: {self.gouge:.3g} mm",
                *(self.contacts or ["no contact of rapid moves, shank or holder"]),
            ]
        )

    def percentile(self, percent) -> float:
        """Height of the material left that is not exceeded on ``percent`` per cent of the reached area."""
        percent = as_number("percent", percent)
        if not 0.0 <= percent <= 100.0:
            raise ValueError(f"percent must be between 0 and 100, got {percent}")
        return float(np.percentile(self.left, percent, method="inverted_cdf"))


@one_or_many("part", send=without_cache)
def verify(program, part, *, spacing=None) -> Verification:
    """Measure the gouges, the scallops and the unreachable area of a program.

    A program that was planned ``after`` another one is judged together with it, and with those before that.
    Every move is sampled, with at least ten samples for each control point, and a drop-cutter computes the
    gouge at each sample. The material left is the distance from samples of the part to the nearest cutter,
    without rapid moves. Where a cutter touches no sample, its distance from them at rest on the part is
    subtracted. An earlier program that comes nowhere as close to the part as its tolerance, as roughing, does
    not count as reaching anything. Contacts with stock are those of `simulate` with the stock that each
    program knows.

    Parameters
    ----------
    program : Program or list of Program
    part : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction or Part
        Closed; for a list of programs, one part or a list of as many.
    spacing : float
        Distance between samples of the part, in mm; 0.03 diameters of the cutter by default, less on small
        parts, more on large ones; a million samples take one to two seconds.

    Raises
    ------
    TypeError, ValueError
        Naming the argument.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> ball = trimesh.creation.icosphere(subdivisions=3, radius=8.0)
    >>> program = nl.finish(ball, nl.Cutter("ball", diameter=6.0), scallop=0.1, tolerance=0.02)
    >>> found = nl.verify(program, ball)
    >>> found.percentile(99) < 0.1, round(found.unreachable["undercut"]) > 300
    (True, True)
    """
    program, part = as_kind("program", program, Program), prepare_part(part)
    program.require_cutter()
    area = 0.5 * lengths(part.tree.normals).sum()
    finest, coarsest = np.sqrt(area / MOST_SAMPLES), np.sqrt(area / LEAST_SAMPLES)
    usual = float(np.clip(SAMPLES * program.cutter.diameter, finest, coarsest))
    spacing = usual if spacing is None else as_positive("spacing", spacing)
    part.require_closed()
    samples = sample_surface(part, spacing)
    seen = visible(part, samples, part.bounds[0, 2], program.tolerance)
    chain, gouges, contacts, done, rests = program.chain, [], [], [], []
    left, gaps, found = np.full(len(seen), np.inf), np.full(len(seen), np.inf), np.zeros(len(seen), bool)
    for one in reversed(chain):
        cutter, touch, tips, before = one.cutter, contact(part, one.cutter), locations(one), left
        deep = tips[touch.collides(tips)]
        gouges.insert(0, np.column_stack([deep, touch.depths(deep)]))
        contacts = [*_contacts(one, part, tips), *contacts]
        done.append(swept(cutter, tips))
        left, _ = left_over(done[-1:], samples.points, before)
        if one is program or left[left < before].min(initial=np.inf) <= one.tolerance:
            floor, wide = part.bounds[0, 2], SAMPLES * cutter.diameter
            fits, _, off, rest = at_rest(touch, touch, samples, floor, one.tolerance, wide)
            if cutter.flat_radius:  # a level place may be anywhere under the disc
                fits |= seen & (off < 2.0 * one.tolerance)
            found |= fits
            rests.append((touch, cutter, rest, fits))
            gaps = np.minimum(gaps, np.where(off < cutter.diameter, off, np.inf))
    stock = as_stock(chain[0].stock, part)
    above = material_of(stock, program.cutter).above(samples.points)
    if chain[0].stock is not None:
        left = np.minimum(left, depths(stock, above, samples.points))
    left = left - gaps
    for touch, cutter, rest, fits in rests:
        high = max(left[fits].max(initial=0.0), program.tolerance)
        some, _, deep, _ = standing(touch, cutter, samples.points, above, high, done, rest)
        left[some] = deep
    seen, narrow = seen | found, seen & ~found
    bridged, left = left[narrow].clip(0.0), left[found]
    order, share = np.argsort(left, kind="stable"), samples.share
    return Verification(
        gouges=np.concatenate(gouges),
        left=left[order],
        areas=np.full(len(order), share),
        points=samples.points[found][order],
        unreachable={
            "undercut": samples.undercut + share * np.count_nonzero(~seen),
            "narrow": share * np.count_nonzero(narrow),
        },
        facing_up=share * len(seen),
        contacts=tuple(contacts),
        narrow_points=samples.points[narrow],
        hidden_points=samples.points[~seen],
        bridged=bridged,
    )


def _contacts(program, part, tips):
    """A sentence for each thing that touches part or stock and must not."""
    rapid = locations(program, ("rapid",))
    fast = rapid[contact(part, program.cutter).collides(rapid)]
    found = [("rapid moves touch", fast, rapid)] if len(fast) else []
    bodies = body_contacts(part, program.cutter, tips)
    found += [(f"the {name} touches", hit, tips) for name, hit, _ in bodies]
    said = [
        f"{what} the part at {len(a)} of {len(b)} places, such as {a[0].round(3)}" for what, a, b in found
    ]
    return (*said, *(coarse(program).warnings() if program.stock is not None else ()))


def locations(program, kinds=("plunge", "cut", "link")):
    """Tips along all moves of these kinds, ``(n, 3)``."""
    places, step = [np.empty((0, 3))], SPACING * program.cutter.diameter
    for move in program.moves:
        if move.kind in kinds:
            control = move.curve.control_points
            size = lengths(np.diff(control, axis=0)).sum()
            count = max(TIMES * len(control), int(size / step)) + 1
            places.append(samples_along(move.curve, count)[1])
    if len(places) == 1 and "cut" in kinds:
        raise ValueError("program has no move that cuts")
    return np.concatenate(places)
