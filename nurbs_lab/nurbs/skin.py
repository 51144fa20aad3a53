"""A surface through a family of section curves (NURBS Book 10.3) with any numbers of points.

Open sections, and rational ones such as circles, get one degree and one knot vector (A10.3), and are lines of
the surface. Where that would multiply the control points, and for other closed ones, every section is sampled
at the same fractions of its length, and the samples make one grid.
"""

from itertools import pairwise
from typing import Protocol, runtime_checkable

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs import refinement
from nurbs_lab.nurbs.along import lengths_along, points_along
from nurbs_lab.nurbs.curve import CLOSED_WITHIN, NurbsCurve
from nurbs_lab.nurbs.interpolate import (
    drop_repeated_end,
    interpolate_curve,
    interpolate_surface,
    interpolate_values,
    require_met,
    surface_parameters,
)
from nurbs_lab.nurbs.surface import NurbsSurface

MOST_SAMPLES = 100_000  # of a section
DENSE = 4001  # points of a curve that is divided at corners: 3e-7 of its size between them
BESIDE = 1e-3  # of the domain: a section that is turned starts at a knot so near
NEAR = 1e-9  # of the domain: knots so near are one
CORNER = np.cos(np.radians(45.0))  # a section that turns by more has a corner there
ASTRAY = 1 / 8  # of the way around: a corner that moves farther from section to section is another one


@runtime_checkable
class Section(Protocol):
    """A contour as `mesh` has them: points ``(n, 2)`` or ``(n, 3)`` of a polyline at a height."""

    points: np.ndarray
    closed: bool
    height: float


def skin(curves_or_contours, degrees=None, *, samples=None, closed=False):
    """The surface through sections, in their order.

    Parameters
    ----------
    curves_or_contours : sequence
        Each a `NurbsCurve` in 3-D, an array of points ``(n, 3)``, or a contour: an object with
        ``points``, ``closed`` and ``height``. An array is closed if its last point repeats the first. All
        sections are closed or all are open, apart from single points, which are poles.
    degrees : (int, int), optional
        Around the sections, and across them; 3, and 3 across if there are four sections or more, one less
        than there are otherwise.
    samples : int, optional
        Points taken from each section; as many as the largest section has by default.
    closed : bool
        Whether the surface goes on from the last section to the first, smoothly.

    Returns
    -------
    NurbsSurface
        u runs along the sections, v across them; closed along u if the sections are.

    Notes
    -----
    Closed sections are turned, and reversed where necessary, so that each starts opposite the start of the
    one before: the shift is the one of greatest correlation of the centred samples. Open ones keep the
    directions that they are given. Where all sections that turn by more than 45 degrees do so in equally
    many places, and these lie opposite one another to an eighth of the way around, the corners are kept: the
    surface is sampled and interpolated between them, and its knots there are as multiple as its degree.
    Smooth sections among them are divided beside the corners of the next section that has some.
    Without ``samples`` the surface passes exactly through sections that are open, or of which one is
    rational, if that takes no more control points than there would be samples, which are never fewer than
    four times the degree and one.
    What sampling lost of a section is how far its points are from the surface, as the example measures it;
    more ``samples`` lose less.

    Examples
    --------
    >>> import numpy as np
    >>> import nurbs_lab as nl
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 33)
    >>> rings = [np.column_stack([np.cos(angle), np.sin(angle), 0 * angle + z]) for z in range(5)]
    >>> tube = nl.skin(rings)
    >>> tube.closed, bool(tube.closest_point((2.0, 0.0, 1.5))[1].round(4) == 1.0)
    ((True, False), True)
    >>> flat = [ring * (1.0, 0.2, 1.0) for ring in rings]
    >>> for samples in (8, 32):
    ...     lost = nl.skin(flat, samples=samples).closest_point(np.concatenate(flat))[1].max()
    ...     print(samples, f"{lost:.0e} mm")
    8 4e-02 mm
    32 6e-03 mm
    """
    sections = checks.as_sequence("curves_or_contours", curves_or_contours)
    degrees = (3, int(np.clip(len(sections) - 1, 1, 3))) if degrees is None else degrees
    degree_u, degree_v = checks.as_pair("degrees", degrees, checks.as_count, 1, 9)
    if len(sections) <= degree_v:
        raise ValueError(
            f"curves_or_contours: degree {degree_v} across needs at least {degree_v + 1} sections, "
            f"got {len(sections)}; give more, or a lower degree as in degrees=(3, 1)"
        )
    curves = [_as_curve(f"curves_or_contours[{i}]", s, degree_u) for i, s in enumerate(sections)]
    closed = checks.as_flag("closed", closed)
    kinds = {c.closed: i for i, c in enumerate(curves) if np.ptp(c.control_points, axis=0).any()}
    if len(kinds) > 1:
        raise ValueError(
            f"curves_or_contours[{kinds[True]}] is closed and [{kinds[False]}] is open; give one kind"
        )
    around = True in kinds
    pieces = _pieces(sections, around)
    exact = samples is None and not pieces and (not around or any(c.rational for c in curves))
    if samples is None:
        samples = max(len(c.control_points) - around * c.degree for c in curves)
        samples = max(samples, 4 * (degree_u + 1))
    samples = checks.as_count("samples", samples, degree_u + 1, MOST_SAMPLES)
    if pieces:
        with checks.said_of("curves_or_contours"):
            return _skin_with_corners(pieces, (degree_u, degree_v), samples, closed)
    fractions = np.linspace(0.0, 1.0, samples, endpoint=not around)
    rows = [_sample(curves[0], fractions)]
    for i, curve in enumerate(curves[1:], 1):
        start, way = _start_and_way(curve, fractions, rows[-1]) if around else (0.0, 1)
        rows.append(_sample(curve, (start + way * fractions) % 1.0 if around else fractions))
        if exact:
            curves[i] = _begun_at(curve, start, way)
    try:
        if exact and (surface := _through(curves, (degree_u, degree_v), samples, closed)):
            return surface
        return interpolate_surface(np.stack(rows, axis=1), (degree_u, degree_v), closed=(around, closed))
    except ValueError as error:
        raise ValueError(f"curves_or_contours: as a {error}") from None


def _as_curve(name, section, degree):
    """A section as a 3-D curve."""
    if isinstance(section, NurbsCurve):
        if section.dim != 3:
            raise ValueError(f"{name} must be a curve in 3-D, got {section.dim}-D")
        return section
    points, closed = _polyline(name, section)
    if not np.ptp(points, axis=0).any():
        return NurbsCurve(1, [0, 0, 1, 1], points[[0, 0]])
    try:
        return interpolate_curve(points, min(degree, 3), closed=bool(closed))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _polyline(name, section):
    """Points in space of a contour or an array, and whether they are closed."""
    if isinstance(section, Section):
        points, closed = checks.as_points(f"{name}.points", section.points), bool(section.closed)
        if points.shape[1] == 2:
            height = checks.as_number(f"{name}.height", section.height)
            points = np.column_stack([points, np.full(len(points), height)])
    else:
        points = checks.as_points(name, section)
        gap = np.linalg.norm(points[-1] - points[0])
        closed = len(points) > 2 and gap <= CLOSED_WITHIN * checks.extent(points)
    if points.shape[1] != 3:
        raise ValueError(f"{name} must have points of shape (n, 3), got {points.shape}")
    return points, closed


def _pieces(sections, around):
    """The polylines between the corners of all sections, section by section; None if they do not match."""
    lines = [
        s(np.linspace(*s.domain, DENSE)) if isinstance(s, NurbsCurve) else _polyline("", s)[0]
        for s in sections
    ]
    lines = [drop_repeated_end(line) if around else line for line in lines]
    lines = [line if np.ptp(line, axis=0).any() else line[:1] for line in lines]  # poles
    corners = [_corners(line, around) for line in lines]
    sharp = [i for i, at in enumerate(corners) if len(at) and len(lines[i]) > 1]
    for i, line in enumerate(lines):  # a smooth section is divided beside the corners of the next sharp one
        if sharp and len(line) > 1 and not len(corners[i]):
            near = min(sharp, key=lambda j: abs(i - j))
            beside = (lines[near] - lines[near].mean(axis=0))[corners[near]] + line.mean(axis=0)
            at = np.unique(np.linalg.norm(line - beside[:, None], axis=2).argmin(axis=1))
            corners[i] = at if around else at[(at > 0) & (at < len(line) - 1)]
    counts = {len(at) for line, at in zip(lines, corners, strict=True) if len(line) > 1}
    if len(counts) != 1 or not (count := counts.pop()):
        return None
    out = []
    for line, at in zip(lines, corners, strict=True):
        if len(line) == 1:
            out.append([line[[0, 0]]] * (count + (not around)))
            continue
        if around:
            line, bounds = np.concatenate([line[at[0] :], line[: at[0] + 1]]), [*(at - at[0]), len(line)]
        else:
            bounds = [0, *at, len(line) - 1]
        parts = [line[a : b + 1] for a, b in pairwise(bounds)]
        out.append(_facing(parts, out[-1]) if out and around else parts)
    rings = [parts for parts, line in zip(out, lines, strict=True) if around and len(line) > 1]
    if any(_astray(parts, before) for before, parts in pairwise(rings)):
        return None
    return out


def _corners(line, closed):
    """Places of a polyline where it turns by more than 45 degrees."""
    ways = np.diff(line, axis=0, append=line[:1])
    ways /= np.maximum(np.linalg.norm(ways, axis=1), 1e-300)[:, None]
    turns = np.einsum("ij,ij->i", np.roll(ways, 1, axis=0), ways) < CORNER
    if not closed:
        turns[[0, -1]] = False
    return np.flatnonzero(turns)


def _facing(parts, before):
    """The pieces of a closed section, begun at the corner that makes their corners face those before."""
    shifts = [way[k:] + way[:k] for way in (parts, [p[::-1] for p in parts[::-1]]) for k in range(len(parts))]
    some = [
        [piece[k * (len(piece) - 1) // 4] for piece in one for k in range(4)] for one in (before, *shifts)
    ]
    some = np.array(some) - np.mean(some, axis=1, keepdims=True)
    return shifts[np.linalg.norm(some[1:] - some[0], axis=(1, 2)).argmin()]


def _astray(parts, before):
    """Whether a corner of a closed section is not opposite that of the section before, as noise has them."""
    starts, samples = [], []
    for pieces in (parts, before):
        line = np.concatenate([pieces[0][:1], *(piece[1:] for piece in pieces)])
        way, at = lengths_along(line), np.cumsum([0, *(len(piece) - 1 for piece in pieces[:-1])])
        starts.append(way[at] / way[-1])
        samples.append(points_along(line, way[-1] * np.linspace(0.0, 1.0, DENSE, endpoint=False)))
    apart = starts[0] - starts[1] - seam_shift(*samples)[0]
    return np.abs(apart - np.round(apart)).max() > ASTRAY


def _skin_with_corners(pieces, degrees, samples, closed):
    """The surface through sections given in pieces; all pieces together have some samples."""
    ways = [[lengths_along(piece) for piece in section] for section in pieces]
    lengths = np.mean([[way[-1] for way in section] for section in ways], axis=0)
    counts = np.maximum(degrees[0] + 1, np.ceil(samples * lengths / lengths.sum())).astype(int)
    knots, nets, grids = [np.zeros(degrees[0] + 1)], [], []
    for k, count in enumerate(counts):
        even = np.linspace(0.0, 1.0, count)
        parts = [way[k] / max(way[k][-1], 1e-300) for way in ways if way[k][-1]]
        dense = [np.interp(even, np.linspace(0.0, 1.0, len(part)), part) for part in parts]
        at = (even + np.mean(dense, axis=0)) / 2  # dense where the points of the sections are
        rows = [
            [np.interp(at * way[k][-1], way[k], x) for x in section[k].T]
            for way, section in zip(ways, pieces, strict=True)
        ]
        grids.append(np.transpose(rows, (2, 0, 1)))
        at = surface_parameters(grids[-1], 0, degrees[0], "chord", False)
        vector, net = interpolate_values(degrees[0], at, grids[-1].reshape(count, -1), False)
        knots.append(k + vector[degrees[0] + 1 : -1])
        nets.append(net[k > 0 :])
    net = np.concatenate(nets).reshape(-1, len(pieces), 3).swapaxes(0, 1)
    vector, net = _across(net, np.concatenate(grids).swapaxes(0, 1), degrees[1], closed)
    u = np.append(np.concatenate(knots), len(counts)) / len(counts)
    return NurbsSurface(degrees, (u, vector), net)


def _across(nets, points, degree, closed):
    """Knots across sections and the net of the surface through them.

    The sections have control points ``nets (sections, n, m)``. The distances of ``points (sections, k, 3)``
    give the parameters.
    """
    at, flat = surface_parameters(points, 1, degree, "chord", closed), nets.reshape(len(nets), -1)
    vector, net = interpolate_values(degree, at, flat, closed)
    lines = NurbsCurve(degree, vector, net)
    cure = "sections at more even distances"
    require_met("grid of sections", degree, lines, lines(at[: len(flat)]), flat, cure)
    return vector, net.reshape(len(net), *nets.shape[1:]).swapaxes(0, 1)


def _sample(curve, fractions):
    """Points at fractions of the length."""
    return curve(curve.parameter_at(fractions * curve.length()))


def seam_shift(samples, before):
    """The fraction of the way around by which closed samples ``(n, dim)`` match those of the section before.

    The second result is their correlation there. The highest correlation of all shifts is found by Fourier
    transform, and its place between two samples by a parabola.
    """
    spectra = [np.fft.rfft(rows - rows.mean(axis=0), axis=0) for rows in (samples, before)]
    match = np.fft.irfft((spectra[0] * spectra[1].conj()).sum(axis=1), len(samples))
    top = int(np.argmax(match))
    left, here, right = match[top - 1], match[top], match[(top + 1) % len(match)]
    second = left - 2 * here + right
    return (top + (0.5 * (left - right) / second if second < 0 else 0.0)) / len(samples), here


def _start_and_way(curve, fractions, before):
    """Where a closed section starts, as a fraction of its length, and 1 or -1, to be like the one before."""
    forward, back = (seam_shift(_sample(curve, way * fractions % 1.0), before) for way in (1, -1))
    return (forward[0], 1) if forward[1] >= back[1] else (-back[0], -1)


def _begun_at(curve, start, way):
    """A curve that runs the other way if that is -1, and a closed one from a fraction of its length."""
    low, high = curve.domain
    at = curve.parameter_at(start % 1.0 * curve.length())
    nearest = curve.knots[np.abs(curve.knots - at).argmin()]
    at = nearest if abs(nearest - at) < BESIDE * (high - low) else at
    if low < at < high:
        first, last = curve.split(at)
        curve = last.join(first)
    return curve if way > 0 else curve.reverse()


def _through(curves, degrees, most, closed):
    """The surface with sections as its lines (A10.3); None if it takes too many points, or bad weights."""
    p, rows = degrees[0], []
    for curve in curves:
        if curve.degree > p:
            return None
        curve = curve.clamped() if curve.degree == p else curve.clamped().elevate_degree(p - curve.degree)
        low, high = curve.domain
        rows.append(((curve.knots - low) / (high - low), curve.homogeneous / curve.weights[0]))
    every = np.sort(np.concatenate([knots for knots, _ in rows]))
    every = every[np.diff(every, prepend=-1.0) > NEAR]
    places = [np.searchsorted(every, knots + NEAR) - 1 for knots, _ in rows]
    counts = [np.bincount(place, minlength=len(every)) for place in places]
    merged = np.max(counts, axis=0)
    if merged.sum() - p - 1 > most:
        return None
    nets = []
    for place, count, (_, net) in zip(places, counts, rows, strict=True):
        curve = NurbsCurve._of(p, every[place], net)
        nets.append(curve.refine(np.repeat(every, merged - count)).homogeneous)
    for i, net in enumerate(nets):  # a pole has the weights of a section beside it
        points = refinement.project(net)
        if not np.ptp(points, axis=0).any():
            nets[i] = refinement.lift(points[:1], nets[i - 1 if i else 1][:, -1])
    nets = np.array(nets)
    vector, net = _across(nets, refinement.project(nets), degrees[1], closed)
    if not net[..., -1].min() > 0.0:
        return None
    return NurbsSurface._of(degrees, (np.repeat(every, merged), vector), net)
