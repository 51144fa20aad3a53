"""Trimmed faces on planes, cylinders, cones, spheres and tori, joined to a closed shell by OpenCASCADE.

Vertices and edges are those where regions of the mesh meet, moved onto the surfaces on both sides; where a
region meets free form, they are those of the patches there. What else
a face on a closed surface needs, seams, poles and curves in the parameters, ``ShapeFix`` adds, as for STEP.
"""

from itertools import pairwise

import numpy as np

from nurbs_lab.mesh.solid import opencascade as oc
from nurbs_lab.mesh.solid.faces import ALONG
from nurbs_lab.mesh.solid.net import DEGREE, sides_of
from nurbs_lab.mesh.solid.quadrics import circumcentres
from nurbs_lab.mesh.solid.rims import chains_of, onto
from nurbs_lab.nurbs import NurbsCurve, interpolate_curve

from OCP.BRep import BRep_Builder  # isort: skip  (after the check that it is there)
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.Geom import (
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_Line,
    Geom_Plane,
    Geom_SphericalSurface,
    Geom_ToroidalSurface,
)
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt
from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
from OCP.ShapeFix import ShapeFix_Shape
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED, TopAbs_SHELL
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Vertex
from OCP.TopTools import TopTools_HSequenceOfShape

_PLACES = 8, 400  # on a curve: at first, and at most


def shell_of(points, triangles, label, surfaces, scale, rest=None):
    """The closed shell whose faces are the regions of a mesh; None if OpenCASCADE finds it not valid.

    Parameters
    ----------
    points, triangles
        Of a closed mesh with a size of about one.
    label : (triangles,) array
        Numbers of the regions.
    surfaces : list of Quadric
        That of every region.
    scale : (float, (3,) array)
        Factor and translation to the units of the shell.
    rest : Patches, dict, optional
        Where ``label`` is -1, in the units of the shell, and the regions beside their edges on the rim.
    """
    chains, builder = chains_of(triangles, label), BRep_Builder()
    around, places, vertices, edges = {}, {}, {}, [[] for _ in surfaces]
    faces = []
    if rest:
        faces, corners, corner_places = _patches(builder, *rest, [s.scaled(*scale) for s in surfaces], edges)
        corner_places = (corner_places - scale[1]) / scale[0]
    for regions, along in chains:
        for v in (along[0], along[-1]):
            around.setdefault(v, set()).update(regions)
    for v, regions in around.items():
        if min(regions) < 0:
            nearest = np.linalg.norm(corner_places - points[v], axis=1).argmin()
            places[v], vertices[v] = corner_places[nearest], corners[nearest]
        else:
            places[v] = onto([surfaces[k] for k in sorted(regions)], points[[v]])[0]
            vertices[v] = _vertex(builder, places[v] * scale[0] + scale[1])
    for regions, along in chains:
        if min(regions) < 0:
            continue
        line, first, last = points[along], along[0], along[-1]
        line[0], line[-1] = places[first], places[last]
        geometry, reach, off = _curve_along([surfaces[k] for k in regions], line, first == last, scale)
        edge = _edge(builder, geometry, reach, (vertices[first], vertices[last]), off)
        for region, left in zip(regions, (True, False), strict=True):
            side = TopAbs_FORWARD if left == (surfaces[region].sign > 0.0) else TopAbs_REVERSED
            edges[region].append(edge.Oriented(side))
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    for region, surface in enumerate(surfaces):
        face = _face(builder, _surface_of(surface, scale), edges[region])
        faces.append(face if surface.sign > 0.0 else face.Reversed())
    for face in faces:
        builder.Add(shell, face)
    fix = ShapeFix_Shape(shell)
    fix.Perform()
    shells = list(oc.parts(fix.Shape(), TopAbs_SHELL))
    return shells[0] if len(shells) == 1 and BRepCheck_Analyzer(shells[0]).IsValid() else None


def _patches(builder, patches, rims, surfaces, edges):
    """Faces of patches, vertices at their corners, and the places of these.

    What lies on the rim is added to the ``edges`` of the regions there.
    """
    layout, faces, made = patches.layout, [], {}
    sides = np.stack(sides_of(patches.nets), axis=1)
    numbers, first = np.unique(layout.corners, return_index=True)
    places = sides[:, :, 0].reshape(-1, 3)[first]
    vertices = dict(zip(numbers.tolist(), (_vertex(builder, place) for place in places), strict=True))
    for surface, lines, ends, around in zip(
        patches.surfaces(), sides, layout.corners.tolist(), layout.edges.tolist(), strict=True
    ):
        loop = []
        for k, edge in enumerate(around):
            if edge in made:
                loop.append(made[edge].Oriented(TopAbs_REVERSED))
                continue
            curve, off = NurbsCurve(DEGREE, surface.knots[0], lines[k]), 0.0
            if edge in rims:
                on = surfaces[rims[edge]]
                off = np.abs(on.distances(curve(np.linspace(0.0, 1.0, 4 * ALONG)))).max()
            both = vertices[ends[k]], vertices[ends[(k + 1) % 4]]
            made[edge] = _edge(builder, oc.curve_of(curve), (0.0, 1.0), both, off)
            loop.append(made[edge].Oriented(TopAbs_FORWARD))
            if edge in rims:
                side = TopAbs_REVERSED if on.sign > 0.0 else TopAbs_FORWARD
                edges[rims[edge]].append(made[edge].Oriented(side))
        faces.append(_face(builder, oc.surface_of(surface), loop))
    return faces, list(vertices.values()), places


def _vertex(builder, place):
    vertex = TopoDS_Vertex()
    builder.MakeVertex(vertex, _point(place), 2.0 * oc.CONFUSION)
    return vertex


def _edge(builder, geometry, reach, ends, off):
    """The edge along a curve, which is ``off`` its surfaces, from one vertex to another."""
    edge, tolerance = TopoDS_Edge(), max(oc.CONFUSION, 1.1 * off)
    builder.MakeEdge(edge, geometry, TopLoc_Location(), tolerance)
    for vertex, side in zip(ends, (TopAbs_FORWARD, TopAbs_REVERSED), strict=True):
        builder.Add(edge, vertex.Oriented(side))
        builder.UpdateVertex(vertex, 2.0 * tolerance)
    builder.Range(edge, *map(float, reach))
    return edge


def _face(builder, geometry, edges):
    """The face on a whole surface that edges bound, which lies on the left of each."""
    if not edges:
        return BRepBuilderAPI_MakeFace(geometry, oc.CONFUSION).Face()
    face, given, wires = TopoDS_Face(), TopTools_HSequenceOfShape(), TopTools_HSequenceOfShape()
    builder.MakeFace(face, geometry, oc.CONFUSION)
    for edge in edges:
        given.Append(edge)
    ShapeAnalysis_FreeBounds.ConnectEdgesToWires_s(given, oc.CONFUSION, True, wires)
    for wire in wires:
        builder.Add(face, wire)
    return face


def _curve_along(surfaces, line, closed, scale):
    """The curve on two surfaces along a polyline whose ends lie on it: geometry, range and error in units."""
    size, centre = scale
    count = max(1, -(-_PLACES[0] // (len(line) - 1)))
    t = np.arange(count)[:, None] / count
    at = np.concatenate([*(a * (1 - t) + b * t for a, b in pairwise(line)), line[-1:]])
    at[1:-1] = onto(surfaces, at[1:-1])
    along = at[-1] - at[0]
    length = np.linalg.norm(along)
    off = np.inf if closed else np.linalg.norm(np.cross(at - at[0], along / length), axis=1).max()
    if off < oc.CONFUSION:
        line = Geom_Line(_point(at[0] * size + centre), _direction(along))
        return line, (0.0, length * size), max(off, _off(surfaces, at)) * size
    middle, axis = circumcentres(at[[0, len(at) // 3, 2 * len(at) // 3] if closed else [0, len(at) // 2, -1]])
    x = at[0] - middle
    rho = np.linalg.norm(at - middle, axis=1)
    off = max(np.abs((at - middle) @ axis).max(), np.ptp(rho))
    if off < oc.CONFUSION:
        angle = np.arctan2(along @ np.cross(axis, x) / rho[0], (at[-1] - middle) @ x / rho[0])
        frame = gp_Ax2(_point(middle * size + centre), _direction(axis), _direction(x))
        reach = 2 * np.pi if closed else float(angle % (2 * np.pi))
        return Geom_Circle(frame, float(rho[0] * size)), (0.0, reach), max(off, _off(surfaces, at)) * size
    return _spline_along(surfaces, at, closed, scale)


def _spline_along(surfaces, at, closed, scale):
    while True:
        spline = interpolate_curve(at[:-1] if closed else at, 3, closed=closed)
        off = _off(surfaces, spline(np.linspace(*spline.domain, 4 * len(at) + 1)))
        if off < oc.CONFUSION or len(at) > _PLACES[1]:
            break
        finer = np.empty((2 * len(at) - 1, 3))
        finer[::2], finer[1::2] = at, onto(surfaces, (at[1:] + at[:-1]) / 2)
        at = finer
    spline = spline.clamped()
    moved = type(spline)(spline.degree, spline.knots, spline.control_points * scale[0] + scale[1])
    return oc.curve_of(moved), spline.domain, off * scale[0]


def _off(surfaces, points):
    """Largest distance of points from surfaces."""
    return max(float(np.abs(s.distances(points)).max()) for s in surfaces)


def _surface_of(surface, scale):
    """The geometry of a whole surface."""
    placed = surface.scaled(*scale)
    frame = gp_Ax3(_point(placed.point), _direction(placed.axis))
    if surface.kind == "plane":
        return Geom_Plane(frame)
    if surface.kind == "cone":
        return Geom_ConicalSurface(frame, placed.other, 0.0)
    if surface.kind == "torus":
        return Geom_ToroidalSurface(frame, placed.other, placed.radius)
    kind = {"cylinder": Geom_CylindricalSurface, "sphere": Geom_SphericalSurface}[surface.kind]
    return kind(frame, placed.radius)


def _point(place):
    return gp_Pnt(*map(float, place))


def _direction(vector):
    return gp_Dir(*map(float, vector))
