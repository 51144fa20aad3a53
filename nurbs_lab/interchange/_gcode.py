"""G-code (RS-274/NGC, as LinuxCNC reads it) of one path: straight moves with their feed.

A tool path gives one G1 move a period, and its feed in mm/min is the chord over the period, so that the
machine passes each point when the path says so. A bare curve knows no time: it is cut into chords that
stay within the paper's bow height and run at the paper's speed.
"""

import numpy as np

from nurbs_lab import paper

HOLDS = ("curves", "paths")
MAX_DOUBLINGS = 14


def write(path, parts):
    if len(parts.curves) + len(parts.paths) != 1:
        raise ValueError("a .ngc file holds one path: between two nobody knows a safe way; write two files")
    if parts.paths:
        points, t = np.asarray(parts.paths[0].points), np.asarray(parts.paths[0].t)
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        feeds = 60 * steps / np.diff(t)
    else:
        points = chords(parts.curves[0], paper.CHORD_ERROR)
        feeds = np.full(len(points) - 1, 60 * paper.SPEED)
    if points.shape[1] not in (2, 3):
        raise ValueError(f"G-code needs points in 2 or 3 dimensions, got {points.shape[1]}")
    lines = ["(nurbs_lab; lengths in mm, F in mm per minute)", "G21 G17 G90 G94 G64 P0.001"]
    lines.append(f"G0 {_words(points[0])}")
    last = None
    for point, feed in zip(points[1:], feeds, strict=True):
        if feed == 0:
            continue  # no move in this period, and F0 is an error to a machine
        word = f"F{feed:.3f}"
        lines.append(f"G1 {_words(point)}" + (f" {word}" if word != last else ""))
        last = word
    path.write_text("\n".join([*lines, "M2"]) + "\n", encoding="ascii")


def chords(curve, bow):
    """Points on the curve whose chords stay within ``bow`` of it, each span halved until they do."""
    low, high = curve.domain
    knots = np.unique(np.clip(curve.knots, low, high))
    u = knots
    for _ in range(MAX_DOUBLINGS):
        middle = (u[:-1] + u[1:]) / 2
        quarter = np.concatenate([(u[:-1] + middle) / 2, (middle + u[1:]) / 2])
        ends = curve(u)
        start, chord = ends[:-1], np.diff(ends, axis=0)
        wide = np.zeros(len(middle), dtype=bool)
        for probe in (middle, *np.split(quarter, 2)):
            wide |= _distance(curve(probe) - start, chord) > bow / 2
        if not wide.any():
            return ends
        u = np.sort(np.concatenate([u, middle[wide]]))
    return curve(u)


def _distance(offset, chord):
    """From points to the lines of their chords; to the start where the chord has no length."""
    length2 = np.einsum("ij,ij->i", chord, chord)
    along = np.einsum("ij,ij->i", offset, chord) / np.where(length2 > 0, length2, 1)
    return np.linalg.norm(offset - along[:, None] * chord, axis=1)


def _words(point):
    return " ".join(f"{axis}{value + 0.0:.6f}" for axis, value in zip("XYZ", point, strict=False))
