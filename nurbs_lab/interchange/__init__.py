"""Curves, surfaces, whole reconstructions and tool paths: to and from other programs.

======================  =====================================================================================
suffix                  what `export` writes, and `read` gives back
======================  =====================================================================================
``.step`` ``.stp``      curves, surfaces, reconstructions as solids (extra ``cad``); a list of shapes
``.iges`` ``.igs``      the same, in the older format
``.json``               curves or surfaces, as geomdl writes and reads them; a list of shapes
``.obj`` ``.stl``       surfaces as triangles, reconstructions as closed meshes; a `trimesh.Trimesh`
``.ply`` ``.off``       only read, as ``.3mf`` ``.glb`` are: a `trimesh.Trimesh`; points of PLY, OFF, OBJ
``.ngc`` ``.nc``        a curve, tool path or program for a machine tool; also ``.mpf``, ``.tap`` and others,
                        and ``.h`` for Heidenhain's; a `Program`
``.csv`` ``.txt``       a tool path, a table ``t,u,x,y[,z],v`` (only a ``.csv``); a `PathTable`, or points
======================  =====================================================================================

Lengths are mm in every format. Readers compare what they find with what the file promises; a part that is
missing is refused, or warned of by name. Periodic curves and surfaces are clamped exactly on the way out,
because that is what other programs expect. The same items make the same file, byte for byte.

What steers files, and what half and twice of it changes (2026-11). `smooth` within 10 µm: a rounded
rectangle, waves of 300 to 2,000 points with and without noise, a zigzag; `export` within 1 µm: a circle and a
rational cubic; a helix of one turn.

======================  ===========  =====================================  ==================================
constant                value, unit  half                                   twice
======================  ===========  =====================================  ==================================
smoothing.CORNER        20°          3 curves of a noisy wave, not 1        a zigzag of 23° is 1 curve, not 39
smoothing.AROUND        8 tolerances 5 corners of noise stay (1: 46 do)     nothing
smoothing.STRAIGHT      0.1          nothing                                nothing; 1: flat arcs become lines
_pieces.MARGIN          0.9          25 control points of a noisy wave,     (1: exceeded between the probes)
                                     not 21; a cubic 36 arcs, not 32
_dialects.PLACES        18           18 of 1,481 arcs up to 1.9 tolerances  nothing
HELIX_MM                1e-7         19 % more cubics of a helix            15 % fewer
LEAST_RADIUS_MM         2.5e-3       LinuxCNC refuses arcs of 1 to 2 µm     nothing
MOST_TURN               330°         3 blocks, not 1, for an arc of 320°    a circle open by 1 µm is 1 µm long
_gcode_shapes.APART     5 µm, 0.1 %  more arcs that miss their ends named   fewer named than LinuxCNC refuses
FINENESS                1e-4         4 times the triangles of a wavy net    nothing
SMALL_MM                1000         a plate of 0.6 m in whole mm is asked  a hole 1.5 m off in µm is not
======================  ===========  =====================================  ==================================

As in LinuxCNC: CLEAR_MM, FIRST_OF_MACHINE, LOCAL, SAME, WHOLE. Limits of work, of a file or of its reader:
LARGEST, MOST_BLOCKS, MOST_CALLS, MOST_COORDINATE, MOST_HALVINGS, MOST_PECKS, MOST_PIECES, TRIALS,
MEMORY_BYTES, MEMORY_PER_BYTE, PATIENCE_S, PATIENCE_S_PER_MB. Rounding of written numbers, half and twice of
which change nothing: APART_MM, FINEST_MM, JOINS_MM, KNOT_DIGITS, WEIGHT_DIGITS; nor do those of LONG, PROBES
and SAMPLES. Of PARTS half makes 0.4 % more chords and twice 0.1 % fewer (716 curves).
"""

import importlib
import secrets
import stat

from nurbs_lab.common.checks import as_file, as_path
from nurbs_lab.interchange._dialects import DIALECTS
from nurbs_lab.interchange._export_items import PROGRAMS, Parts
from nurbs_lab.interchange._gcode import Setup
from nurbs_lab.interchange.smoothing import blend, smooth

__all__ = ["DIALECTS", "Setup", "blend", "export", "read", "smooth"]

_FORMATS = {".step": "_step", ".stp": "_step", ".iges": "_iges", ".igs": "_iges", ".json": "_json"}
_FORMATS |= {".obj": "_triangles", ".stl": "_triangles", ".csv": "_table"}
_FORMATS |= dict.fromkeys(PROGRAMS, "_gcode")
READABLE = _FORMATS | {".txt": "_table"} | dict.fromkeys(PROGRAMS, "_gcode_reader")
READABLE |= dict.fromkeys((".ply", ".off", ".3mf", ".glb"), "_triangles")


def export(path, *items, dialect=None, feed=None, tolerance=None, units=None, axes=None, setup=None):
    """Write curves, surfaces, reconstructions or tool paths to a file; the suffix says the format.

    Parameters
    ----------
    path : str or path
        Ends in one of the suffixes of `nurbs_lab.interchange`.
    *items : NurbsCurve, NurbsSurface, Reconstruction, ToolPath, Program, or lists of them
    dialect : {"g1", "arcs", "linuxcnc", "siemens", "fanuc", "heidenhain"}, optional
        Of a program: chords (the default), arcs G2 and G3, G5.2, BSPLINE, G06.2, or SPL. The last
        three write circles and helices as arcs. A tool path without a dialect is a move a period.
    feed : float, optional
        Speed along a curve, in mm/s; the moves of a program have their own.
    tolerance : float, optional
        Largest distance of the written moves from the curve, in mm, at least 1e-7, the last digit written;
        needed where a dialect approximates. More than a million moves for one curve are refused.
    units : {"mm", "inch"}, optional
        Of the written numbers.
    axes : str, optional
        One letter for each coordinate, such as "XYZ".
    setup : Setup, optional
        Tool, spindle, offset, first and last moves of a program; without it the file holds moves only.

    Returns
    -------
    Path
        The file that was written; an export that is interrupted leaves the old one, or none.

    Raises
    ------
    ValueError, TypeError
        Unknown suffix, nothing to write, something the format cannot hold, or a curve in a program
        without its feed, tolerance, units and axes: none of them is chosen in silence.
    ImportError
        The format needs a package that is not installed; the message says the command.

    Examples
    --------
    >>> import tempfile
    >>> import nurbs_lab as nl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = nl.export(f"{folder}/curve.json", nl.paper.CURVE)
    ...     (again,) = nl.read(file)
    >>> again.control_points.shape
    (7, 2)
    """
    path, module = _format_of(path, _FORMATS)
    options = {"dialect": dialect, "feed": feed, "tolerance": tolerance, "units": units, "axes": axes}
    options = {name: value for name, value in {**options, "setup": setup}.items() if value is not None}
    if options and path.suffix.lower() not in PROGRAMS:
        said = f"{next(iter(options))} is for .ngc files and other programs"
        raise ValueError(f"{said}, and path is {path.name!r}; leave it out")
    parts = Parts(items)
    parts.require(path.suffix.lower())
    if not path.parent.is_dir():
        raise FileNotFoundError(f"path: the folder {str(path.parent)!r} does not exist; make it first")
    if path.is_dir():
        raise IsADirectoryError(f"path: {str(path)!r} is a folder; give the name of a file in it")
    _replace(path, lambda beside: module.write(beside, parts, **options))
    return path


def _replace(path, write):
    """Write a new file beside the one that a path or its links lead to, and move it there with its mode."""
    whole = path.resolve()
    beside = whole.with_name(f".{secrets.token_hex(12)}{path.suffix}")
    try:
        beside.touch(exist_ok=False)
        if whole.exists():
            beside.chmod(stat.S_IMODE(whole.stat().st_mode))
        try:
            write(beside)
        except OSError as error:
            if error.errno is None:  # OpenCASCADE does not say why: the disk does
                beside.write_bytes(bytes(1 << 20))
            raise
        beside.replace(whole)
    except OSError as error:  # names the file beside it
        said = error.strerror or error
        raise type(error)(error.errno, f"path: {str(path)!r} cannot be written: {said}") from None
    finally:
        beside.unlink(missing_ok=True)


def read(path, unit=None):
    """What a file holds: curves and surfaces, a mesh, points, a tool path or a program, by its suffix.

    Programs are those of RS274/NGC (LinuxCNC, with its o-words, parameters, cycles and splines), and of
    these: Fanuc's G5.1, G6.2, M98, WHILE, GOTO, beside an O number FIX, FUP and MOD, and there or beside
    G54.1 G10; Siemens' BSPLINE, IC, AC, CR=, TURN=, R parameters, CYCLE81 to 89 and SUPA; Heidenhain's L, CC,
    C, CP, CR, SPL, TOOL CALL, cycles for holes, M91 and M136, where axes alone are an L, and an arc without
    DR turns as the one before; moves of printers. A curve without length is no move. What LinuxCNC refuses is
    read as by others: G9, G11, G15, G16, G50, G60, G62, G63, G67, G69 to G71, M13, M14, M91 and M92; D and H
    in any block, several M words, G4 with X, U, F or S, cycles with P or without, with L0 and heights of the
    cycle before, K0 of a flat arc, G5 without its word or with Z, G5.1 without I or J, G93 without F or move,
    M61 to M68 without their letters, X=5, #1=#2+1, names and comments beside %, comments before an o-word.
    Tools, outputs, angles of M19 and axes are not looked up, and spindles may stand still.

    Refused by name are compensation of the radius, cycles of lathes, turned, scaled or shifted axes, rounded
    corners, probes, macros and what a file does not hold; also CIP, CT and POLY of Siemens, CALL, LP, CT,
    RND, FU, FZ and M103 of Heidenhain. Another axis, orders of a printer, a position of the machine and a
    program that nothing calls are left out with a warning.

    The time grows in proportion to the size of the file. STEP and IGES files are read in a process of
    their own, which is stopped after 60 s and 2 s for each megabyte, or beyond 4 GB of memory.

    Parameters
    ----------
    path : str or path
    unit : str, optional
        Of a mesh file: what its numbers are, 'mm', 'cm', 'm', 'um', 'inch', 'ft' or 'mil', or another
        spelling of these, such as 'feet' or 'micrometres'. The result is in mm.
        Without it they are mm, or what a 3MF file states, or metres in a GLB, as that format says.

    Returns
    -------
    list of NurbsCurve and NurbsSurface, trimesh.Trimesh, Program, PathTable, or ndarray (n, dim)
        As the table of `nurbs_lab.interchange` says; an array of the points of a table, with commas, blanks,
        or semicolons and decimal commas, whose header may name x, y and z in any order, their units, and
        other columns beside all three; or of a PLY, OFF or OBJ without faces. Curves come before surfaces.
        CAD formats keep three coordinates, so a plane curve comes back with z = 0; planes, such as the sides
        of a block, are left out, and a file of nothing else is refused: save it as an STL for its whole
        shape. A trimmed face is its whole surface. Polygons are divided into triangles; equal vertices of an
        STL are one. OBJ and 3MF do not say how many faces they have, nor a table its rows or G-code its
        moves: nobody can see that whole lines of such a file are missing. Moves of a program know their
        lines.

    Raises
    ------
    FileNotFoundError, TypeError
        If ``path`` is no file, or no file name.
    ValueError
        Unknown suffix, or a file that holds no such thing or is damaged.

    Warns
    -----
    UserWarning
        If the file names more shapes than its reader finds, may be cut off, has words that are left out, or
        if a unit is open: a GLB, a program without G20 or G21, or a part under 1 mm or over 10 m whose file
        states none.

    Examples
    --------
    >>> import tempfile
    >>> import nurbs_lab as nl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     nl.read(nl.export(f"{folder}/curve.json", nl.paper.CURVE))
    [NurbsCurve(degree 2, 7 control points in 2-D, polynomial, u in [0, 1])]
    """
    path, module = _format_of(path, READABLE)
    as_file("path", path)
    if unit is not None and READABLE[path.suffix.lower()] != "_triangles":
        raise ValueError(f"unit is {unit!r}, but {path.name!r} is no mesh file; leave it out")
    try:
        found = module.read(path) if unit is None else module.read(path, unit)
    except Exception as error:  # a damaged file may make its reader raise anything
        said = error if isinstance(error, (ValueError, OSError, ImportError)) else repr(error)
        raise ValueError(f"path: {str(path)!r} cannot be read: {said}") from error
    if isinstance(found, list) and not found:
        said = "holds no curve and no surface other than planes, which are left out"
        raise ValueError(f"path: {str(path)!r} {said}; save the part as an STL for its whole shape")
    return found


def _format_of(path, modules):
    path = as_path("path", path)
    suffix = path.suffix.lower()
    if suffix not in modules:
        said = f"unknown suffix {suffix!r} of {path.name!r}; known: {', '.join(modules)}"
        raise ValueError(f"path: {said}; name a program .nc, and a table of points .txt")
    return path, importlib.import_module(f"nurbs_lab.interchange.{modules[suffix]}")
