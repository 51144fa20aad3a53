"""A tool path as comma-separated values, one row a period; and tables of points.

The columns are ``t`` in s, ``u``, ``x``, ``y``, ``z`` in mm, and ``v`` in mm/s, the mean speed along the
chord of the period that ends in the row (0 in the first).
"""

import warnings
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_floats, lengths


@dataclass(frozen=True, eq=False)
class PathTable:
    """The samples of a tool path as a table holds them.

    Attributes
    ----------
    t, u : ndarray, shape (n,)
        Times in s, and parameters.
    points : ndarray, shape (n, dim)
        In mm.
    v : ndarray, shape (n,)
        Mean speed of the period that ends there, in mm/s.
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
    v = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(tool_path.t)]
    table = np.column_stack([tool_path.t, tool_path.u, points, v])
    names = _names(points.shape[1])
    np.savetxt(path, table, delimiter=",", fmt="%.17g", header=",".join(names), comments="")


def read(path):
    """A `PathTable` if the first line names its columns; else the rows of numbers, as points."""
    comma = None if path.suffix.lower() == ".txt" else ","
    with path.open(encoding="utf-8-sig") as file:
        first, whole = file.readline(), file.read().endswith("\n")
    if comma and ";" in first:
        raise ValueError("its numbers are separated by semicolons; separate them by commas")
    names = [word.strip() for word in first.split(comma)]
    if dim := next((dim for dim in (2, 3) if names == _names(dim)), None):
        rows = _rows(path, comma, dim + 3, skiprows=1)
        _require_whole(rows)
        if not whole:
            raise ValueError("its last line has no end; it was cut off")
        return PathTable(rows[:, 0], rows[:, 1], rows[:, 2:-1], rows[:, -1])
    named = bool(first.strip(" \n#")) and not any(_is_number(name) for name in names)
    return _rows(path, comma, len(names), skiprows=int(named))


def _names(dim):
    return ["t", "u", *"xyz"[:dim], "v"]


def _rows(path, delimiter, columns, skiprows):
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of a file without any row
        rows = np.loadtxt(path, delimiter=delimiter, ndmin=2, encoding="utf-8-sig", skiprows=skiprows)
    if rows.shape[1] != columns:
        raise ValueError(f"its first line has {columns} columns, the others {rows.shape[1]}")
    return as_floats("the table", rows)


def _require_whole(rows):
    """Each row must be later than the one before, and its speed that of the chord between them."""
    chords = lengths(np.diff(rows[:, 2:-1], axis=0))
    periods = np.diff(rows[:, 0])
    apart = np.abs(periods * rows[1:, -1] - chords) > 1e-9 * (chords + np.abs(rows[:, 2:-1]).max())
    apart |= periods <= 0
    if rows[0, -1] != 0 or apart.any():
        row = 1 + int(np.argmax(apart)) if apart.any() else 0
        raise ValueError(
            f"row {row + 1} has a speed that is not that of its chord; a row is missing or doubled there, "
            "or a number in it is damaged"
        )


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True
