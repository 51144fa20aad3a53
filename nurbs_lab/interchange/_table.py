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
from nurbs_lab.mesh.formats.shape import as_utf8, unended
from nurbs_lab.mesh.read import UNITS, short_unit

_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)
_AXIS = re.compile(r"\s*([xyz])\s*(?:[ _\[(]+([^\W\d_]+)[\])]?)?\s*", re.IGNORECASE)
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

    Numbers are separated by semicolons if the first line has one, and may then have decimal commas; else by
    commas or blanks. Words may stand in quotes, and other columns beside x, y and z.
    """
    text = re.sub(r'"([^",;\n]*)"', r"\1", as_utf8(path.read_bytes()).decode("utf-8-sig"))
    lines = text.replace("\u2212", "-").splitlines() or [""]
    for note in unended(text.encode()):
        warnings.warn(f"path: {path.name}: {note}", stacklevel=3)
    if re.search(r"^[^#\n]*[^\s#]#", text, re.MULTILINE):
        raise ValueError("a number of it goes on with '#', which begins a comment; it is damaged")
    rows = [line.partition("#")[0].strip() for line in lines]
    found = [(i, row) for i, row in enumerate(rows) if row] or [(0, "")]
    first, head = found[0]
    mark = ";" if ";" in head else "," if "," in head else None
    while mark and all(row.endswith(mark) for _, row in found):  # an empty column
        found = [(i, row[:-1].rstrip()) for i, row in found]
    if mark == ";" and any(re.search(r"\d,|,\d", row) for row in rows):
        if any(re.search(r"\d\.|\.\d", row) for row in rows):
            raise ValueError("its numbers have points and decimal commas; write all of them with points")
        found = [(i, row.replace(",", ".")) for i, row in found]
    names = [word.strip() for word in found[0][1].split(mark)]
    headed, named = not any(map(_NUMBER.fullmatch, names)), names in HEADS.values()
    above = lines[first - 1].lstrip("# ").split(mark)  # of a comment
    axes = {} if named else _axes(names if headed else above, len(names))
    by = {";": "semicolons", ",": "commas"}.get(mark, "blanks")
    if headed and not (axes or named):
        said = f"its first line {head[:40]!r} is neither numbers nor names separated by {by}"
        raise ValueError(f"{said}; name columns x, y and z, such as 'x[mm]'; or name a program .nc")
    rows = _numbers(found[headed:], len(names), [*axes] or [*range(len(names))], mark, by)
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
    if rows.shape[1] > 3:
        raise ValueError(f"its rows have {len(names)} numbers; name x, y and z of them in a first line")
    return rows * [*axes.values()] if axes else rows


def _axes(names, count):
    """The columns of x, y and z -> their units in mm; nothing unless each is named once among ``count``."""
    matches = enumerate(map(_AXIS.fullmatch, names))
    found = sorted((m[1].lower(), i, UNITS.get(short_unit(m[2] or "mm"))) for i, m in matches if m)
    whole = len(names) == count and [axis for axis, _, mm in found if mm] == list("xyz"[:count])
    return {i: mm for _, i, mm in found if mm} if whole else {}


def _numbers(rows, count, columns, mark, by):
    """The numbers of columns of rows ``[(place of the line, text), ...]``; a row of others is named."""
    texts = [row for _, row in rows] or ["-"]
    with contextlib.suppress(ValueError):
        if all(len(text.split(mark)) == count for text in texts):
            return np.loadtxt(texts, delimiter=mark, ndmin=2, usecols=columns)
    for i, row in rows:
        words = [word.strip() for word in row.split(mark)]
        strange = (
            [words[j] for j in columns if not _NUMBER.fullmatch(words[j])] if len(words) == count else [row]
        )
        if strange:
            said = f"could not convert string {strange[0]!r} of line {i + 1}"
            raise ValueError(f"{said}; make it {count} numbers separated by {by}, as the first line has")
    raise ValueError("it holds no row of numbers")
