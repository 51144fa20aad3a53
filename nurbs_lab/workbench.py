"""Your own part, all the way: read, rebuild, plan a feed, step along it, export; by call or by widgets."""

from __future__ import annotations

import base64
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

from nurbs_lab import interchange, paper, plotting
from nurbs_lab.common.checks import as_file
from nurbs_lab.mesh import Reconstruction, reconstruct, samples
from nurbs_lab.mesh.mesh_input import arrays_of
from nurbs_lab.motion import ToolPath, plan_feed, software_steppers, trace
from nurbs_lab.motion.curves import benchmark_curves
from nurbs_lab.nurbs import NurbsCurve, interpolate_curve
from nurbs_lab.plotting import scene
from nurbs_lab.plotting.picture import png_of, sheet

MESHES = {".stl", ".ply", ".obj"}
CURVES_IN = {".json", ".step", ".stp", ".igs", ".iges", ".3dm"}
POINTS = {".csv", ".txt"}

#: Parts that every installation has, by the name that a person picks.
PARTS = {
    "the paper's curve": lambda: paper.CURVE,
    "butterfly": lambda: benchmark_curves()["butterfly"].curve,
    "frog: white of the eye": lambda: samples.frog_organ("eye_white"),
    "frog: spleen": lambda: samples.frog_organ("spleen"),
    "nut": samples.nut,
    "ant": samples.ant,
}


@dataclass(frozen=True, eq=False)
class Part:
    """A part and what was made of it.

    Attributes
    ----------
    curve : NurbsCurve
        What the tool follows: the given curve, or the middle section of the largest tube.
    path : ToolPath
        The motion along it.
    reconstruction : Reconstruction or None
        The surfaces, if the part came as a mesh.
    """

    curve: NurbsCurve
    path: ToolPath
    reconstruction: Reconstruction | None = None

    def export(self, folder) -> list[Path]:
        """Write ``part.step``, ``path.csv`` and ``path.ngc`` into a folder, which is made if need be."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        shape = self.curve if self.reconstruction is None else self.reconstruction
        return [
            interchange.export(folder / "part.step", shape),
            interchange.export(folder / "path.csv", self.path),
            interchange.export(folder / "path.ngc", self.path),
        ]

    def pictures(self) -> dict[str, bytes]:
        """PNG pictures by caption."""
        found = {}
        made = self.reconstruction
        if made is not None:
            spread = made.deviation()
            found["contours"] = scene.png(plotting.layers(made.layers, mesh=made.mesh))
            found["surface"] = scene.png(plotting.surface(made))
            found["deviation"] = scene.png(
                plotting.deviation(made.mesh, spread.vertices, tolerance=made.tolerance)
            )
        found["tool path"] = png_of(plotting.path(self.path))
        found["feed"] = png_of(plotting.feed(self.path.feed))
        found["feed fluctuation"] = png_of(plotting.fluctuation([self.path]))
        return found

    def summary(self) -> str:
        """The figures that matter, a line each."""
        lines = []
        if self.reconstruction is not None:
            made = self.reconstruction
            verdict = "kept" if made.within_tolerance else "missed"
            lines.append(
                f"{len(made.surfaces)} surfaces through {len(made.layers)} layers; largest deviation "
                f"{made.deviation().max:.3f} mm, tolerance {made.tolerance:g} mm {verdict}"
            )
        worst = 100 * np.abs(self.path.chord_fluctuation).max()
        lines.append(f"path of {self.curve.length():.2f} mm in {self.path.t[-1]:.3f} s")
        lines.append(f"{self.path.stepper}: largest feed fluctuation {worst:.1e} %, by chord")
        return "\n".join(lines)


def read_part(path):
    """A mesh, a curve, or a curve through points, by the suffix of the file.

    Parameters
    ----------
    path : str or Path
        ``.stl .ply .obj``: mesh; ``.json .step .igs .3dm``: its first curve; ``.csv .txt``: rows of points.

    Returns
    -------
    trimesh.Trimesh or NurbsCurve

    Raises
    ------
    ValueError
        If the suffix is unknown, or the file holds no curve.
    """
    path = as_file("path", path)
    suffix = path.suffix.lower()
    if suffix in MESHES:
        return trimesh.Trimesh(*arrays_of(path))
    if suffix in CURVES_IN:
        curves = [item for item in interchange.read(path) if isinstance(item, NurbsCurve)]
        if not curves:
            raise ValueError(f"{path.name} holds no curve; save one as a NURBS curve, or give a mesh")
        return curves[0]
    if suffix in POINTS:
        return interpolate_curve(_rows_of(path, "," if suffix == ".csv" else None))
    known = " ".join(sorted(MESHES | CURVES_IN | POINTS))
    raise ValueError(f"{path.name}: a part ends in one of {known}")


def _rows_of(path, delimiter):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # of a file without any row
            return np.loadtxt(path, delimiter=delimiter, ndmin=2, encoding="utf-8-sig")
    except OSError:
        raise
    except Exception as error:  # whatever a damaged file makes its reader say
        raise ValueError(f"{path.name} holds no rows of points: {error}") from error


def work(
    part,
    *,
    layers=20,
    tolerance=0.5,
    speed=20.0,
    acceleration=500.0,
    chord_error=1e-3,
    period_s=1e-3,
    stepper="chord-corrected",
) -> Part:
    """All the way, with one call.

    Parameters
    ----------
    part : trimesh.Trimesh, NurbsCurve, or file name
    layers : int
        Planes to begin with; more are put in where the tolerance asks for them. For meshes only.
    tolerance : float
        Largest deviation of the surfaces in mm. For meshes only.
    speed, acceleration, chord_error, period_s
        Limits of the motion, see `plan_feed`; mm and s.
    stepper : str
        One of `STEPPERS`.

    Returns
    -------
    Part
    """
    if isinstance(part, (str, Path)):
        part = read_part(part)
    made = None if isinstance(part, NurbsCurve) else reconstruct(part, layers=layers, tolerance=tolerance)
    curve = part if made is None else _middle_section(made)
    feed = plan_feed(
        curve, speed=speed, acceleration=acceleration, chord_error=chord_error, period_s=period_s
    )
    return Part(curve, trace(curve, feed, stepper=stepper), made)


def _middle_section(made):
    longest = max(made.tubes, key=lambda tube: len(tube.curves))
    return longest.curves[len(longest.curves) // 2]


class Workbench:
    """Widgets around `work`: pick or upload a part, set the numbers, look, export.

    To be the last line of a cell; stored, it is the pictures alone.

    Parameters
    ----------
    part : str
        The name in `PARTS` to begin with.
    folder : str or Path
        Where the export button writes.
    """

    def __init__(self, part="the paper's curve", folder="exports"):
        import ipywidgets

        self.folder = Path(folder)
        self.part = None
        late = {
            "continuous_update": False,
            "style": {"description_width": "8em"},
            "layout": {"width": "24em"},
        }
        suffixes = ",".join(sorted(MESHES | CURVES_IN | POINTS))
        steppers = software_steppers()
        self.choice = ipywidgets.Dropdown(options=list(PARTS), value=part, description="part")
        self.upload = ipywidgets.FileUpload(accept=suffixes, description="your file")
        self.stepper = ipywidgets.Dropdown(options=steppers, value="chord-corrected", description="stepper")
        self.layers = ipywidgets.IntSlider(20, 5, 80, description="layers", **late)
        self.tolerance = ipywidgets.FloatSlider(0.5, min=0.05, max=2, step=0.05, **late)
        self.tolerance.description = "tolerance [mm]"
        self.speed = ipywidgets.FloatSlider(20, min=1, max=200, step=1, description="speed [mm/s]", **late)
        self.button = ipywidgets.Button(description="export", icon="download")
        self.status = ipywidgets.HTML()
        columns = "repeat(auto-fill, minmax(380px, 1fr))"
        self.gallery = ipywidgets.GridBox(layout={"grid_template_columns": columns})
        inputs = [self.choice, self.upload, self.stepper, self.layers, self.tolerance, self.speed]
        panel = ipywidgets.Box([*inputs, self.button], layout={"flex_flow": "wrap"})
        self.widget = ipywidgets.VBox([panel, self.status, self.gallery])
        for control in inputs:
            control.observe(self._changed, "value")
        self.button.on_click(self._export)
        self._changed(None)

    def _changed(self, change):
        """Work the part anew and show what came of it; a refusal is shown, nothing is lost."""
        import ipywidgets

        if change is not None and change["owner"] is self.choice:
            self.upload.unobserve_all("value")
            self.upload.value = ()
            self.upload.observe(self._changed, "value")
        self.status.value = "working ..."
        try:
            self.part = work(
                self._chosen(),
                layers=self.layers.value,
                tolerance=self.tolerance.value,
                speed=self.speed.value,
                acceleration=25 * self.speed.value,
                stepper=self.stepper.value,
            )
        except (ValueError, TypeError, OSError) as problem:
            self.status.value = f"<b>{problem}</b>"
            return
        self.pictures = self.part.pictures()
        self.gallery.children = [
            ipywidgets.VBox([ipywidgets.HTML(f"<b>{caption}</b>"), ipywidgets.Image(value=png, width=380)])
            for caption, png in self.pictures.items()
        ]
        self.status.value = "<br>".join(self.part.summary().splitlines())

    def _chosen(self):
        if not self.upload.value:
            return PARTS[self.choice.value]()
        file = self.upload.value[0]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / Path(file["name"]).name
            path.write_bytes(bytes(file["content"]))
            return read_part(path)

    def _export(self, _):
        files = self.part.export(self.folder)
        self.status.value = "written: " + ", ".join(str(file) for file in files)

    def _repr_mimebundle_(self, **options):
        bundle = self.widget._repr_mimebundle_(**options)
        bundle["text/plain"] = f"Workbench({self.choice.value!r})"
        bundle["image/png"] = base64.b64encode(sheet(self.pictures.values())).decode()
        alt = f"{self.choice.value}: {', '.join(self.pictures)}"
        return bundle, {"image/png": {"alt": alt}}
