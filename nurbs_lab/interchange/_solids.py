"""A reconstruction as solids, for STEP and IGES: faces, edges and vertices as its shells number them.

Faces that meet in an edge share this edge, and its curve has the control points that both of them have there,
so nothing needs to be sewn together.
"""

import numpy as np

from nurbs_lab.interchange._opencascade import edge_of, face_of
from nurbs_lab.mesh import TrimmedShell
from nurbs_lab.mesh.solid.opencascade import curve_of, surface_of
from nurbs_lab.nurbs import NurbsCurve

from OCP.BRep import BRep_Builder  # isort: skip  (after the check that it is there)
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

TOLERANCE_MM = 1e-7  # of shared edges and vertices: they are equal to rounding
#: The corners of a face, (u, v); its side k runs from corner k to the next.
CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def shapes_of(parts):
    """One OpenCASCADE shape for every curve and surface, and a solid for every body of a reconstruction."""
    solids = [solid_of(body) for reconstruction in parts.solids for body in reconstruction.bodies]
    return [*map(edge_of, parts.curves), *map(face_of, parts.surfaces), *solids]


def solid_of(shells):
    """A solid bounded by shells: its outer boundary and its voids."""
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for shell in shells:
        exact = isinstance(shell, TrimmedShell)
        builder.Add(solid, shell.shape() if exact else _shell(builder, shell))
    return solid


def _shell(builder, shell):
    vertices, edges = {}, {}
    out = TopoDS_Shell()
    builder.MakeShell(out)
    for surface, *numbers in zip(shell.surfaces, shell.corners, shell.edges, shell.forward, strict=True):
        corners, sides, forward = (row.tolist() for row in numbers)
        net = surface.control_points
        rows = net[:, 0], net[-1], net[::-1, -1], net[0, ::-1]
        for corner, row in zip(corners, rows, strict=True):
            if corner not in vertices:
                vertices[corner] = TopoDS_Vertex()
                builder.MakeVertex(vertices[corner], gp_Pnt(*row[0].tolist()), TOLERANCE_MM)
        face, wire = TopoDS_Face(), TopoDS_Wire()
        builder.MakeFace(face, surface_of(surface), TOLERANCE_MM)
        builder.MakeWire(wire)
        for k, (side, along) in enumerate(zip(sides, forward, strict=True)):
            ends = [corners[k], corners[(k + 1) % 4]]
            if side not in edges:
                edges[side] = _edge(
                    builder, surface, rows[k] if along else rows[k][::-1], vertices, ends, along
                )
            edge = edges[side]
            start, stop = np.array([CORNERS[k], CORNERS[(k + 1) % 4]])[:: 1 if along else -1]
            line = Geom2d_Line(gp_Pnt2d(*start.tolist()), gp_Dir2d(*(stop - start).tolist()))
            builder.UpdateEdge(edge, line, face, TOLERANCE_MM)
            builder.Range(edge, face, 0.0, 1.0)
            builder.Add(wire, edge.Oriented(TopAbs_FORWARD if along else TopAbs_REVERSED))
        builder.Add(face, wire)
        builder.Add(out, face)
    out.Closed(True)
    return out


def _edge(builder, surface, row, vertices, ends, along):
    edge, curve = TopoDS_Edge(), curve_of(NurbsCurve(surface.degrees[0], surface.knots[0], row))
    builder.MakeEdge(edge, curve, TopLoc_Location(), TOLERANCE_MM)
    first, last = ends if along else ends[::-1]
    builder.Add(edge, vertices[first].Oriented(TopAbs_FORWARD))
    builder.Add(edge, vertices[last].Oriented(TopAbs_REVERSED))
    builder.Range(edge, 0.0, 1.0)
    return edge
