"""Point clouds, meshes, layers and surfaces in space; Fig. 7 and the deviation map."""

import numpy as np
import pyvista as pv

from nurbs_lab.mesh import Deviation, TrimmedShell
from nurbs_lab.mesh.read import arrays_of
from nurbs_lab.mesh.solid.faces import KINDS, kinds_of_faces
from nurbs_lab.nurbs.spans import find_breaks, span_parameters
from nurbs_lab.plotting.picture import FONT
from nurbs_lab.plotting.stage import CLAY, INK, frame, lay, lift, name_points, scene, takes_stage
from nurbs_lab.plotting.style import BLUE, COLOURS, DISTANCE, GREEN, GREY, MAGNITUDE, RED, SIGNED

MATERIAL = {"ambient": 0.12, "diffuse": 0.9, "specular": 0.25, "specular_power": 30}
# Normals are blended over edges that turn by less, in degrees.
_SMOOTH = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": 40.0}
_LINES = 4  # of a kind in a legend
RIM = "#33415c"  # of lines on surfaces
SAMPLES, LEAST = 6, 16  # of a surface: along each span, and in all


@takes_stage
def cloud(points, *, stage=None, title=None):
    """A point cloud, coloured by height.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    """
    points = np.asarray(points, float)
    size = 4.0 if len(points) < 10_000 else 2.0
    stage.add_points(
        points, scalars=points[:, 2], cmap=MAGNITUDE, point_size=size,
        render_points_as_spheres=False, show_scalar_bar=False,
    )  # fmt: skip
    return frame(stage, title=title)


@takes_stage
def mesh(mesh, *, edges=True, stage=None, title=None):
    """A triangle mesh.

    Parameters
    ----------
    mesh : trimesh.Trimesh or pyvista.PolyData
    edges : bool
        Draw the edges of the triangles.
    """
    mesh = triangles(mesh)
    stage.add_mesh(
        mesh, color=CLAY, show_edges=edges, edge_color="#5a6475", edge_opacity=0.35,
        line_width=0.5, **MATERIAL, **({} if edges else _SMOOTH),
    )  # fmt: skip
    return frame(stage, title=title)


@takes_stage
def layers(layers, *, mesh=None, stage=None, title=None):
    """Ordered contours where they lie in space, outlines blue and holes red.

    Parameters
    ----------
    layers : sequence of Layer
    mesh : trimesh.Trimesh, optional
        The body that they lie on; it hides those at its back.
    """
    if mesh is not None:
        stage.add_mesh(triangles(mesh), color=CLAY, **_SMOOTH, **MATERIAL)
    for hole, colour in ((False, BLUE), (True, RED)):
        lines = [c.ring_3d for layer in layers for c in layer.contours if c.is_hole == hole]
        if lines:
            lay(stage, lines, color=colour, line_width=2)
    return frame(stage, title=title)


@takes_stage
def surface(surfaces, *, isocurves=True, color=CLAY, stage=None, title=None):
    """NURBS surfaces, with their curves of constant parameter at the knots.

    Exact faces of a reconstruction are drawn as they are trimmed, with the curves around them.

    Parameters
    ----------
    surfaces : NurbsSurface, sequence of them, or Reconstruction
    isocurves : bool
        Draw the curves u = knot and v = knot.
    color : str
    """
    trimmed = any(isinstance(shell, TrimmedShell) for shell in getattr(surfaces, "shells", ()))
    if trimmed:
        return _trimmed(surfaces, stage, lambda kind: color, isocurves, title)
    surfaces = surfaces_of(surfaces)
    stage.add_mesh(quilt(*surfaces), color=color, interpolation="Phong", **MATERIAL)
    if isocurves:
        lines = [line for one in surfaces for line in _isocurves(one)]
        lay(stage, lines, color=RIM, line_width=0.7, opacity=0.8)
    return frame(stage, title=title)


@takes_stage
def faces(solid, *, stage=None, title=None):
    """The faces of a solid, coloured by kind, with the curves around them and a legend of their numbers.

    Parameters
    ----------
    solid : Reconstruction
    """
    colours, legend = dict(zip(KINDS, (*COLOURS[: len(KINDS) - 1], GREY), strict=True)), []
    for kind in KINDS:
        if some := [face for face in solid.faces if face.kind == kind]:
            legend += [[line, colours[kind]] for line in kinds_of_faces(some).split(", ")[:_LINES]]
    across, down = stage.shape[::-1] / np.array(stage.window_size)  # of a panel, for one pixel
    for k, (line, colour) in enumerate(legend):
        for text, x, ink in (("■", 0.02, colour), (line, 0.02 + 19.0 * across, INK)):
            place = (x, 0.88 - 20.0 * down * k)
            stage.add_text(text, position=place, viewport=True, font_size=10, color=ink, font_file=FONT)
    return _trimmed(solid, stage, colours.get, True, title, left=0.2)  # for the names


def _trimmed(solid, stage, colour, rims, title, left=0.0):
    """Triangles of all faces in the colours of their kinds, and the curves around them."""
    for shell in solid.shells:
        mesh = shell.to_mesh(max(solid.tolerance / 4, shell.finest))
        number = mesh.face_attributes.get("face", np.zeros(len(mesh.faces), int))  # or all are patches
        at = np.array([face.kind for face in shell.faces])[number]
        for kind in np.unique(at):
            part = pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces[at == kind])
            stage.add_mesh(part, color=colour(str(kind)), **_SMOOTH, **MATERIAL | {"ambient": 0.4})
    if rims:
        curves = [curve for face in solid.faces for loop in face.loops for curve in loop]
        lines = [c(np.linspace(*c.domain, 4 * len(c.control_points) + 1)) for c in curves]
        if lines:
            lay(stage, lines, color=INK, line_width=2.5)
    return frame(stage, title=title, left=left)


_mesh, _layers = mesh, layers  # whose names the arguments of the next functions take


@takes_stage
def deviation(mesh, values, *, tolerance=None, stage=None, title=None):
    """Where a reconstruction departs from its mesh, with a colour bar in mm.

    The colours are those of the bar exactly, because no light falls on the body. Lines show its shape.

    Parameters
    ----------
    mesh : trimesh.Trimesh or pyvista.PolyData
    values : Deviation, or array_like of shape (vertices,)
        Distances in mm. All positive ones are drawn in one sequence of colours; signed ones in two that meet
        at zero. With a `Deviation` that exceeds the tolerance, the worst place is marked.
    tolerance : float, optional
        In mm: the end of the colour bar, so that pictures can be compared; what lies above is red, and what
        lies below green.
    """
    mesh = triangles(mesh)
    measured, values = (values, values.vertices) if isinstance(values, Deviation) else (None, values)
    values = np.asarray(values, float)
    reach = tolerance or float(np.abs(values).max()) or 1.0
    signed = values.min() < 0
    stage.add_mesh(
        mesh, scalars=values, clim=(-reach if signed else 0.0, reach), cmap=SIGNED if signed else DISTANCE,
        above_color=RED if values.max() > reach else None, lighting=False, show_scalar_bar=False, **_SMOOTH,
        below_color=GREEN if values.min() < -reach else None,
    )  # fmt: skip
    rim = stage.add_silhouette(mesh, color=RIM, line_width=2.0, feature_angle=_SMOOTH["feature_angle"])
    rim.use_bounds = False  # so it is not stored with scenes that turn: it belongs to one camera
    rim.mapper.GetInputAlgorithm().SetDirectionToCameraVector()  # the projection is parallel
    lift(rim)
    bar = stage.add_scalar_bar(
        title="deviation [mm]", vertical=True, position_x=0.86, position_y=0.15, height=0.7, width=0.06,
        n_labels=5 if signed else 6, fmt="%.3g", color=INK, title_font_size=14, label_font_size=13,
    )  # fmt: skip
    for letters in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty(), bar.GetAnnotationTextProperty()):
        letters.SetFontFamilyAsString("File")
        letters.SetFontFile(FONT)
    if measured and tolerance and measured.max > tolerance:
        place = measured.worst_place[None]
        stage.add_points(place, color=INK, point_size=12, render_points_as_spheres=True)
        name_points(stage, place, [f"{measured.max:.3g} mm"], INK)
    return frame(stage, title=title, right=0.2)  # for the colour bar


def figure_7(points, mesh, layers, surfaces, *, width=1200, height=330):
    """The paper's Fig. 7 from any data: cloud, triangles, contours, surface.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    mesh : trimesh.Trimesh
    layers : sequence of Layer
    surfaces : NurbsSurface, sequence of them, or Reconstruction
    width, height : int

    Returns
    -------
    pyvista.Plotter
    """
    stage = scene(columns=4, width=width, height=height)
    cloud(points, stage=stage, title="point cloud")
    stage.subplot(0, 1)
    _mesh(mesh, stage=stage, title="triangles")
    stage.subplot(0, 2)
    _layers(layers, stage=stage, title="contours")
    stage.subplot(0, 3)
    surface(surfaces, stage=stage, title="surfaces")
    return stage


def surfaces_of(item):
    """The surfaces of a reconstruction, a list, or one surface."""
    item = getattr(item, "surfaces", item)
    return item if isinstance(item, (list, tuple)) else [item]


def quilt(*surfaces):
    """Surfaces as a PyVista mesh of quadrilaterals, shaded by the normals of the surfaces themselves."""
    first, *others = map(_quilted, surfaces)
    whole = first.append_polydata(*others) if others else first
    whole.point_data.active_normals_name = "normals"
    return whole


def _quilted(surface):
    u, v = _places(surface)
    points = [column.reshape(len(u), len(v), 1) for column in surface.grid(u, v).reshape(-1, 3).T]
    sheet = pv.StructuredGrid(*points)
    sheet["normals"] = surface.normal(u[:, None], v).swapaxes(0, 1).reshape(-1, 3)
    return sheet.extract_surface(algorithm="dataset_surface")


def _places(surface):
    """Parameters of a picture in both directions."""
    for knots, degree in zip(surface.knots, surface.degrees, strict=True):
        spans = len(find_breaks(knots, degree)) - 1
        yield span_parameters(knots, degree, max(SAMPLES, -(-LEAST // spans)))


def _isocurves(surface):
    u, v = map(find_breaks, surface.knots, surface.degrees)
    fine_u, fine_v = _places(surface)
    return [*surface.grid(u, fine_v), *surface.grid(fine_u, v).swapaxes(0, 1)]


def triangles(mesh):
    """A mesh as PyVista's, without the metadata that it cannot hold."""
    return mesh if isinstance(mesh, pv.PolyData) else pv.PolyData.from_regular_faces(*arrays_of(mesh))
