"""Parts of which some is exact and some free form, made with OpenCASCADE, keep their exact faces."""

import numpy as np
import pytest
import trimesh
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Elips, gp_GTrsf, gp_Mat, gp_Pnt, gp_Vec, gp_XYZ
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopoDS import TopoDS

import nurbs_lab as nl
from nurbs_lab.mesh import samples
from nurbs_lab.mesh.repair import ClosedSurface
from nurbs_lab.mesh.solid import regions
from nurbs_lab.tests.mesh.cad import (
    apart,
    box,
    joined,
    meshed,
    parts,
    rod,
    sizes,
    stored,
    volume,
    without,
)


def oval(x, y, z, wide, narrow, height):
    ellipse = gp_Elips(gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, 1)), wide, narrow)
    wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(ellipse).Edge()).Wire()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire).Face(), gp_Vec(0, 0, height)).Shape()


def oval_bore():
    """A block with an oval hole and a round one."""
    return without(box(0, 0, 0, 40, 30, 20), oval(20, 15, -1, 8.3, 8.0, 30), rod(5, 5, -1, 2, 30))


def oval_pin():
    """An oval pin on a plate, cut by a cylinder, so that its rim lies on planes and on a round face."""
    pin = BRepAlgoAPI_Common(oval(20, 15, 0, 9, 7, 30), rod(20, -20, 0, 18, 70, (0, 1, 0))).Shape()
    return joined(box(0, 0, 0, 40, 30, 6), pin)


def dome():
    """Half an ellipsoid on a plate with two holes."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform

    stretch = gp_GTrsf(gp_Mat(1.5, 0, 0, 0, 1.0, 0, 0, 0, 1.2), gp_XYZ(20, 15, 5))
    ball = BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(8.0).Shape(), stretch, True).Shape()
    part = joined(box(0, 0, 0, 40, 30, 5), ball)
    return without(part, box(-5, -5, -20, 60, 60, 20), rod(4, 4, -1, 2, 9), rod(36, 26, -1, 2, 9))


@pytest.mark.parametrize(("make", "planes", "cylinders"), [(oval_bore, 6, 1), (oval_pin, 6, 1), (dome, 6, 2)])
def test_exact_faces_beside_free_form_stay_exact(tmp_path, make, planes, cylinders):
    shape = make()
    mesh = meshed(shape, 0.05, 0.25)
    tolerance = 0.005 * mesh.scale
    rebuilt = nl.reconstruct(mesh, tolerance=tolerance)
    found = stored(tmp_path, rebuilt)
    kinds = [kind for kind, *_ in sizes(found)]
    assert (kinds.count("plane"), kinds.count("cylinder")) == (planes, cylinders)
    there, here = ([one[1:] for one in sizes(part) if one[0] == "cylinder"] for part in (found, shape))
    assert np.abs(np.array(there) - here).max() < 1e-3 * tolerance
    assert volume(found) == pytest.approx(volume(shape), rel=3e-3)
    assert rebuilt.volume == pytest.approx(volume(found), rel=1e-5)
    closed = rebuilt.to_mesh(tolerance / 20)
    assert closed.is_watertight
    assert apart(closed, mesh) <= 1.06 * tolerance
    assert rebuilt.within_tolerance
    assert rebuilt.seam_angle < 0.01


def test_what_meets_free_form_smoothly_belongs_to_it():
    whole = box(0, 0, 0, 40, 30, 20)
    maker = BRepFilletAPI_MakeFillet(whole)
    maker.Add(2.0, 5.0, TopoDS.Edge_s(next(parts(whole, TopAbs_EDGE))))
    rebuilt = nl.reconstruct(meshed(maker.Shape(), 0.05, 0.25), tolerance=0.25)
    assert sum(face.kind == "plane" for face in rebuilt.faces) == 4
    assert rebuilt.within_tolerance
    assert rebuilt.seam_angle < 0.01


def test_a_nut_whose_bore_is_no_circle_keeps_its_planes_and_the_tolerance():
    rebuilt = nl.reconstruct(samples.nut(), tolerance=0.2)
    assert sum(face.kind == "plane" for face in rebuilt.faces) == 26
    assert len(rebuilt.faces) < 50
    assert rebuilt.within_tolerance


def test_facets_that_are_too_small_together_are_not_searched(monkeypatch):
    seeds, ball = [], trimesh.creation.icosphere(subdivisions=2)
    monkeypatch.setattr(regions, "_surface_at", lambda facets, links, free, seed: seeds.append(seed))
    facets = regions.facets_of(ClosedSurface(ball.vertices, ball.faces, 0, False, ball.volume))
    area = facets.areas.sum()
    assert regions.regions_of(facets, 30.0, least=1.1 * area) is None
    assert not seeds
    assert regions.regions_of(facets, 30.0, least=0.9 * area) is None
    assert seeds
