"""The milling room beside OpenCAMLib: dropping the cutter, waterlines, whole finishing programs."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import opencamlib as ocl

import nurbs_lab as nl
from benchmarks.harness import Bar, Row, compare, medians
from nurbs_lab import machining
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.field import tip_field
from nurbs_lab.machining.finish import CUSP
from nurbs_lab.machining.fit import Fitting, fit_paths
from nurbs_lab.machining.passes import layout
from nurbs_lab.machining.waterlines import waterlines
from nurbs_lab.mesh import samples

ROOM = "machining"
BALL = nl.Cutter("ball", diameter=6.0, length=200.0)
SCALLOP, TOLERANCE, FEED = 0.02, 0.005, 50.0
PASSES = 40  # whose motion is compared
CHORDS = 0.2, 0.5, 0.8  # shares of G1's tolerance for its chords, tried in turn; the rest is for its corners
SPLINES = "lines of BSPLINE, of those of G1"
MOTION = f"time of {PASSES} passes, of that of blended G1"
IDEAL = f"time of {PASSES} passes at full feed, of that of blended G1"
PLACES = 200  # along each side of the part
THEIRS = 2000  # of these places are given to OpenCAMLib, whose time is then scaled
#: Kind -> OpenCAMLib's cutter for one of ours.
PEERS = {
    "ball": lambda cutter: ocl.BallCutter(cutter.diameter, cutter.length),
    "flat": lambda cutter: ocl.CylCutter(cutter.diameter, cutter.length),
    "bull": lambda cutter: ocl.BullCutter(cutter.diameter, cutter.corner_radius, cutter.length),
    "cone": lambda cutter: ocl.ConeCutter(cutter.diameter, np.radians(cutter.angle / 2), cutter.length),
}
PARTS = {
    "spleen": lambda: samples.frog_organ("spleen"),
    "eye": lambda: samples.frog_organ("eye_white"),
    "nut": samples.nut,
    "liver": lambda: samples.frog_organ("liver"),
    "smooth spleen, rebuilt": lambda: _rebuilt("spleen"),
    "smooth eye, rebuilt": lambda: _rebuilt("eye_white"),
}


def rows() -> list[Row]:
    """Every row of the room's table."""
    return [_drop("eye", 60), _drop("liver", 250), _waterlines(), *(_finish(name) for name in PARTS)]


def _rebuilt(organ):
    """A solid of NURBS faces within 0.5 % of the organ's size."""
    mesh = samples.frog_organ(organ, blur_mm=2.0)
    return nl.reconstruct(mesh, tolerance=0.005 * float(np.ptp(mesh.bounds, axis=0).max()))


def _drop(name, factor):
    mesh = PARTS[name]()
    part, surface = machining.prepare_part(mesh), stl_surface(mesh)
    low, high = mesh.bounds[:, :2]
    line = [np.linspace(a, b, PLACES) for a, b in zip(low, high, strict=True)]
    xy = np.stack(np.meshgrid(*line, indexing="ij"), axis=-1).reshape(-1, 2)
    few = xy[np.sort(np.random.default_rng(0).choice(len(xy), THEIRS, replace=False))]
    found, floor = {}, mesh.bounds[0, 2] - 10.0
    seconds, first = medians(
        {
            "nurbs_lab": lambda: nl.drop_cutter(part, BALL, xy),
            "opencamlib": lambda: found.update(z=dropped(surface, PEERS["ball"](BALL), few, floor)),
        },
        repeats=3,
    )
    seconds["opencamlib"] *= len(xy) / THEIRS
    ours = np.maximum(nl.drop_cutter(part, BALL, few), floor)
    return Row(
        ROOM,
        f"frog's {name}, {len(mesh.faces):,} triangles: a 6 mm ball dropped at {len(xy):,} places",
        seconds,
        (Bar("opencamlib", factor),),
        first["nurbs_lab"],
        notes=f"OpenCAMLib with two threads at {THEIRS:,} of the places, its time scaled",
        figures={"largest difference mm": float(np.abs(ours - found["z"]).max())},
        most={"largest difference mm": 1e-9},
    )


def _waterlines():
    """Ten waterlines; OpenCAMLib does one of them, and its time is scaled."""
    mesh, cutter = PARTS["liver"](), nl.Cutter("ball", diameter=3.0)
    part, surface = machining.prepare_part(mesh), stl_surface(mesh)
    low, high = mesh.bounds[:, 2]
    levels = low + (high - low) * np.arange(1, 11) / 12

    def ours():
        touch = contact(part, cutter)
        return waterlines(touch, tip_field(touch, 0.2, low, 2.0), levels)

    def theirs():
        peer, water = ocl.BallCutter(3.0, 200.0), ocl.Waterline()
        water.setSTL(surface)
        water.setCutter(peer)
        water.setZ(float(levels[8]))
        water.setSampling(0.2)
        water.setThreads(2)
        water.run()
        return water.getLoops()

    seconds, first = medians({"nurbs_lab": ours, "opencamlib": theirs}, repeats=1)
    seconds["opencamlib"] *= len(levels)
    return Row(
        ROOM,
        "frog's liver: ten waterlines of a 3 mm ball, sampled every 0.2 mm",
        seconds,
        (Bar("opencamlib", 100),),
        first["nurbs_lab"],
        notes="OpenCAMLib with two threads and one waterline, its time scaled",
    )


def _finish(name):
    part, found = PARTS[name](), {}
    size = f"{len(part.surfaces)} NURBS faces" if "rebuilt" in name else f"{len(part.faces):,} triangles"

    def finish():
        found.update(program=nl.finish(part, BALL, scallop=SCALLOP, tolerance=TOLERANCE, feed=FEED))

    most = {
        "gouge mm": TOLERANCE,
        "99 % of the reached area mm": SCALLOP,
        "area above 1.2 scallops": 0.0,
    }
    row = compare(
        ROOM,
        f"{name}, {size}: finished by a 6 mm ball, scallop 20 µm, tolerance 5 µm",
        {"nurbs_lab": finish},
        repeats=1,
        notes="figures by verify, whose samples are others than those of finish",
        most=most | ({"seconds": 12.0} if name == "liver" else {}),
    )
    program = found["program"]
    seen = nl.verify(program, part)
    row.figures.update(
        {
            "gouge mm": seen.gouge,
            "99 % of the reached area mm": seen.percentile(99),
            "area above 1.2 scallops": float(np.mean(np.append(seen.left, seen.bridged) > 1.2 * SCALLOP)),
            "undercut mm²": seen.unreachable["undercut"],
            "narrow mm²": seen.unreachable["narrow"],
            "length m": sum(curve.length() for curve in program.curves) / 1e3,
            "moves": len(program.moves),
            "control points": sum(len(curve.control_points) for curve in program.curves),
            "lines of G1": (straight := _lines(program, "g1")),
            SPLINES: _lines(program, "siemens") / straight,
            **dict(zip((MOTION, IDEAL), _motion(part), strict=True)),
        }
    )
    return row


def _lines(program, dialect):
    """Lines of the program in a file of this dialect, within half of its tolerance of the curves."""
    with tempfile.TemporaryDirectory() as folder:
        options = {"dialect": dialect, "tolerance": TOLERANCE / 2, "units": "mm", "axes": "XYZ"}
        return len(nl.export(Path(folder) / "part.ngc", program, **options).read_text().splitlines())


def _motion(part):
    """Time of some passes, each from rest to rest, of that of the same passes as G1 blended as by G64.

    Both stay within half of the tolerance of the exact cutter locations and keep the same limits. G1 has the
    share of chords and corners in its tolerance with which it is fastest. The second result is the least
    time that any path of this length needs: one ramp, else the full feed.
    """
    limits = {"acceleration": 2000.0, "axis_acceleration": 1000.0, "chord_error": 1e-3, "period_s": 1e-3}
    part, half = machining.prepare_part(part), TOLERANCE / 2
    plan = layout(contact(part, BALL, half), BALL, CUSP * SCALLOP, part.bounds[0, 2])
    tips = np.column_stack([plan.field.places(), plan.field.z.ravel()])
    paths = plan.paths(tips, tips[:0])
    paths = [paths[i] for i in np.linspace(0, len(paths) - 1, PASSES).astype(int)]
    times = []
    for path in fit_paths(Fitting(part, BALL, TOLERANCE), paths):
        curve = path.curve
        ways = [
            nl.interchange.blend(_chords(path.points, share * half), tolerance=(1 - share) * half)
            for share in CHORDS
        ]
        planned = [nl.plan_feed(way, speed=FEED, **limits).duration for way in (curve, *ways)]
        times.append([curve.length() / FEED + FEED / limits["axis_acceleration"], *planned])
    ideal, ours, *theirs = np.sum(times, axis=0)
    return ours / min(theirs), ideal / min(theirs)


def _chords(points, tolerance):
    """Some of the points, such that the polyline through them misses none by more than the tolerance."""
    chord = points[-1] - points[0]
    along = np.clip((points - points[0]) @ chord / max(chord @ chord, 1e-300), 0.0, 1.0)
    off = np.linalg.norm(points - points[0] - along[:, None] * chord, axis=1)
    if (far := int(off.argmax())) in (0, len(points) - 1) or off[far] <= tolerance:
        return points[[0, -1]]
    return np.vstack([_chords(points[: far + 1], tolerance), _chords(points[far:], tolerance)[1:]])


def stl_surface(mesh):
    """A mesh as OpenCAMLib takes it."""
    surface = ocl.STLSurf()
    for corners in np.asarray(mesh.triangles).tolist():
        surface.addTriangle(ocl.Triangle(*(ocl.Point(*corner) for corner in corners)))
    return surface


def dropped(surface, peer, xy, floor):
    """Heights of the tip by OpenCAMLib, on two threads; it does not keep the cutter ``peer`` alive."""
    drop = ocl.BatchDropCutter()
    drop.setSTL(surface)
    drop.setCutter(peer)
    drop.setThreads(2)
    for x, y in xy.tolist():
        drop.appendPoint(ocl.CLPoint(x, y, floor))
    drop.run()
    return np.array([point.z for point in drop.getCLPoints()])
