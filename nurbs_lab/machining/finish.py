"""Finishing: waterlines where the part is steep, a raster where it is not."""

from dataclasses import replace

import numpy as np

from nurbs_lab.common.checks import as_kind, as_positive, extent, freeze
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import body_contacts
from nurbs_lab.machining.fit import Fitting, fit_paths
from nurbs_lab.machining.link import ways_over
from nurbs_lab.machining.part import SINGLE, prepare_part
from nurbs_lab.machining.passes import layout
from nurbs_lab.machining.program import MACHINE, Program
from nurbs_lab.machining.stock import as_stock, depths, material_of, require_inside
from nurbs_lab.machining.surface import at_rest, deepened, left_over, sample_surface, standing, swept, visible
from nurbs_lab.machining.verify import locations as program_tips
from nurbs_lab.mesh.read import without_cache

CUSP = 0.65  # fraction of the scallop: height of cusps on a plane between the first passes
SAMPLES = 0.125  # fraction of the step-over: spacing of the samples on which the remainder is measured
FINEST_SAMPLES = 1 / 80  # fraction of the diameter: their least spacing
CLOSER = 0.25  # fraction of the tolerance: that of further passes, in gaps that the cutter just fits


@one_or_many(send=without_cache)
def finish(
    part,
    cutter,
    *,
    scallop,
    tolerance,
    stock=None,
    after=None,
    feed=50.0,
    machine=MACHINE,
) -> Program:
    """Plan the finishing of a part on three axes.

    Parameters
    ----------
    part : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction or Part, or a list of them
        Closed.
    cutter : Cutter
        A ball or bull nose; a flat end mill takes many more passes where sides are neither level nor upright.
    scallop : float
        Largest height of the material left between passes, in mm, the tolerance included.
    tolerance : float
        Largest distance between the curves and the exact path, in mm. The curves deviate only away from the
        part. It is less than 0.8 of the scallop and at least a millionth of the part's size.
    stock : block (2, 3), trimesh.Trimesh, file name, Part or Simulation, optional
        What the part is cut from: least and largest corner, a closed mesh, or what `simulate` returned; that
        of ``after``, otherwise the box of the part, by default. Passes follow only where it stands out from
        the part by more than the scallop, or, if it does so nowhere, everywhere.
    after : Program, optional
        Cut before this one. Only where it leaves more than the scallop, passes follow.
    feed : float
        Largest speed while cutting, in mm/s; ways down into material have a third of it.
    machine : Limits, optional
        Limits of the motion.

    Returns
    -------
    Program
        Its ``curves`` are the cutting moves: cubic curves of the tip. A list of parts gives a list.

    Raises
    ------
    TypeError, ValueError
        If an argument is invalid (the message names it), the part is open or not inside its stock, the cutter
        is too short to reach the deepest place without its shank touching the part, or there is nothing to
        mill.

    Notes
    -----
    The tip stays above the lowest point of the part. Closed waterlines climb, and open ones are cut either
    way. The cutter is enlarged all round by half the tolerance. The tips of the enlarged cutter in contact
    with the part form a surface, and the passes lie on it. Their distance in space leaves cusps of 0.65 of
    the scallop on a plane. The curvature of the part, a crease, or the boundary between waterlines and raster
    can leave more; there, as measured on samples of the part, further passes are inserted. Every curve is
    checked against the part between its cutter locations as well. Rapid moves are straight lines: a control
    that moves each axis by itself in G0 has to be set to interpolate (Fanuc: bit LRP of parameter 1401).

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
    part.require_closed()
    least = SINGLE * extent(part.bounds)
    if tolerance < least:
        raise ValueError(
            f"tolerance must be at least {least:.3g} mm for a part of this size, got {tolerance:g}"
        )
    floor, high = part.bounds[:, 2]
    if after is not None:
        as_kind("after", after, Program).require_cutter("after")
    stock = as_stock(after.stock if after is not None and stock is None else stock, part)
    require_inside(part, stock, cutter)
    material = material_of(stock, cutter, after)
    begun = stock
    if after is not None:  # the plan cuts the material
        field = {name: freeze(getattr(material.field, name).copy()) for name in ("origin", "z")}
        begun = replace(material.field, **field)
    fitting = Fitting(part, cutter, tolerance)
    closer = replace(fitting, tolerance=max(CLOSER * tolerance, least))
    bare = closer.touch(0.25)  # a margin, as links are checked at points only
    ways = ways_over(bare, material, floor, max(high, material.field.z.max()), feed, machine)
    plan = layout(fitting.touch(0.5), cutter, CUSP * scallop, floor)
    paths, said = covering(fitting, closer, plan, scallop, stock, after, material)
    if not paths:
        raise ValueError("there is nothing that this cutter can mill from above; use a smaller one")
    require_length(part, cutter, locations(paths))
    return replace(ways.program(ways.ordered(paths), tolerance, begun, said), after=after)


def covering(fitting, closer, plan, scallop, stock, after, material):
    """Paths that leave no more than the scallop where the cutter reaches the part and there is more.

    What is left is measured on samples of the part, beyond what the cutter must leave there, and as material
    that stands above them. As the cutter is enlarged by half the tolerance, it does not enter gaps that it
    just fits, so further passes come ``closer``. They are led through tips of the same enlarged cutter, as a
    tip beside a jump, such as a wall, may be one that it cannot take. A warning says where more is left.
    """
    part, cutter = fitting.part, fitting.cutter
    spacing = max(SAMPLES * plan.step_over, FINEST_SAMPLES * cutter.diameter)
    samples = sample_surface(part, spacing)
    field = deepened(plan.field, plan.touch, samples)
    plan = replace(plan, field=field, slope=field.slope)
    samples = samples[visible(part, samples, field.floor, fitting.tolerance)]
    touch, roomy = fitting.touch(0.0), closer.touch(0.5)
    found, tips, gaps, places = at_rest(touch, roomy, samples, field.floor, fitting.tolerance, spacing)
    near = gaps < cutter.diameter  # not so in deep holes
    samples, found, tips, gaps = samples[near], found[near], tips[near], gaps[near]
    points, plan = samples.points, plan.with_steps(tips[found], samples.normals[found])
    done = [] if after is None else [swept(one.cutter, program_tips(one)) for one in after.chain]
    above = material.above(points)
    far = np.minimum(2.0 * scallop + gaps.max(initial=0.0), depths(stock, above, points))
    far, _ = left_over(done, points, far, gaps + scallop)
    poor, before = far - gaps > scallop, np.inf
    poor |= after is None and not poor.any()  # of a stock that has the shape of the part
    first = plan.paths(tips[poor], tips[~poor])
    paths, fresh = [], fit_paths(fitting, first)
    while before:
        done = [*done, swept(cutter, locations(fresh))]
        far, _ = left_over(done[-1:], points, far, gaps + scallop)
        some, over, deep, high = standing(roomy, cutter, points, above, scallop, done, places)
        now, above, done = far - gaps, np.zeros(len(points)), []
        now[some], tips[some], above[some] = deep, over, high
        if np.count_nonzero(poor := now > scallop) >= before:
            break
        paths, left, before = paths + fresh, now[poor], np.count_nonzero(poor)
        points, tips, gaps, far, above = (one[poor] for one in (points, tips, gaps, far, above))
        more = replace(plan, touch=roomy).paths_through(tips, left)
        fresh = fit_paths(closer, more)
    if left.max(initial=0.0) <= scallop + fitting.tolerance:
        return paths, ()
    said = (
        f"at least {left.max():.3g} mm are left where the cutter reaches, such as at "
        f"{points[left.argmax()].round(3)}; a smaller cutter leaves less"
    )
    return paths, (said,)


def locations(paths):
    """Points of the tip along paths, two for each step between cutter locations, ``(n, 3)``."""
    places = [path.curve(np.linspace(*path.curve.domain, 2 * len(path.points))) for path in paths]
    return np.concatenate(places) if paths else np.empty((0, 3))


def require_length(part, cutter, tips):
    """Refuse a cutter whose shank or holder would hit the part."""
    for name, _, enough in body_contacts(part, cutter, tips[::5]):
        what = "length" if name == "shank" else "reach"
        raise ValueError(
            f"cutter is too short: its {name} would hit the part; its {what} must be at least {enough:.4g} "
            f"mm, it is {getattr(cutter, what):g}"
        )
