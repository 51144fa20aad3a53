"""A tool path as comma-separated values, one row a period; and tables of points.

The columns are ``t`` in s, ``u``, ``x``, ``y``, ``z`` in mm, and ``v`` in mm/s, the mean speed along the
chord of the period that ends in the row (0 in the first).
"""

import re
import warnings
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_floats, lengths
from nurbs_lab.mesh.formats.shape import unended

_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)
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
        raise ValueError(
            f"items: a .csv file holds one tool path, got {len(parts.paths)}; write each to its own"
        )
    (tool_path,) = parts.paths
    points = np.asarray(tool_path.points)
    table = np.column_stack([tool_path.t, tool_path.u, points, _speeds(tool_path.t, points)])
    head = ",".join(HEADS[points.shape[1]])
    np.savetxt(path, table, delimiter=",", fmt="%.17g", header=head, comments="")


def _speeds(t, points):
    return np.r_[0.0, lengths(np.diff(points, axis=0)) / np.diff(t)]


def read(path):
    """A `PathTable` if the first line names its columns; else the rows of numbers, as points."""
    comma = None if path.suffix.lower() == ".txt" else ","
    text = path.read_text(encoding="utf-8-sig")
    first = text.partition("\n")[0]
    for note in unended(text.encode()):
        warnings.warn(f"path: {path.name}: {note}", stacklevel=3)
    if re.search(r"^[^#\n]*[^\s#]#", text, re.MULTILINE):
        raise ValueError("a number of it goes on with '#', which begins a comment; it is damaged")
    if comma and ";" in first:
        raise ValueError("its numbers are separated by semicolons; separate them by commas")
    names = [word.strip() for word in first.split(comma)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of a file without any row, and of equal times
        headed = any(names) and not any(map(_NUMBER.fullmatch, names))
        rows = np.loadtxt(path, delimiter=comma, ndmin=2, encoding="utf-8-sig", skiprows=int(headed))
        if rows.shape[1] != len(names):
            raise ValueError(f"its first line has {len(names)} columns, the others {rows.shape[1]}")
        as_floats("the table", rows)
        named, t, points, v = names in HEADS.values(), rows[:, 0], rows[:, 2:-1], rows[:, -1]
        moves = rows.shape[1] in (5, 6) and len(t) > 1 and (np.diff(t) > 0).all()
        speeds = _speeds(t, points) if moves else np.zeros(len(t))
        some = slice(None) if named else slice(1, None)  # a path starts at rest
        near = np.allclose(speeds[some], v[some], rtol=1e-6, atol=1e-6 * speeds.max())
        if named != (speeds.any() and near):
            raise ValueError("a line is missing, doubled or damaged: its speeds are not those of its chords")
    return PathTable(t, rows[:, 1], points, v) if named else rows
