"""Curves, surfaces, whole reconstructions and tool paths: to and from other programs.

======================  ========  ===================================================================
suffix                  reads     holds
======================  ========  ===================================================================
``.step`` ``.stp``      yes       curves, surfaces, reconstructions as solids (extra ``cad``)
``.iges`` ``.igs``      yes       the same, in the older format (extra ``cad``)
``.3dm``                yes       curves, surfaces, for Rhino (extra ``cad``)
``.json``               yes       curves or surfaces, as geomdl writes and reads them
``.obj`` ``.stl``       no        surfaces as triangles; tubes stay open at their ends
``.ngc``                no        one tool path or curve, as G-code
``.csv``                no        one tool path, as a table ``t,u,x,y[,z],v``
======================  ========  ===================================================================

Lengths are mm in every format. Periodic curves and surfaces are clamped exactly on the way out, because
that is what other programs expect; a surface that is closed then has an equal first and last row. The same
items make the same file, byte for byte; only a ``.3dm`` also holds, among its properties, the second and the
temporary name it was written under, each with a checksum: Rhino's library does not let one choose them.
"""

import importlib
import os
import threading
from pathlib import Path

from nurbs_lab.common.checks import shown
from nurbs_lab.interchange import _export_items

__all__ = ["export", "read"]

_FORMATS = {
    ".step": "_step",
    ".stp": "_step",
    ".iges": "_iges",
    ".igs": "_iges",
    ".3dm": "_rhino",
    ".json": "_json",
    ".obj": "_triangles",
    ".stl": "_triangles",
    ".ngc": "_gcode",
    ".csv": "_table",
}
_READABLE = (".step", ".stp", ".iges", ".igs", ".3dm", ".json")


def export(path, *items):
    """Write curves, surfaces, reconstructions or tool paths to a file; the suffix says the format.

    The file is written beside its place and moved there when it is whole: an export that is
    interrupted leaves the old file, or none.

    Parameters
    ----------
    path : str or path
        Ends in one of the suffixes of `nurbs_lab.interchange`.
    *items : NurbsCurve, NurbsSurface, Reconstruction, ToolPath, or lists of them

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    ValueError
        Unknown suffix, nothing to write, or something the format cannot hold.
    TypeError
        An item of another kind.
    ImportError
        The format needs a package that is not installed; the message says the command.

    Examples
    --------
    >>> import tempfile
    >>> import nurbs_lab as nl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = nl.export(f"{folder}/curve.json", nl.paper.CURVE)
    ...     (again,) = nl.interchange.read(file)
    >>> again.control_points.shape
    (7, 2)
    """
    path, module = _format_of(path, _FORMATS)
    parts = _export_items.gather(items)
    parts.require(path.suffix.lower(), module.HOLDS)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"path: the folder {str(path.parent)!r} does not exist; make it first")
    beside = path.with_name(f".{os.getpid()}-{threading.get_ident()}{path.suffix}")
    try:
        module.write(beside, parts)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    return path


def read(path):
    """The NURBS curves and surfaces of a STEP, IGES, 3dm or JSON file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    list of NurbsCurve and NurbsSurface
        Curves first, then surfaces. CAD formats keep three coordinates, so a plane curve comes back
        with z = 0. Planes and straight bands (the ends of a solid) are left out; a trimmed face gives
        its whole surface.

    Raises
    ------
    FileNotFoundError
    ValueError
        Unknown suffix, or a file that holds no such thing.
    """
    path, module = _format_of(path, _READABLE)
    if not path.is_file():
        raise FileNotFoundError(f"path: there is no file {str(path)!r}")
    path.open("rb").close()  # that one may not is no damage
    try:
        found = module.read(path)
    except Exception as error:  # whatever a damaged file makes its reader say
        raise ValueError(f"path: {str(path)!r} cannot be read: {error}") from error
    if not found:
        raise ValueError(f"path: {str(path)!r} holds no NURBS curve and no NURBS surface")
    return found


def _format_of(path, known):
    try:
        path = Path(path)
    except TypeError:
        raise TypeError(f"path must be a file name, got {shown(path)}") from None
    suffix = path.suffix.lower()
    if suffix not in known:
        raise ValueError(f"path: unknown suffix {suffix!r} of {path.name!r}; known: {', '.join(known)}")
    return path, importlib.import_module(f"nurbs_lab.interchange.{_FORMATS[suffix]}")
