"""Scenes stored in a notebook, which a reader of the book (`make book`) can turn without a kernel."""

import base64
import zlib

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkActor2D
from vtkmodules.vtkRenderingLabel import vtkLabelPlacementMapper

#: The type under which a notebook stores a scene beside its picture; JupyterLab shows the picture.
MIME = "application/x-nurbs-lab-scene.2+json"
MOST_TRIANGLES = 8_000  # of a scene; larger meshes are thinned
MOST_POINTS = 4_000  # of a cloud; larger ones are thinned
MOST_BYTES = 160_000  # of the stored text; heavier scenes stay pictures
LEVELS = 16_000  # steps of a coordinate along the longest side of the scene; their differences fit 16 bits


def packed(stage):
    """The views of a scene as plain data: quantised points, triangles, lines and colours.

    Parameters
    ----------
    stage : pyvista.Plotter
        Not yet closed.

    Returns
    -------
    dict or None
        One entry of ``views`` for every view, left to right: its title, the direction towards the camera,
        the height of the picture in scene units, its parts, and the names beside points. Each part holds
        compressed arrays in base64.
        None if the scene has nothing to turn or is too heavy to be stored.
    """
    shown = [[one for one in view.actors.values() if isinstance(one, pv.Actor)] for view in stage.renderers]
    actors = [[one for one in view if one.use_bounds] for view in shown]  # no outlines
    bodies = sum(_coloured(one).n_faces > 0 for view in actors for one in view)
    most = MOST_TRIANGLES / max(bodies, 1)
    views = [_view(view, parts, most) for view, parts in zip(stage.renderers, actors, strict=True)]
    size = sum(len(text) for view in views for part in view["parts"] for text in part["arrays"].values())
    return {"views": views} if 0 < size <= MOST_BYTES else None


def _view(renderer, actors, most):
    low, high = np.reshape(renderer.bounds, (3, 2)).T
    centre, longest = (low + high) / 2, np.max(high - low)
    camera = renderer.camera
    towards = np.subtract(camera.position, camera.focal_point)
    return {
        "title": " ".join(one.input for one in renderer.actors.values() if isinstance(one, pv.Text)),
        "towards": _rounded(towards / np.linalg.norm(towards)),
        "height": _rounded(2 * camera.parallel_scale / longest),
        "parts": [_part(one, centre, longest, most) for one in actors if one.mapper.dataset.n_points],
        "names": [name for one in renderer.actors.values() for name in _names(one, centre, longest)],
    }


def _names(actor, centre, longest):
    """The texts that an actor writes beside points, with their colour and their places."""
    mapper = actor.GetMapper() if isinstance(actor, vtkActor2D) else None
    if not isinstance(mapper, vtkLabelPlacementMapper):
        return []
    hierarchy = mapper.GetInputConnection(0, 0).GetProducer()
    points, words = hierarchy.GetInput(), hierarchy.GetInput().GetPointData().GetAbstractArray("labels")
    colour = _rounded(hierarchy.GetTextProperty().GetColor())
    places = (vtk_to_numpy(points.GetPoints().GetData()) - centre) / longest
    return [
        {"text": words.GetValue(k), "colour": colour, "at": _rounded(place)} for k, place in enumerate(places)
    ]


def _part(actor, centre, longest, most):
    """The triangles of an actor, at most so many, or its lines or points."""
    data = _coloured(actor)
    if actor.prop.style == "Points" or data.n_cells == data.n_verts:
        kind, cells = "points", None
        data = data.extract_points(
            range(0, data.n_points, -(-data.n_points // MOST_POINTS)), include_cells=False
        )
    elif not data.n_faces:
        kind, cells = "lines", _segments(data)
    else:
        if data.n_faces > most:  # patches with common edges become one body first, or gaps would open
            body = data.clean()
            body.lines = body.verts = np.empty(0, int)  # triangles without area
            data = body.decimate(1 - most / body.n_faces)
            nearest = cKDTree(body.points).query(data.points)[1]
            data.point_data.update({name: values[nearest] for name, values in body.point_data.items()})
        kind, cells = "triangles", data.faces.reshape(-1, 4)[:, 1:]
    arrays = {"points": _text_of(np.rint((data.points - centre) * (LEVELS / longest)).astype("<i2"))}
    if cells is not None:
        arrays["cells"] = _text_of(cells.astype("<i4"))
    if "colours" in data.point_data:
        arrays["colours"] = _text_of(data.point_data["colours"])
    return {
        "kind": kind,
        "colour": _rounded(actor.prop.color.float_rgb),
        "opacity": _rounded(actor.prop.opacity),
        "size": _rounded(actor.prop.point_size),
        "smooth": actor.prop.interpolation.name != "FLAT",
        "arrays": arrays,
    }


def _coloured(actor):
    """The triangles, lines or points of an actor, with the colours that its scalars have on the screen."""
    mapper, data = actor.mapper, actor.mapper.dataset
    data = (data if isinstance(data, pv.PolyData) else data.extract_surface()).copy(deep=False)
    scalars = data.GetPointData().GetArray(mapper.GetArrayName()) if mapper.scalar_visibility else None
    data.clear_data()
    if scalars:
        mapped = mapper.GetLookupTable().MapScalars(scalars, mapper.GetColorMode(), -1)
        data.point_data["colours"] = vtk_to_numpy(mapped)[:, :3].copy()
    return data.triangulate() if data.n_faces else data


def _segments(data):
    """Pairs of points: the lines of a data set."""
    points, ends = map(
        vtk_to_numpy, (data.GetLines().GetConnectivityArray(), data.GetLines().GetOffsetsArray())
    )
    return np.delete(np.column_stack([points[:-1], points[1:]]), ends[1:-1] - 1, axis=0)


def _text_of(array):
    """The differences of neighbouring rows, column after column: neighbours are alike, so that packs well."""
    differences = np.diff(array, axis=0, prepend=np.zeros_like(array[:1]))
    return base64.b64encode(zlib.compress(differences.tobytes("F"), 9)).decode()


def _rounded(values):
    return np.round(values, 6).tolist()
