"""PLY: text and binary, with any elements and properties."""

import re
import struct

import numpy as np

from nurbs_lab.mesh.formats.shape import Shape, as_numbers, lines_of, lists_of, require_lines, unended

_PLY_TYPES = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H",
    "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f",
    "double": "d", "float64": "d",
}  # fmt: skip


def read(data):
    header = re.match(rb"ply\s*?[\r\n].*?end_header[ \t]*(\r\n|\n|\r)", data, re.DOTALL)
    if not header:
        raise ValueError("it does not begin as a PLY file does, or its header has no end; it was cut off")
    elements, order = [], None
    for line in header[0].decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"] and len(words) == 3:
            order = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}[words[1]]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[-1], [_PLY_TYPES[word] for word in words[1:-1] if word != "list"]))
        elif words and words[0] not in ("ply", "comment", "obj_info", "end_header"):
            raise ValueError(f"its header has {words[0][:40]!r}, which this format does not know")
    for name, count, properties in elements:
        if count and name != "face" and any(label.startswith("vertex_ind") for label, _ in properties):
            raise ValueError(f"its element {name!r} lists corners and is no face; write it with faces")
    counts = {name: count for name, count, _ in elements}
    body = data[header.end() :]
    read = _ply_binary(body, elements, order) if order else _ply_text(body, elements, header[0])
    missing = [name for name in "xyz" if name not in read.get("vertex", {})]
    if missing:
        raise ValueError(f"its vertices have no property {missing[0]}")
    points = np.column_stack([read["vertex"][name].astype(np.float64) for name in "xyz"])
    faces = read.get("face", {})
    empty = np.empty(0, np.int64), np.empty(0, np.int64)
    sizes, corners = faces.get("vertex_indices", faces.get("vertex_index", empty))
    if len(sizes) < counts.get("face", 0) or (len(sizes) and sizes.min() < 3):
        raise ValueError("a face of it has fewer than three corners; it is damaged")
    notes = () if order else unended(data)
    return Shape(points, sizes.astype(np.int64), corners.astype(np.int64), notes=notes)


def _ply_text(body, elements, header):
    lines = lines_of(body, 1 + len(header.splitlines()))
    require_lines(len(lines), sum(count for _, count, _ in elements))
    read = {}
    for name, count, properties in elements:
        mine, lines = lines[:count], lines[count:]
        values = [[] for _ in properties]
        for i, words in mine:
            at = 0
            for value, (_, types) in zip(values, properties, strict=True):
                listed = len(types) == 2 and at < len(words) and words[at].isdigit()
                size = 1 + (int(words[at]) if listed else 0)
                value.append(words[at : at + size])
                at += size
            if at != len(words):
                raise ValueError(f"line {i}: a {name} has {len(words)} numbers, and not {at}; it is damaged")
        where, read[name] = [i for i, _ in mine], {}
        for value, (label, types) in zip(values, properties, strict=True):
            if len(types) == 1:
                read[name][label] = as_numbers(value, where).reshape(-1)
            elif name == "face":
                read[name][label] = lists_of(value, where)
    return read


def _ply_binary(body, elements, order):
    read, at = {}, 0
    for name, count, properties in elements:
        try:
            read[name], at = _ply_rows(body, at, count, properties, order)
        except (struct.error, IndexError):
            raise ValueError(f"it ends before {count} times {name}, which its header promises") from None
    if at != len(body):
        raise ValueError(f"its elements take {at} bytes, but {len(body)} follow its header; it is damaged")
    return read


def _ply_rows(body, at, count, properties, order):
    """Columns of ``count`` rows by name, lists as their sizes and all their entries; the byte after them."""
    kinds = []
    for label, types in properties:  # of the first row
        if len(types) == 2 and count:
            kinds.append((f"{label} size", order + types[0]))
            (size,) = struct.unpack_from(kinds[-1][1], body, at + np.dtype(kinds[:-1]).itemsize)
            kinds.append((label, order + types[1], (size,)))
        else:
            kinds.append((label, order + types[-1]))
    kind = np.dtype(kinds)
    if len(body) - at >= count * kind.itemsize:
        rows = np.frombuffer(body, kind, count, at)
        lists = {label: rows[f"{label} size"] for label, types in properties if len(types) == 2 and count}
        if all((sizes == sizes[0]).all() for sizes in lists.values()):
            columns = {label: rows[label] for label, _ in properties}
            columns |= {label: (sizes, rows[label].ravel()) for label, sizes in lists.items()}
            return columns, at + count * kind.itemsize
    found = [([], []) for _ in properties]
    for _ in range(count):
        for (sizes, entries), (_, types) in zip(found, properties, strict=True):
            size = 1
            if len(types) == 2:
                (size,) = struct.unpack_from(order + types[0], body, at)
                at += struct.calcsize(types[0])
            sizes.append(size)
            entries += struct.unpack_from(f"{order}{size}{types[-1]}", body, at)
            at += size * struct.calcsize(types[-1])
    columns = {label: tuple(map(np.array, pair)) for (label, _), pair in zip(properties, found, strict=True)}
    return columns | {label: columns[label][1] for label, types in properties if len(types) == 1}, at
