"""A reconstruction as solids, for STEP and IGES."""

from nurbs_lab.interchange._opencascade import edge_of, face_of
from nurbs_lab.mesh import TrimmedShell
from nurbs_lab.mesh.solid.opencascade import sewn

from OCP.BRep import BRep_Builder  # isort: skip  (after the check that it is there)
from OCP.TopoDS import TopoDS_Solid


def shapes_of(parts):
    """One OpenCASCADE shape for every curve and surface, and a solid for every body of a reconstruction."""
    solids = [solid_of(body) for reconstruction in parts.solids for body in reconstruction.bodies]
    return [*map(edge_of, parts.curves), *map(face_of, parts.surfaces), *solids]


def solid_of(shells):
    """A solid bounded by shells: its outer boundary and its voids.

    Fitted faces that meet have equal control points along their edge, so OpenCASCADE sews them exactly.
    """
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for shell in shells:
        if isinstance(shell, TrimmedShell):
            builder.Add(solid, shell.shape())
            continue
        found = sewn(map(face_of, shell.surfaces))
        if len(found) != 1:
            raise ValueError(f"items: the faces of a shell make {len(found)} shells; give a larger tolerance")
        builder.Add(solid, found[0])
    return solid
