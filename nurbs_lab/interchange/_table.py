"""A tool path as comma-separated values, one row a period; and tables of points.

The columns are ``t`` in s, ``u``, ``x``, ``y``, ``z`` in mm, and ``v`` in mm/s, the mean speed along the
chord of the period that ends in the row (0 in the first).
"""

import contextlib
import re
import warnings
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_floats, lengths
from nurbs_lab.mesh.formats.shape import unended
from nurbs_lab.mesh.read import UNITS

_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)
_AXIS = re.compile(rf"\s*([xyz])\s*(?:[\[(]({'|'.join(UNITS)})[\])])?\s*", re.IGNORECASE)
HEADS = {dim: ["t", "u", *"xyz"[:dim], "v"] for dim in (2, 3)}


@dataclass(frozen=True, eq=False)
class PathTable:
    """The samples of a tool path as a table holds them, with the columns of this module as arrays.

    ``t``, ``u`` and ``v`` have the shape ``(n,)``, ``points`` has ``(n, dim)``.
    """

    t: np.ndarray
    u: np.ndarray
    points: np.ndarray
    v: np.ndarray


def write(path, parts):
    if len(parts.paths) != 1:
        raise ValueError(f"items: a .csv file holds one tool path, got {len(parts.paths)}; write each alone")
    (tool_path,) = parts.paths
    points = np.asarray(tool_path.points)
    table = np.column_stack([tool_path.t, tool_path.u, points, _speeds(tool_path.t, points)])
    head = ",".join(HEADS[points.shape[1]])
    np.savetxt(path, table, delimiter=",", fmt="%.17g", header=head, comments="")


def _speeds(t, points):
    return np.r_[0.0, lengths(np.diff(points, axis=0)) / np.diff(t)]


def read(path):
    """A `PathTable` if the first line names its columns; else points, by the x, y and z of a header.

    Numbers are separated by commas if the first line has one, or else by blanks.
    """
    lines = (text := path.read_text(encoding="utf-8-sig")).split("\n")
    for note in unended(text.encode()):
        warnings.warn(f"path: {path.name}: {note}", stacklevel=3)
    if re.search(r"^[^#\n]*[^\s#]#", text, re.MULTILINE):
        raise ValueError("a number of it goes on with '#', which begins a comment; it is damaged")
    found = [(i, row) for i, line in enumerate(lines) if (row := line.partition("#")[0].strip())]
    first, head = found[0] if found else (0, "")
    comma, by = (",", "commas") if "," in head else (None, "blanks")
    names = [word.strip(' \t"') for word in head.split(comma)]
    headed, named = not any(map(_NUMBER.fullmatch, names)), names in HEADS.values()
    axes = _axes(names if headed else lines[first - 1].lstrip("# ").split(comma))  # of a comment above
    if headed and not (axes or named):
        said = f"its first line {head[:40]!r} is neither numbers nor names separated by {by}"
        raise ValueError(
            f"{said}; name x, y and z, such as 'x[mm]', and leave other columns out; or name a program .nc"
        )
    rows = _numbers(found[headed:], len(names), comma, by)
    as_floats("the table", rows)
    t, points, v = rows[:, 0], rows[:, 2:-1], rows[:, -1]
    moves = rows.shape[1] in (5, 6) and len(t) > 1 and (np.diff(t) > 0).all()
    some = slice(None) if named else slice(1, None)  # a path starts at rest
    with np.errstate(all="ignore"):
        speeds = _speeds(t, points) if moves else np.zeros(len(t))
        near = np.allclose(speeds[some], v[some], rtol=1e-6, atol=1e-6 * speeds.max())
    if named != (speeds.any() and near):
        raise ValueError("a line is missing, doubled or damaged: its speeds are not those of its chords")
    if named:
        return PathTable(t, rows[:, 1], points, v)
    if len(names) > 3:
        raise ValueError(f"its rows have {len(names)} numbers; leave all columns but x, y and z out")
    return rows[:, list(axes)] * [*axes.values()] if axes else rows


def _axes(names):
    """The columns of x, y and z -> their units in mm; nothing if these are not all names, each once."""
    found = sorted((m[1].lower(), i, m[2] or "mm") for i, m in enumerate(map(_AXIS.fullmatch, names)) if m)
    whole = len(found) == len(names) and [axis for axis, *_ in found] == list("xyz"[: len(names)])
    return {i: UNITS[unit.lower()] for _, i, unit in found} if whole else {}


def _numbers(rows, count, comma, by):
    """The numbers of rows ``[(place of the line, text), ...]``; a row of others or of words is named."""
    with contextlib.suppress(ValueError):
        numbers = np.loadtxt([row for _, row in rows] or ["-"], delimiter=comma, ndmin=2)
        if numbers.shape[1] == count:
            return numbers
    for i, row in rows:
        words = [word.strip() for word in row.split(comma)]
        strange = [w for w in words if not _NUMBER.fullmatch(w)] + [row] * (len(words) != count)
        if strange:
            said = f"could not convert string {strange[0]!r} of line {i + 1}"
            raise ValueError(f"{said}; make it {count} numbers separated by {by}, as the first line has")
    raise ValueError("it holds no row of numbers")
