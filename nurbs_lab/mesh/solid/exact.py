"""Trimmed faces on planes, cylinders, cones, spheres and tori, joined to a closed shell by OpenCASCADE.

A face that goes all the way around its surface needs a seam: it is cut along a line of constant parameter,
which joins its two loops, or its loop and the pole of a sphere or the apex of a cone.
"""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.mesh.solid import opencascade as oc
from nurbs_lab.mesh.solid.quadrics import Quadric, across
from nurbs_lab.mesh.solid.rims import Curve, Rims

from OCP.BRep import BRep_Builder  # isort: skip  (after the check that it is there)
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepLib import BRepLib
from OCP.Geom import (
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_Line,
    Geom_Plane,
    Geom_SphericalSurface,
    Geom_ToroidalSurface,
)
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.ShapeFix import ShapeFix_Face
from OCP.Standard import Standard_Failure
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Vertex, TopoDS_Wire

__all__ = ["Builder", "Standard_Failure", "is_valid", "oc", "sheets_of"]
_LEAST = 1e-7  # mm: tolerance of vertices, edges and faces
_TURN = 2 * np.pi
_TRIES = 24  # directions of a seam


@dataclass
class _Sheet:
    """How a face lies on its surface: the frame of the surface, and the loops that go around it.

    ``way`` is 0 if they go along u, 1 if along v; ``around`` holds none of them for a face without a seam.
    ``whole`` says that the face is all of its surface, but for holes. The seam is at u = 0, or v = ``turn``.
    """

    axis: np.ndarray
    x: np.ndarray
    around: list[int]
    way: int = 0
    whole: bool = False
    turn: float = 0.0


def uv_of(surface: Quadric, axis, x, points):
    """Parameters of points as OpenCASCADE has them, angles within half a turn; lengths of the part."""
    at = points - surface.point
    y, height = np.cross(axis, x), at @ axis
    u = np.arctan2(at @ y, at @ x)
    rho = np.hypot(at @ x, at @ y)
    if surface.kind == "sphere":
        return u, np.arctan2(height, rho)
    if surface.kind == "torus":
        return u, np.arctan2(height, rho - surface.other)
    return u, height / np.cos(surface.other) if surface.kind == "cone" else height


def _winding(angles):
    steps = np.diff(angles, append=angles[0])
    return round(float((steps - _TURN * np.round(steps / _TURN)).sum() / _TURN))


def sheets_of(rims: Rims, surfaces, signs, inside):
    """A sheet for every region; where it needs a seam, its loops are made to begin there."""
    return [_sheet(rims, region, surfaces, signs[region], inside[region]) for region in range(len(surfaces))]


def _sheet(rims, region, surfaces, sign, inside):
    surface = surfaces[region]
    loops = [rims.polyline(loop) for loop in rims.loops[region]]
    if surface.kind == "plane":
        return _Sheet(surface.axis, across(surface.axis)[0], [])
    axis = surface.axis
    if surface.kind == "sphere":
        axis = _pole(surface, loops, inside)
    e = across(axis if axis[np.abs(axis).argmax()] > 0.0 else -axis)[0]
    for way in (0, 1)[: 1 + (surface.kind == "torus")]:
        angles = [uv_of(surface, axis, e, loop)[way] for loop in loops]
        windings = [_winding(a) for a in angles]
        around = [k for k, w in enumerate(windings) if w]
        if around:
            break
    if not around:
        x = _gap(inside - surface.point, axis)
        return _Sheet(axis, x, [], whole=_is_whole(surface, axis, x, loops, sign))
    around.sort(key=lambda k: -windings[k] * sign)
    if way == 1:
        around.reverse()
    turns = np.array([0.0, np.pi]) if way else _TURN * np.arange(_TRIES) / _TRIES
    ends = {rims.chains[n].first for k in around for n, _ in rims.loops[region][k]} & rims.fixed
    ends = np.array([uv_of(surface, axis, e, rims.places[n][None])[way][0] for n in sorted(ends)])
    turn = _seam(angles, around, turns if way else np.append(ends, turns))
    _start(rims, region, surfaces, (axis, e, way, turn), around, angles)
    if way == 0:
        e = np.cos(turn) * e + np.sin(turn) * np.cross(axis, e)
    return _Sheet(axis, e, around, way, turn=turn if way else 0.0)


def _is_whole(surface, axis, x, loops, sign):
    """Whether the loops are holes in the whole surface, by the area that they enclose."""
    if surface.kind not in ("sphere", "torus"):
        return False
    area = 0.0
    for loop in loops:
        u, v = (np.unwrap(a) for a in uv_of(surface, axis, x, loop))
        v = np.sin(v) if surface.kind == "sphere" else v
        area += 0.5 * float(u @ np.roll(v, -1) - v @ np.roll(u, -1))
    return area * sign <= 0.0


def _seam(angles, around, turns):
    """An angle which the loops around cross once, and others not, the first of many that is far from them."""
    holes = [a for k, a in enumerate(angles) if k not in around]
    best, far = 0.0, -1.0
    for turn in turns:
        crossings = [len(_crossings(angles[k], turn)) for k in around]
        if max(crossings) > 1 or any(len(_crossings(a, turn)) for a in holes):
            continue
        gaps = [np.abs(_within(a - turn)).min() for a in holes]
        distance = min(gaps, default=np.inf)
        if distance > 0.1:
            return float(turn)
        if distance > far:
            best, far = float(turn), distance
    return best


def _within(angles):
    return angles - _TURN * np.round(angles / _TURN)


def _crossings(angles, turn):
    """Places of a closed polyline after which it crosses an angle."""
    at = _within(angles - turn)
    beside = np.roll(at, -1)
    return np.flatnonzero((np.abs(beside - at) < np.pi) & ((at <= 0.0) != (beside <= 0.0)))


def _start(rims, region, surfaces, seam, around, angles):
    """Let the loops around begin on the seam."""
    axis, e, way, turn = seam
    surface = surfaces[region]
    normal = axis if way else np.cos(turn) * np.cross(axis, e) - np.sin(turn) * e
    plane = Quadric("plane", surface.point, normal)
    for k in around:
        after = int(_crossings(angles[k], turn)[0])
        loop = rims.polyline(rims.loops[region][k])
        a, b = loop[after], loop[(after + 1) % len(loop)]
        low, high = (float(_within(angles[k][i % len(loop)] - turn)) for i in (after, after + 1))
        point = a + (b - a) * (low / (low - high))
        rims.start_at(region, k, after, point, lambda pair: [*(surfaces[r] for r in pair), plane])


def _pole(surface, loops, inside):
    """Axis of a sphere: beside a small face, else through its loops."""
    at = inside - surface.point
    middle = at.mean(axis=0)
    size = np.linalg.norm(middle)
    if not loops:
        return np.array([0.0, 0.0, 1.0])
    if size > 0.0 and (at @ middle).min() > 0.1 * size * surface.radius:
        return across(middle / size)[0]
    centres = [loop.mean(axis=0) - surface.point for loop in loops]
    way = centres[0] - centres[1] if len(loops) == 2 else centres[0]
    if np.linalg.norm(way) < 1e-6:
        way = np.linalg.svd(loops[0] - loops[0].mean(axis=0), full_matrices=False)[2][2]
    return way / np.linalg.norm(way)


def _gap(at, axis):
    """Direction across an axis in the middle of the widest gap between points around it."""
    e, f = across(axis)
    turns = np.sort(np.arctan2(at @ f, at @ e))
    gaps = np.diff(turns, append=turns[0] + _TURN)
    turn = turns[gaps.argmax()] + gaps.max() / 2
    return np.cos(turn) * e + np.sin(turn) * f


class Builder:
    """Vertices, edges and faces of one shell, in mm."""

    def __init__(self, rims: Rims, curves: list[Curve], surfaces: list[Quadric], sheets, signs):
        self.rims, self.surfaces, self.sheets, self.signs = rims, surfaces, sheets, signs
        self.builder, self.vertices, self.curves = BRep_Builder(), {}, curves
        for chain, curve in zip(rims.chains, curves, strict=True):
            for number, place in ((chain.first, curve.start), (chain.last, curve.end)):
                if number not in self.vertices:
                    self.vertices[number] = self._vertex(place)
        self.edges = [
            self._edge(*_geometry_of(curve), [self.vertices[n] for n in (chain.first, chain.last)], curve.off)
            for chain, curve in zip(rims.chains, curves, strict=True)
        ]

    def shell(self):
        """The closed shell of all faces."""
        shell = TopoDS_Shell()
        self.builder.MakeShell(shell)
        for region in range(len(self.surfaces)):
            self.builder.Add(shell, self._face(region))
        BRepLib.SameParameter_s(shell, 1e-7, True)
        shell.Closed(True)
        return shell

    def _vertex(self, place):
        vertex = TopoDS_Vertex()
        self.builder.MakeVertex(vertex, gp_Pnt(*place.tolist()), 2.0 * _LEAST)
        return vertex

    def _edge(self, geometry, reach, ends, off=0.0):
        edge, tolerance = TopoDS_Edge(), max(_LEAST, 1.1 * off)
        self.builder.MakeEdge(edge, geometry, TopLoc_Location(), tolerance)
        for vertex, side in zip(ends, (TopAbs_FORWARD, TopAbs_REVERSED), strict=True):
            self.builder.Add(edge, vertex.Oriented(side))
            self.builder.UpdateVertex(vertex, 2.0 * tolerance)
        self.builder.Range(edge, *map(float, reach))
        return edge

    def _face(self, region):
        surface, sheet, outward = self.surfaces[region], self.sheets[region], self.signs[region] > 0.0
        geometry = _surface_of(surface, sheet.axis, sheet.x)
        if sheet.whole:
            face = BRepBuilderAPI_MakeFace(geometry, _LEAST).Face()
        else:
            face = TopoDS_Face()
            self.builder.MakeFace(face, geometry, _LEAST)
        loops = self.rims.loops[region]
        if not outward:
            loops = [[(chain, not forward) for chain, forward in loop[::-1]] for loop in loops]
        wires = [loop for k, loop in enumerate(loops) if k not in sheet.around]
        sides = [[self._oriented(*step) for step in wire] for wire in wires]
        if sheet.around:
            sides.insert(0, self._with_seam(face, geometry, region, [loops[k] for k in sheet.around]))
        for side in sides:
            wire = TopoDS_Wire()
            self.builder.MakeWire(wire)
            for edge in side:
                self.builder.Add(wire, edge)
            wire.Closed(True)
            self.builder.Add(face, wire)
        fix = ShapeFix_Face(face)
        fix.FixOrientationMode = fix.FixMissingSeamMode = 0
        fix.Perform()
        return fix.Face() if outward else fix.Face().Reversed()

    def _oriented(self, chain, forward):
        return self.edges[chain].Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED)

    def _with_seam(self, face, geometry, region, loops):
        """The wire along both loops and both sides of a seam, or along one and around a pole."""
        surface, sheet = self.surfaces[region], self.sheets[region]
        numbers = [self.rims.start_of(loop) for loop in loops]
        ends = [self.vertices[n] for n in numbers]
        places = [self.rims.places[n] for n in numbers]
        uv = [uv_of(surface, sheet.axis, sheet.x, p[None]) for p in places]
        along = [float(p[1 - sheet.way][0]) for p in uv]
        if sheet.way == 1 or surface.kind == "torus":
            along[1] = along[0] + (along[1] - along[0]) % _TURN
        parts = [[self._oriented(*step) for step in loop] for loop in loops]
        up = True
        if len(loops) == 1:
            pole = self._pole(face, surface, sheet, loops[0], region)
            up = surface.kind == "sphere" and pole[1] > 0.0
            ends, along = (
                ([*ends, pole[0]], [*along, pole[1]]) if up else ([pole[0], *ends], [pole[1], *along])
            )
            parts = [*parts, [pole[2]]] if up else [[pole[2]], *parts]
        for loop, level in zip(
            loops, along[1:] if len(along) > len(loops) and not up else along, strict=False
        ):
            self._flat_on(face, surface, sheet, loop, level)
        curve = geometry.VIso(sheet.turn) if sheet.way else geometry.UIso(0.0)
        seam = self._edge(curve, along, ends)
        one, other = gp_Pnt2d(_TURN, 0.0), gp_Pnt2d(0.0, 0.0)
        direction = gp_Dir2d(0.0, 1.0)
        if sheet.way:
            one, other = gp_Pnt2d(0.0, sheet.turn), gp_Pnt2d(0.0, sheet.turn + _TURN)
            direction = gp_Dir2d(1.0, 0.0)
        self.builder.UpdateEdge(
            seam, Geom2d_Line(one, direction), Geom2d_Line(other, direction), face, _LEAST
        )
        self.builder.Range(seam, face, *along)
        return [*parts[0], seam.Oriented(TopAbs_FORWARD), *parts[1], seam.Oriented(TopAbs_REVERSED)]

    def _flat_on(self, face, surface, sheet, loop, level):
        """Give circles around the surface their straight lines in its parameters."""
        for number, _ in loop:
            curve, way = self.curves[number], sheet.way
            if curve.kind != "circle":
                continue
            t = np.linspace(0.0, curve.angle, 9)
            x = curve.start - curve.centre
            at = curve.centre + np.cos(t)[:, None] * x + np.sin(t)[:, None] * np.cross(curve.axis, x)
            uv = uv_of(surface, sheet.axis, sheet.x, at)
            angle, other = np.unwrap(uv[way]) - (sheet.turn if way else 0.0), uv[1 - way]
            sense = np.sign(angle[1] - angle[0])
            straight = np.abs(angle - angle[0] - sense * t).max()
            if max(straight, np.ptp(other)) > 1e-7:
                continue
            first = angle[0] % _TURN
            if min(first, _TURN - first) < 1e-7:
                first = 0.0 if sense > 0.0 else _TURN
            line = [(first + (sheet.turn if way else 0.0), level), (sense, 0.0)]
            start, along = (pair[:: -1 if way else 1] for pair in line)
            self.builder.UpdateEdge(
                self.edges[number], Geom2d_Line(gp_Pnt2d(*start), gp_Dir2d(*along)), face, _LEAST
            )

    def _pole(self, face, surface, sheet, loop, region):
        """Vertex, parameter and edge without length of the pole that a face with one loop around has."""
        chain_points = self.rims.polyline(self.rims.loops[region][sheet.around[0]])
        winding = _winding(uv_of(surface, sheet.axis, sheet.x, chain_points)[0])
        up = winding * self.signs[region] > 0.0
        height = 0.0 if surface.kind == "cone" else (0.5 if up else -0.5) * np.pi
        place = (
            surface.point
            if surface.kind == "cone"
            else surface.point + np.sign(height) * surface.radius * sheet.axis
        )
        vertex, edge = self._vertex(place), TopoDS_Edge()
        self.builder.MakeEdge(edge)
        for side in (TopAbs_FORWARD, TopAbs_REVERSED):
            self.builder.Add(edge, vertex.Oriented(side))
        self.builder.UpdateEdge(edge, Geom2d_Line(gp_Pnt2d(0.0, height), gp_Dir2d(1.0, 0.0)), face, _LEAST)
        self.builder.Range(edge, face, 0.0, _TURN)
        self.builder.Degenerated(edge, True)
        return vertex, height, edge.Oriented(TopAbs_REVERSED if up else TopAbs_FORWARD)


def _geometry_of(curve):
    """OpenCASCADE's curve and its range."""
    if curve.kind == "line":
        along = curve.end - curve.start
        line = Geom_Line(gp_Pnt(*curve.start.tolist()), gp_Dir(*along.tolist()))
        return line, (0.0, float(np.linalg.norm(along)))
    if curve.kind == "circle":
        x = curve.start - curve.centre
        frame = gp_Ax2(gp_Pnt(*curve.centre.tolist()), gp_Dir(*curve.axis.tolist()), gp_Dir(*x.tolist()))
        return Geom_Circle(frame, float(np.linalg.norm(x))), (0.0, curve.angle)
    return oc.curve_of(curve.spline), curve.spline.domain


def _surface_of(surface, axis, x):
    frame = gp_Ax3(gp_Pnt(*surface.point.tolist()), gp_Dir(*axis.tolist()), gp_Dir(*x.tolist()))
    if surface.kind == "plane":
        return Geom_Plane(frame)
    if surface.kind == "cone":
        return Geom_ConicalSurface(frame, surface.other, 0.0)
    if surface.kind == "torus":
        return Geom_ToroidalSurface(frame, surface.other, surface.radius)
    kind = {"cylinder": Geom_CylindricalSurface, "sphere": Geom_SphericalSurface}[surface.kind]
    return kind(frame, surface.radius)


def is_valid(shape) -> bool:
    """Whether OpenCASCADE's own checker finds nothing."""
    return BRepCheck_Analyzer(shape).IsValid()
