"""OFF: counts, then a line for each vertex and each face."""

import re

from nurbs_lab.mesh.formats.shape import Shape, as_numbers, lines_of, lists_of, require_lines, unended


def read(data):
    lines = lines_of(data)
    first = lines[0][1] if lines else [b""]
    found = re.fullmatch(rb"((?:ST)?C?N?OFF)(\d*)", first[0])  # some files lack the space after it
    if not found or b"BINARY" in first:
        raise ValueError("it does not begin with OFF, as text of this format does")
    first = [word for word in found.groups() if word] + first[1:]
    lines[0] = lines[0][0], first[1:]
    (at, counts), *lines = lines if first[1:] else lines[1:] or [(1, [])]
    if len(counts) < 2:
        raise ValueError(f"line {at}: the numbers of its vertices and faces are missing")
    vertices, faces = as_numbers([counts[:2]], [at], int)[0].tolist()
    require_lines(len(lines), vertices + faces)
    for i, words in lines[:vertices]:
        if (first[0] == b"OFF" and len(words) not in (3, 6, 7)) or len(words) < 3:
            raise ValueError(
                f"line {i}: a vertex has {len(words)} numbers; a part of it is missing or damaged"
            )
    where, rows = [i for i, _ in lines], [words for _, words in lines]
    points = as_numbers([words[:3] for words in rows[:vertices]], where[:vertices])
    return Shape(points.reshape(-1, 3), *lists_of(rows[vertices:], where[vertices:]), notes=unended(data))
