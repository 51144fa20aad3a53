"""Finishing: waterlines where the part is steep, a raster where it is not."""

import numpy as np

from nurbs_lab.common.checks import as_choice, as_kind, as_number, as_positive, extent
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.fit import fit_paths
from nurbs_lab.machining.link import link
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.machining.passes import layout
from nurbs_lab.machining.program import Machine, Program
from nurbs_lab.machining.surface import left_over, reached, sample_surface

SHIFTS = (0.5, 0.25, 0.75)  # of the distance of passes: where more are put in, round by round
CUSP = 0.65  # of the scallop: height of the cusps that passes are laid out for
GOOD = 0.97  # of the scallop: where more is left another pass is put in
FINEST = 1e-6  # of the size of the part: the least tolerance
SAMPLES = 0.25  # of the step between passes: distance of the places looked at for what is left


@one_or_many()
def finish(
    part,
    cutter,
    *,
    scallop,
    tolerance,
    feed=50.0,
    floor=None,
    clearance=5.0,
    direction="climb",
    machine=None,
) -> Program:
    """Plan the finishing of a part on three axes.

    Parameters
    ----------
    part : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction or Part, or a list of them
        Closed.
    cutter : Cutter
        A ball or bull nose; a flat end mill only finishes parts whose sides are level or vertical.
    scallop : float
        Height of what may be left standing between passes, in mm, the tolerance included.
    tolerance : float
        Largest distance between the curves and the exact path, all of it on the side away from the part,
        in mm. Less than the scallop, and at least a millionth of the part's size.
    feed : float
        Largest speed while cutting, in mm/s.
    floor : float, optional
        The tip never goes below this height, in mm; the lowest point of the part if left out.
    clearance : float
        Height above the part at which the cutter travels, in mm.
    direction : {"climb", "conventional"}
        On which side waterlines have the material.
    machine : Machine, optional
        Limits of the motion.
    executor : concurrent.futures.Executor, optional
        Workers for a list; this process if left out. The results are the same, bit for bit.

    Returns
    -------
    Program
        Its ``curves`` are the cutting moves, cubic, of the tip. For a list of parts, a list of programs.

    Raises
    ------
    TypeError, ValueError
        Naming the argument; also an open part, a cutter whose length is less than the depth it must reach
        beside the part, or nothing that it could mill.

    Notes
    -----
    The tip of a cutter grown by half the tolerance gives a surface of cutter locations. Passes lie on it,
    so near to one another in space that a cusp on a plane has 0.65 of the height asked. Where the part's
    own curvature, a crease or an edge of the two kinds of passes leaves more, measured on the part, passes
    are put in between. Every curve is checked against the part between its cutter locations.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> ball = trimesh.creation.icosphere(subdivisions=3, radius=8.0)
    >>> program = nl.finish(ball, nl.Cutter("ball", diameter=6.0), scallop=0.1, tolerance=0.02)
    >>> nl.verify(program, ball).gouge < 0.02  # the tolerance
    True
    """
    part, cutter = prepare_part(part), as_kind("cutter", cutter, Cutter)
    scallop, tolerance = as_positive("scallop", scallop), as_positive("tolerance", tolerance)
    if tolerance >= 0.8 * scallop:
        raise ValueError(f"tolerance must be less than 0.8 of the scallop {scallop}, got {tolerance}")
    feed, clearance = as_positive("feed", feed), as_positive("clearance", clearance)
    as_choice("direction", direction, ("climb", "conventional"))
    machine = Machine() if machine is None else as_kind("machine", machine, Machine)
    part.require_closed()
    least = FINEST * extent(part.bounds)
    if tolerance < least:
        raise ValueError(
            f"tolerance must be at least {least:.3g} mm for a part of this size, got {tolerance:g}"
        )
    low, high = part.bounds[:, 2]
    floor = low if floor is None else as_number("floor", floor)
    if not floor < high:
        raise ValueError(f"floor must be below the top of the part at {high:.6g}, got {floor}")

    touch = contact(part, cutter, 0.5 * tolerance)
    plan = layout(touch, cutter, CUSP * scallop, floor)
    paths = fit_paths(part, cutter, tolerance, plan.paths())
    samples = sample_surface(part, SAMPLES * plan.step, "scallop is too small for this part")
    found, tips = reached(part, cutter, samples, floor, tolerance)
    samples, tips = samples[found], tips[found]
    for shift in (*SHIFTS, None):
        poor = left_over(cutter, locations(paths), samples.points, 2.0 * scallop) > GOOD * scallop
        if not poor.any():
            break
        samples, tips = samples[poor], tips[poor]
        more = plan.more_paths(tips, shift) if shift else plan.short_paths(tips, samples.normals)
        paths += fit_paths(part, cutter, tolerance, more)
    if not paths:
        raise ValueError("part has nothing above the floor that this cutter could mill; lower the floor")
    require_length(part, cutter, locations(paths))
    spare = contact(part, cutter, 0.25 * tolerance)  # for what links do between the places that are checked
    moves = link(paths, spare, high + clearance, feed, machine, direction)
    return Program(moves, cutter, machine, tolerance)


def locations(paths):
    """Places of the tip along paths, ``(n, 3)``."""
    places = [path.samples(np.full(len(path.points) - 1, 2)) for path in paths]
    return np.concatenate(places) if paths else np.empty((0, 3))


def require_length(part, cutter, tips):
    """Refuse a cutter whose shank would hit the part."""
    holder, tips = contact(part, Cutter("flat", diameter=cutter.shank)), tips[::5]
    hit = tips[holder.collides(tips + np.array([0.0, 0.0, cutter.length]))]
    if len(hit):
        deep = float((holder.heights(hit[:, :2]) - hit[:, 2]).max())
        raise ValueError(
            f"cutter is too short: its shank would hit the part; its length must be at least {deep:.4g} mm, "
            f"it is {cutter.length:g}"
        )
