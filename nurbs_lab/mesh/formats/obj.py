"""Wavefront OBJ: vertices and faces; corners are numbered from 1, or backwards from their own line."""

import re

import numpy as np

from nurbs_lab.mesh.formats.shape import Shape, as_numbers, lines_of, unended

#: Words of lines without corners; with those of free-form curves.
_OTHER_WORDS = set(
    b"vn vt vp g o s mg usemtl mtllib usemap maplib lod bevel c_interp d_interp shadow_obj trace_obj cstype "
    b"deg bmat step curv curv2 surf parm trim hole scrv sp end con ctech stech bsp bzp cdc cdp call csh"
    .split()
)  # fmt: skip


def read(data):
    points, where, sizes, corners, others, strange, late, lines = [], [], [], [], [], [], False, False
    for number, words in lines_of(data):
        if words[0] == b"v":
            points.append(words[1:4])
            where.append(number)
            if len(words) in (5, 6) and words[4:] not in ([b"1"], [b"1.0"], [b"1.000000"]):
                strange.append(f"line {number} has {len(words) - 1} numbers after 'v'")
        elif words[0] in (b"f", b"l", b"p"):
            few = [_corner(word, len(points), number) for word in words[1:]]
            late |= max(few, default=0) >= len(points)
            if words[0] == b"f":
                sizes.append(len(few))
                corners += few
            else:
                others += few
                lines |= words[0] == b"l"
        elif words[0] not in _OTHER_WORDS:
            strange.append(f"line {number} begins with {words[0].decode(errors='replace')[:40]!r}")
    if lines and not sizes:
        raise ValueError("it has lines and no face; give it faces, or points alone")
    corners, count = np.array(corners, dtype=np.int64), len(points)
    if corners.size and corners.max() >= count:
        raise ValueError(f"a corner, {corners.max() + 1}, is no number of a vertex: it has {count}")
    if min(sizes, default=3) < 3:
        raise ValueError("a face of it has fewer than three corners; it is damaged")
    unused = count - len(np.union1d(corners, np.array(others, dtype=np.int64)))
    notes = unended(data)
    if unused and notes:
        raise ValueError(f"{notes[0]}: {unused} of its {count} vertices belong to no face")
    if unused:
        notes = (f"{unused} of its {count} vertices belong to no face; it may be cut off",)
    if late:
        notes += ("corners are named before their vertices; lines of it may be lost or moved",)
    if strange:
        notes += (f"{strange[0]}, which this format does not know; lines like it: {len(strange)}",)
    points = as_numbers(points, where).reshape(-1, 3)
    return Shape(points, np.array(sizes, dtype=np.int64), corners, notes=notes)


def _corner(word, count, line):
    """Number of a vertex from 0: from 1 in the file, or backwards from the last one before this line."""
    found = re.fullmatch(rb"(-?\d{1,10})(?:/(?:-?\d+)?){0,2}", word)
    if not found or not (value := int(found[1])) or value < -count:
        raise ValueError(
            f"line {line}: a corner, {word.decode(errors='replace')[:40]!r}, is no number of a vertex"
        )
    return value - 1 if value > 0 else count + value
