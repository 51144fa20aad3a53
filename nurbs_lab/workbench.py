"""Your own part, all the way: read, rebuild, plan a feed, follow it, mill, export; by call or by widgets."""

from __future__ import annotations

import html
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

from nurbs_lab import interchange, paper, plotting
from nurbs_lab.common.checks import as_choice, as_kind, said_of
from nurbs_lab.interchange import DIALECTS, smooth
from nurbs_lab.machining import Cutter, Program, finish
from nurbs_lab.mesh import Reconstruction, mesh_from_points, reconstruct, samples, slice_mesh
from nurbs_lab.motion import ToolPath, plan_feed, software_steppers, trace
from nurbs_lab.motion.curves import benchmark_curves
from nurbs_lab.nurbs import NurbsCurve, approximate_curve, interpolate_curve
from nurbs_lab.nurbs.along import lengths_along, points_along
from nurbs_lab.plotting.picture import bundle, png_of, sheet
from nurbs_lab.plotting.stage import png

#: Parts that every installation has, by the name that a person picks.
PARTS = {
    "the paper's curve": lambda: paper.CURVE,
    "butterfly": lambda: benchmark_curves()["butterfly"].curve,
    "frog: white of the eye": lambda: samples.frog_organ("eye_white", blur_mm=2.0),
    "frog: spleen": lambda: samples.frog_organ("spleen", blur_mm=2.0),
    "nut": samples.nut,
    "ant": samples.ant,
}


@dataclass(frozen=True, eq=False)
class Part:
    """A part and the results made from it.

    Attributes
    ----------
    curve : NurbsCurve
        What the tool follows: the given curve, the longest cut of a program, or the longest contour of a mesh
        at half its height.
    path : ToolPath
        The motion along it.
    reconstruction : Reconstruction or None
        The surfaces, if the part came as a mesh or a cloud.
    program : Program or None
        Finishing moves, if a cutter was given; the smooth moves, if the part came as a program.
    blocks : int
        Moves of the program that the part came as.
    """

    curve: NurbsCurve
    path: ToolPath
    reconstruction: Reconstruction | None = None
    program: Program | None = None
    blocks: int = 0

    def export(self, folder, **options) -> list[Path]:
        """Write ``part.step``, ``path.csv`` and ``path.ngc`` into a folder, which is made if need be.

        With ``options`` of `nurbs_lab.export` (dialect, tolerance, units, axes) the program is written too,
        as ``program.ngc``.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        shape = self.curve if self.reconstruction is None else self.reconstruction
        files = {"part.step": shape, "path.csv": self.path, "path.ngc": self.path}
        written = [interchange.export(folder / name, item) for name, item in files.items()]
        if self.program is not None and options:
            written.append(interchange.export(folder / "program.ngc", self.program, **options))
        return written

    def pictures(self) -> dict[str, bytes]:
        """PNG pictures by caption."""
        found, made = {}, self.reconstruction
        if made is not None:
            found["solid"] = png(plotting.surface(made))
            found["deviation"] = png(plotting.deviation(made.mesh, made.deviation, tolerance=made.tolerance))
        found["tool path"] = png_of(plotting.path(self.path))
        found["feed"] = png_of(plotting.feed(self.path.feed))
        found["feed fluctuation"] = png_of(plotting.fluctuation(self.path))
        return found

    def summary(self) -> str:
        """The main figures, one on each line."""
        lines, made = [], self.reconstruction
        if made is not None:
            farthest = f"largest deviation {made.deviation.max:.3f} mm"
            verdict = f"tolerance {made.tolerance:g} mm " + ("kept" if made.within_tolerance else "missed")
            lines.append(f"{len(made.surfaces)} faces; {farthest}, {verdict}")
        if self.program is not None:
            replaced = f", for {self.blocks} in the file" if self.blocks else ""
            lines.append(f"program of {len(self.program.moves)} moves{replaced}")
        worst = 100 * np.abs(self.path.chord_fluctuation[:-1]).max(initial=0.0)  # the last is what was left
        lines.append(f"path of {self.curve.length():.2f} mm in {self.path.t[-1]:.3f} s")
        size = f"{worst:.1e}" if worst > 1e-6 else "below 1e-6"  # where rounding decides
        said = f"largest feed fluctuation {size} %, by chord, before the last step"
        lines.append(f"{self.path.stepper}: {said}")
        return "\n".join(lines)


def read_part(path, unit=None):
    """A mesh, a curve, the points of a cloud, or a program, by the suffix of the file, as `read` has it.

    Of CAD files it is the first curve; a table of points becomes the curve through them. ``unit`` is that of
    the numbers of a mesh file.
    """
    found, path = interchange.read(path, unit), Path(path)
    if isinstance(found, list):
        found = [item for item in found if isinstance(item, NurbsCurve)]
        if not found:
            raise ValueError(f"path: {path.name} holds no curve; save one as a NURBS curve, or give a mesh")
        return found[0]
    if hasattr(found, "u"):  # the table of a tool path
        found = found.points
    if not isinstance(found, np.ndarray) or path.suffix.lower() not in (".csv", ".txt"):
        return found
    with said_of("path"):
        return interpolate_curve(found)


def work(
    part,
    *,
    tolerance=0.5,
    speed=20.0,
    acceleration=500.0,
    stepper="chord-corrected",
    cutter=None,
    scallop=0.1,
) -> Part:
    """Read, rebuild, plan and follow a part with one call.

    Parameters
    ----------
    part : trimesh.Trimesh, NurbsCurve, points of a cloud (n, 3), Program, or file name
    tolerance : float
        Largest deviation in mm: of the faces and the path from the mesh, or of the curves from the facets of
        a program.
    speed, acceleration : float
        Limits of the motion, in mm/s and mm/s², and the feed of a program is one; the chord error is at most
        1 µm in periods of 1 ms.
    stepper : str
        One of `STEPPERS`.
    cutter : Cutter, optional
        If given, the mesh is finished with it too; curves and programs are not, with a warning.
    scallop : float
        Height of what the cutter may leave between its passes, in mm.

    Returns
    -------
    Part
    """
    if isinstance(part, (str, Path)):
        part = read_part(part)
    made, program, blocks = None, None, 0
    if isinstance(part, Program):
        blocks = len(part.moves)
        program = smooth(part, tolerance=tolerance)
        cuts = [move for move in program.moves if move.kind == "cut"]
        if not cuts:
            raise ValueError("part: its program has no move that cuts; give one with G1, G2 or G3")
        move = max(cuts, key=lambda move: move.curve.length())
        curve, speed = move.curve, min(speed, move.feed or speed)
    elif isinstance(part, NurbsCurve):
        curve = part
    else:
        if isinstance(part, (np.ndarray, list, tuple)):
            with said_of("part"):
                part = mesh_from_points(part)
        as_kind("part", part, trimesh.Trimesh)
        made = reconstruct(part, tolerance=tolerance)
        part = made.mesh  # the mended one
        (middle,) = slice_mesh(part, [part.bounds[:, 2].mean()])
        contour = max(middle.contours, key=lambda contour: contour.length)
        curve = _along(contour, tolerance)
        if cutter is not None:
            as_kind("cutter", cutter, Cutter)
            program = finish(part, cutter, scallop=scallop, tolerance=scallop / 5, feed=speed)
    if made is None and cutter is not None:
        warnings.warn("cutter is not used: only a mesh or a cloud of points is milled", stacklevel=2)
    feed = plan_feed(curve, speed=speed, acceleration=acceleration, chord_error=1e-3, period_s=1e-3)
    return Part(curve, trace(curve, feed, stepper=stepper), made, program, blocks)


def _along(contour, tolerance):
    """A smooth curve within a tolerance of a contour, also between the points of this."""
    ring = contour.ring_3d
    corners = lengths_along(ring)
    at = np.union1d(corners, np.arange(0.0, corners[-1], tolerance))
    at = at[np.append(True, np.diff(at) > 1e-9 * corners[-1])]
    return approximate_curve(points_along(ring, at), tolerance=tolerance, closed=contour.closed)


class Workbench:
    """Widgets around `work`: pick or upload a part, set the numbers, look, export.

    To be the last line of a cell; stored, it is the pictures alone.

    Parameters
    ----------
    part : str
        The name in `PARTS` to begin with.
    folder : str or Path
        Where the export button writes; programs are in mm, their chords, arcs and cubics within 0.01 mm.
    """

    def __init__(self, part="the paper's curve", folder="exports"):
        import ipywidgets

        from nurbs_lab.plotting.sliders import Status

        self.folder = Path(folder)
        late = {"continuous_update": False, "layout": {"width": "24em"}}
        late["style"] = {"description_width": "8em"}
        cutters = {"no milling": None, **{f"ball of {d} mm": Cutter("ball", diameter=d) for d in (2.0, 6.0)}}
        # Buttons and sliders: JupyterLab takes the arrow keys away from menus.
        row = {"layout": {"width": "100%"}, "style": {"description_width": "8em", "button_width": "auto"}}
        part = as_choice("part", part, tuple(PARTS))
        self.choice = ipywidgets.ToggleButtons(options=list(PARTS), value=part, description="part", **row)
        self.upload = ipywidgets.FileUpload(accept=",".join(interchange.READABLE), description="your file")
        units = {"as stated, or mm": None, **{unit: unit for unit in ("mm", "cm", "m", "inch")}}
        self.unit = ipywidgets.ToggleButtons(options=units, description="its unit", **row)
        self.stepper = ipywidgets.SelectionSlider(
            options=list(software_steppers()), value="chord-corrected", description="stepper", **late
        )
        self.cutter = ipywidgets.ToggleButtons(options=cutters, description="cutter", **row)
        self.dialect = ipywidgets.ToggleButtons(options=list(DIALECTS), description="dialect", **row)
        self.tolerance, self.scallop, self.speed = (
            ipywidgets.FloatSlider(
                value, min=step, max=most, step=step, description=f"{name} [{unit}]", **late
            )
            for name, unit, value, step, most in (
                ("tolerance", "mm", 0.5, 0.05, 2.0),
                ("scallop", "mm", 0.1, 0.02, 0.5),
                ("speed", "mm/s", 20.0, 1.0, 200.0),
            )
        )
        self.button = ipywidgets.Button(description="export", icon="download")
        self.status = Status()
        columns = "repeat(auto-fill, minmax(380px, 1fr))"
        self.gallery = ipywidgets.GridBox(layout={"grid_template_columns": columns})
        inputs = [self.choice, self.upload, self.unit, self.stepper, self.tolerance, self.speed]
        inputs += [self.scallop, self.cutter]
        panel = ipywidgets.Box([*inputs, self.dialect, self.button], layout={"flex_flow": "wrap"})
        self.widget = ipywidgets.VBox([panel, self.status, self.gallery])
        for control in inputs:
            control.observe(self._changed, "value")
        self.button.on_click(lambda _: self.status.run(self._export))
        self.status.value = self._work()

    def _changed(self, change):
        """Process the part again and show the results; a file takes the place of a part, and the reverse."""
        if change["new"] and change["owner"] in (self.choice, self.upload):
            other, nothing = (self.upload, ()) if change["owner"] is self.choice else (self.choice, None)
            other.unobserve(self._changed, "value")
            other.value = nothing
            other.observe(self._changed, "value")
        self.status.value = "working ..."
        self.status.run(self._work)

    def _work(self):
        import ipywidgets

        name, part = self._chosen()
        names = "tolerance", "speed", "stepper", "cutter", "scallop"
        options = {name: getattr(self, name).value for name in names}
        part = work(part, acceleration=25 * self.speed.value, **options)
        self.name, self.part, self.pictures = name, part, part.pictures()
        self.gallery.children = [
            ipywidgets.VBox([ipywidgets.HTML(f"<b>{caption}</b>"), ipywidgets.Image(value=png, width=380)])
            for caption, png in self.pictures.items()
        ]
        return "<br>".join(part.summary().splitlines())

    def _chosen(self):
        """The name and the content of what is to be shown."""
        if not self.upload.value:
            name = as_choice("part", self.choice.value, tuple(PARTS))
            return name, PARTS[name]()
        file = self.upload.value[0]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, Path(file["name"]).name)
            path.write_bytes(bytes(file["content"]))
            try:
                return path.name, read_part(path, self.unit.value)
            except ValueError as error:  # names a folder that nobody knows
                raise ValueError(str(error).replace(str(path), path.name)) from None

    def _export(self):
        options = {"dialect": self.dialect.value, "tolerance": 0.01, "units": "mm", "axes": "XYZ"}
        files = ", ".join(map(str, self.part.export(self.folder, **options)))
        return html.escape(f"{self.name} is written: {files}")

    def _repr_mimebundle_(self, **options):
        alt = f"{self.name}: {', '.join(self.pictures)}"
        data, told = bundle(sheet(self.pictures, width=520, columns=2), f"Workbench({self.name!r})", alt)
        return self.widget._repr_mimebundle_(**options) | data, told
