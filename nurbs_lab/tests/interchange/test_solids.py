"""A reconstruction becomes a solid that OpenCASCADE's own checker accepts, or says that it does not."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer

import nurbs_lab as nl
from nurbs_lab.mesh import samples
from nurbs_lab.tests.interchange.shapes import assert_same, cylinder, surface


def solids(path, deflection=None):
    """Volume and number of faces of every solid of a STEP file; each must pass the checker.

    OpenCASCADE's integration was seen 1 % off on a skin with hundreds of spans, whatever accuracy was
    asked for; the volume of its triangulation, within ``deflection`` mm, was not.
    """
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found = []
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_SOLID)
    while explorer.More():
        solid = explorer.Current()
        assert BRepCheck_Analyzer(solid).IsValid()
        properties = GProp_GProps()
        if deflection:
            BRepMesh_IncrementalMesh(solid, deflection, False, 10 * deflection)
            BRepGProp.VolumeProperties_s(solid, properties, False, False, True)
        else:
            BRepGProp.VolumeProperties_s(solid, properties, 1e-6)
        found.append((properties.Mass(), count(solid, TopAbs_FACE)))
        explorer.Next()
    return found


def count(shape, kind):
    explorer, n = TopExp_Explorer(shape, kind), 0
    while explorer.More():
        n += 1
        explorer.Next()
    return n


def reconstruction(*surfaces):
    return SimpleNamespace(surfaces=surfaces)


def bent(tube, lift):
    """The same tube with its rims bent out of their planes."""
    net = tube.control_points.copy()
    net[..., 2] += lift * net[..., 0] ** 2
    return nl.NurbsSurface(tube.degrees, tube.knots, net, tube.weights)


def revolved(radius, height):
    """The cylinder's circle carried along a profile: rows of radii and heights."""
    tube = cylinder(1.0, 1.0)
    circle, weights = tube.control_points[:, 0, :2], tube.weights[:, :1]
    rows = [np.column_stack([circle * r, np.full(9, z)]) for r, z in zip(radius, height, strict=True)]
    count = len(rows)
    along = np.r_[[0] * 3, np.linspace(0, 1, count - 1)[1:-1], [1] * 3]
    net = np.stack(rows, axis=1)
    return nl.NurbsSurface((2, 2), (tube.knots[0], along), net, np.tile(weights, (1, count)))


def test_a_tube_is_capped(tmp_path):
    ((volume, faces),) = solids(nl.export(tmp_path / "tube.step", reconstruction(cylinder(3, 10))))
    assert faces == 3
    assert volume == pytest.approx(np.pi * 9 * 10, rel=1e-6)


def test_the_volume_does_not_depend_on_the_way_the_tube_is_turned(tmp_path):
    tube = cylinder(3, 10)
    turned = nl.NurbsSurface(tube.degrees, tube.knots, tube.control_points[:, ::-1], tube.weights)
    ((volume, _),) = solids(nl.export(tmp_path / "tube.step", reconstruction(turned)))
    assert volume == pytest.approx(np.pi * 9 * 10, rel=1e-6)


def test_a_rim_out_of_plane_gets_a_patch(tmp_path):
    ((volume, faces),) = solids(
        nl.export(tmp_path / "tube.step", reconstruction(bent(cylinder(3, 10), 0.05)))
    )
    assert faces == 3
    assert volume == pytest.approx(np.pi * 9 * 10, rel=2e-3)  # both rims rise alike


def test_poles_need_no_cap(tmp_path):
    spindle = revolved([0, 2, 3, 2, 0], [0, 0, 4, 8, 8])
    ((volume, faces),) = solids(nl.export(tmp_path / "spindle.step", reconstruction(spindle)))
    assert faces == 1
    v = np.linspace(0, 1, 20001)
    profile = spindle(0.0, v)
    assert volume == pytest.approx(np.trapezoid(np.pi * profile[:, 0] ** 2, profile[:, 2]), rel=1e-6)


def test_a_ring_needs_no_cap(tmp_path):
    ring = revolved([5, 6, 6, 6, 5, 4, 4, 4, 5], [-1, -1, 0, 1, 1, 1, 0, -1, -1])
    ((volume, faces),) = solids(nl.export(tmp_path / "ring.step", reconstruction(ring)))
    assert faces == 1
    v = np.linspace(0, 1, 200001)
    x, _, z = ring(0.0, v).T
    area = abs(np.trapezoid(np.pi * x**2, z))
    assert volume == pytest.approx(area, rel=1e-6)


def test_several_tubes_are_several_solids(tmp_path):
    tubes = [cylinder(3, 10), cylinder(2, 5)]
    found = solids(nl.export(tmp_path / "tubes.step", reconstruction(*tubes)))
    assert [v for v, _ in found] == pytest.approx([np.pi * 90, np.pi * 20], rel=1e-6)
    for one, other in zip(tubes, nl.read(tmp_path / "tubes.step"), strict=True):
        assert_same(one, other)


def test_an_open_sheet_is_written_with_a_warning(tmp_path):
    with pytest.warns(UserWarning, match="does not close"):
        nl.export(tmp_path / "sheet.step", reconstruction(surface()))
    assert solids(tmp_path / "sheet.step") == []
    assert_same(surface(), *nl.read(tmp_path / "sheet.step"))


def ball_with_a_hollow():
    outside, inside = (trimesh.creation.icosphere(3, radius=r) for r in (10, 4))
    inside.invert()
    return trimesh.util.concatenate([outside, inside])


@pytest.mark.parametrize(
    ("mesh", "layers", "tolerance", "deflection"),
    [
        (lambda: samples.frog_organ(14), 20, 0.5, 0.1),
        (lambda: trimesh.creation.torus(10, 3, major_sections=64, minor_sections=32), 16, 0.2, 0.02),
        (ball_with_a_hollow, 30, 0.1, 0.02),
    ],
)
def test_a_reconstruction_has_the_volume_of_its_mesh(tmp_path, mesh, layers, tolerance, deflection):
    mesh = mesh()
    rebuilt = nl.reconstruct(mesh, layers=layers, tolerance=tolerance)
    found = solids(nl.export(tmp_path / "part.step", rebuilt), deflection)
    assert sum(volume for volume, _ in found) == pytest.approx(mesh.volume, rel=5e-3)


def test_the_surfaces_of_a_reconstruction_come_back(tmp_path):
    ring = trimesh.creation.torus(10, 3, major_sections=48, minor_sections=24)
    rebuilt = nl.reconstruct(ring, layers=8, tolerance=0.5)
    for suffix in (".step", ".3dm", ".json"):
        got = nl.read(nl.export(tmp_path / f"ring{suffix}", rebuilt))
        assert len(got) == len(rebuilt.surfaces)
        for one, other in zip(rebuilt.surfaces, got, strict=True):
            assert_same(one, other)


def test_iges_holds_the_capped_tube(tmp_path):
    reader = IGESControl_Reader()
    reader.ReadFile(str(nl.export(tmp_path / "tube.igs", reconstruction(cylinder()))))
    reader.TransferRoots()
    assert count(reader.OneShape(), TopAbs_FACE) == 3
    assert_same(cylinder(), *nl.read(tmp_path / "tube.igs"))
