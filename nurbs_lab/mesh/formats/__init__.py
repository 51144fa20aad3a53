"""Mesh files as they are in use: STL, OBJ, OFF, PLY, 3MF and GLB, read to their last byte or refused.

Every reader takes the bytes of a file and returns a `Shape`; a ValueError says what is wrong, and on which
line. Nothing but the file itself is opened: no material, no texture, nothing that it names.
"""

from nurbs_lab.mesh.formats import obj, off, packages, ply, stl
from nurbs_lab.mesh.formats.shape import Shape

READERS = {
    ".stl": stl.read, ".obj": obj.read, ".ply": ply.read, ".off": off.read,
    ".3mf": packages.read_3mf, ".glb": packages.read_glb,
}  # fmt: skip


def shape_in(path) -> Shape:
    """What a mesh file holds, by its suffix.

    Raises
    ------
    ValueError
        If a part of it is missing or damaged, or it is of another format.
    """
    suffix = path.suffix.lower()
    if suffix not in READERS:
        known = ", ".join(READERS)
        raise ValueError(
            f"{suffix!r} is none of the formats {known}; read it with a library that knows it and give the "
            "mesh, or save it as one of these"
        )
    return READERS[suffix](path.read_bytes())
