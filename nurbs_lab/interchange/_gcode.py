"""Programs for machine tools: a curve, or a program of moves, in the dialect of a controller.

A tool path alone needs no dialect: it gives one straight move for each period, and its feed is the chord over
the period, so that the machine passes each point at the time of the path; a dwell is in seconds. All other
items have no time, so the caller gives the feed, the tolerance, the units and the letters of the axes; none
of them has a default.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import (
    as_choice,
    as_count,
    as_flag,
    as_kind,
    as_number,
    as_positive,
    lengths,
    shown,
)
from nurbs_lab.interchange._dialects import COOLANTS, DIALECTS, G1, KNOT_DIGITS, number
from nurbs_lab.interchange._moves import MoveTable
from nurbs_lab.mesh.read import UNITS, short_unit

FINEST_MM = 1e-7  # of the written numbers
APART_MM = 1e-6  # a move begins where the one before it ends
EXAMPLE = "export(path, curve, dialect='g1', feed=20.0, tolerance=0.01, units='mm', axes='XYZ')"


@dataclass(frozen=True)
class Setup:
    """What a machine has to do before and after the moves of a program, and the digits that it takes.

    Attributes
    ----------
    tool : int
        Number of the tool, whose length is that of its place in the controller's table.
    spindle_rpm : float
    safe_z_mm : float
        Height of the first and the last move, above all others.
    offset : int
        From 54 to 59, the coordinates of the work piece (not for Heidenhain, whose preset is kept).
    coolant : {"off", "mist", "flood"}
    clockwise : bool
        Of the spindle, M3.
    number : int or None
        Of the program, from 1 to 9999, between two lines %; Fanuc needs one. Siemens gets its name of it, and
        Heidenhain none.
    digits : int
        After the point of a coordinate in mm, one more in inches: 3 or 4 for most controllers. What they
        round is taken from the tolerance of `export`, of which it may be half.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> setup = nl.Setup(tool=3, spindle_rpm=12_000, safe_z_mm=50.0, coolant="flood")
    >>> setup.offset, setup.clockwise
    (54, True)
    """

    tool: int
    spindle_rpm: float
    safe_z_mm: float
    offset: int = 54
    coolant: str = "off"
    clockwise: bool = True
    number: int | None = None
    digits: int = 4

    def __post_init__(self):
        for name, least, most in (("tool", 1, 99_999), ("offset", 54, 59), ("digits", 2, 9)):
            as_count(name, getattr(self, name), least, most)
        as_positive("spindle_rpm", self.spindle_rpm)
        as_number("safe_z_mm", self.safe_z_mm)
        as_choice("coolant", self.coolant, tuple(COOLANTS))
        as_flag("clockwise", self.clockwise)
        if self.number is not None:
            as_count("number", self.number, 1, 9999)


def write(path, parts, dialect=None, feed=None, tolerance=None, units=None, axes=None, setup=None):
    if (given := len(parts.curves) + len(parts.paths) + len(parts.programs)) != 1:
        said = f"a {path.suffix} file holds one curve, path or program, got {given}"
        raise ValueError(f"items: {said}; a machining.Program has the moves between curves too")
    if path.suffix.lower() == ".h" and dialect != "heidenhain":
        said = "a .h file is one of Heidenhain's; give dialect='heidenhain', or name the program .nc"
        raise ValueError(f"dialect = {shown(dialect)}: {said}")
    if parts.paths and dialect is None:
        if any(value is not None for value in (feed, tolerance, units, axes, setup)):
            said = "a tool path is written period by period, in mm and without a setup; leave these out, or"
            raise ValueError(
                f"feed, tolerance, units, axes, setup: {said} give a dialect, for its curve by feed"
            )
        lines = _samples(parts.paths[0])
    else:
        lines = _program(_strokes(parts, feed), dialect, tolerance, units, axes, setup)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(f"{line}\n" for line in lines)


def _strokes(parts, feed):
    """Kind, curve, feed and number of every move; one alone is a cut with the feed asked for."""
    if parts.programs:
        if feed is not None:
            raise ValueError(f"feed = {shown(feed)}: every move of a program has its own feed; leave it out")
        moves = parts.programs[0].moves
        if isinstance(moves, MoveTable):
            return [*moves.strokes()]
        return [(move.kind, move.curve, move.feed, i) for i, move in enumerate(moves)]
    feed = None if feed is None else as_positive("feed", feed)
    return [("cut", parts.curves[0] if parts.curves else parts.paths[0].curve, feed, 0)]


def _program(strokes, dialect, tolerance, units, axes, setup):
    dialect = "g1" if dialect is None else as_choice("dialect", dialect, tuple(DIALECTS))
    Dialect, dim = DIALECTS[dialect], _dimension(strokes)
    if tolerance is not None and as_positive("tolerance", tolerance) < FINEST_MM:
        raise ValueError(f"tolerance must be at least the last digit, {FINEST_MM:g} mm, got {tolerance:g}")
    trial = Dialect("mm", "XYZ"[:dim], tolerance)
    approximate = any(curve.degree > 1 and not trial.exact(curve) for _, curve, *_ in strokes)
    unfed = any(kind != "rapid" and feed is None for kind, _, feed, _ in strokes)
    asked = {"feed": not unfed or None, "tolerance": tolerance if approximate else 0.0}
    asked |= {"units": units, "axes": axes}
    if missing := [name for name, value in asked.items() if value is None]:
        raise ValueError(f"{', '.join(missing)} must be given for dialect {dialect!r}, as in {EXAMPLE}")
    if not isinstance(axes, str) or len(axes) != dim or len(set(axes) & set("XYZUVWABC")) != dim:
        raise ValueError(f"axes must be {dim} different letters of XYZUVWABC, got {shown(axes)}")
    units = as_choice("units", short_unit(units), ("mm", "inch"))
    if setup is not None:
        _require_setup(setup, strokes, axes, dialect)
    post = Dialect(units, axes, None if tolerance is None else tolerance / UNITS[units], setup)
    if setup and tolerance is not None:
        rounding = 0.5 * dim**0.5 * 10.0**-post.digits
        if rounding > 0.5 * post.tolerance:
            raise ValueError(
                f"setup: digits = {setup.digits} rounds {units} by up to {rounding * post.unit_mm:.2g} mm, "
                f"more than half of tolerance = {tolerance:g} mm; give more digits"
            )
        post.tolerance -= rounding
    within = f" within {tolerance:g} mm" if approximate else ""
    moves = "" if setup else ", moves only"
    title = f"nurbs_lab, dialect {dialect}{within}, F per minute{moves}"
    return post.numbered(_lines(post, strokes, title))


def _require_setup(setup, strokes, axes, dialect):
    """A setup needs the axis Z, moves below its safe height, and a number for Fanuc."""
    as_kind("setup", setup, Setup)
    if "Z" not in axes:
        cure = "give a curve in space, such as nurbs_lab.interpolate_curve of points with z = 0"
        raise ValueError(f"axes: a setup moves Z, got {shown(axes)}; leave setup out, or {cure}")
    top = max(curve.control_points[:, axes.index("Z")].max() for _, curve, *_ in strokes)
    if setup.safe_z_mm < top - 10.0**-setup.digits:  # a file's heights are rounded
        raise ValueError(f"setup: safe_z_mm = {setup.safe_z_mm:g} is below the highest move, {top:g}")
    if dialect == "fanuc" and setup.number is None:
        raise ValueError("setup: a program of Fanuc needs its number; give number=")


def _lines(post, strokes, title):
    yield from post.begin(title)
    scale = 1 / post.unit_mm
    _, curve, feed, _ = strokes[0]
    *above, first = _from_above(post, curve(curve.domain[:1]) * scale)
    yield from post.rapid(np.array(above or [first]))
    if above:  # down by the feed where the first move cuts
        yield from post.straight(first[None], 60 * feed * scale) if feed else post.rapid(first[None])
    for kind, curve, feed, _ in strokes:
        if curve.degree > 1:
            yield from post.curve(curve.transform(scale * np.eye(curve.dim)), 60 * feed * scale)
            continue
        points = scale * curve.clamped().control_points
        yield from post.rapid(points[1:]) if kind == "rapid" else post.straight(points, 60 * feed * scale)
    if post.setup:
        yield from post.rapid(_from_above(post, post.position[None])[:1])
    yield from post.finish()


def _from_above(post, point):
    """A point ``(1, dim)``, with the one above it at the safe height before it where there is a setup."""
    if post.setup is None:
        return point
    above = point.copy()
    above[:, post.axes.index("Z")] = post.setup.safe_z_mm / post.unit_mm
    return np.concatenate([above, point])


def _dimension(strokes):
    """The number of coordinates; refused if two moves do not meet, or a rapid one is curved."""
    end, dim = None, strokes[0][1].dim if strokes else 0
    if dim not in (2, 3):
        raise ValueError(f"items: a program needs moves in 2 or 3 dimensions, got {dim or 'no moves'}")
    for kind, curve, _, i in strokes:
        if kind == "rapid" and curve.degree > 1:
            raise ValueError(f"items: moves[{i}] is rapid and curved; a rapid move must have degree 1")
        first, last = curve(curve.domain)
        if end is not None and (apart := lengths(first - end)) > APART_MM:
            raise ValueError(f"items: moves[{i}] begins {apart:.6g} mm from where moves[{i - 1}] ends")
        end = last
    return dim


def _samples(tool_path):
    """One straight move for each period, with the feed at which it lasts one; a dwell where it waits."""
    post = G1("mm", "XYZ"[: tool_path.points.shape[1]], None)
    yield from post.begin("nurbs_lab; lengths in mm, F in mm per minute, G4 P in seconds")
    points = post.rounded(tool_path.points)
    yield from post.rapid(points[:1])
    periods = zip(points[1:], lengths(np.diff(points, axis=0)), np.diff(tool_path.t), strict=True)
    for moves, rows in itertools.groupby(periods, lambda row: row[1] > 0):
        if not moves:  # F0 is an error to a machine
            yield f"G4 P{number(sum(time for *_, time in rows), KNOT_DIGITS)}"
            continue
        for point, step, time in rows:
            yield from post.straight(point[None], 60 * step / time)
    yield from post.finish()
