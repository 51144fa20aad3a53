"""A reconstruction becomes solids that OpenCASCADE's own checker accepts, one for every body."""

import pytest
import trimesh
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import assert_same
from nurbs_lab.tests.mesh.cad import parts


def solids(path):
    """Volume and number of faces of every solid of a file; each must pass the checker.

    The volume is that of OpenCASCADE's triangulation: its integration was seen 1 % off on a skin with
    hundreds of spans.
    """
    reader = STEPControl_Reader() if path.suffix == ".step" else IGESControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found = []
    for solid in parts(reader.OneShape(), TopAbs_SOLID):
        assert BRepCheck_Analyzer(solid).IsValid()
        properties = GProp_GProps()
        BRepMesh_IncrementalMesh(solid, 0.02, False, 0.2)
        BRepGProp.VolumeProperties_s(solid, properties, False, False, True)
        found.append((properties.Mass(), sum(1 for _ in parts(solid, TopAbs_FACE))))
    return found


def ball_with_a_hollow():
    outside, inside = (trimesh.creation.icosphere(3, radius=r) for r in (10, 4))
    inside.invert()
    return trimesh.util.concatenate([outside, inside])


def test_the_surfaces_of_a_reconstruction_come_back(tmp_path):
    ring = trimesh.creation.torus(10, 3, major_sections=48, minor_sections=24)
    rebuilt = nl.reconstruct(ring, tolerance=0.5)
    for suffix in (".step", ".json"):
        got = nl.read(nl.export(tmp_path / f"ring{suffix}", rebuilt))
        assert len(got) == len(rebuilt.surfaces)
        for one, other in zip(rebuilt.surfaces, got, strict=True):
            assert_same(one, other)


@pytest.mark.parametrize("suffix", [".step", ".igs"])
def test_every_body_is_one_valid_solid_with_its_voids(tmp_path, suffix):
    bodies = [trimesh.creation.box(), trimesh.creation.torus(10, 3, 64, 32)]
    bodies = [body.apply_translation([20 + 15 * k, 0, 0]) for k, body in enumerate(bodies)]
    mesh = trimesh.util.concatenate([ball_with_a_hollow(), *bodies])
    rebuilt = nl.reconstruct(mesh, tolerance=0.1)
    found = solids(nl.export(tmp_path / f"part{suffix}", rebuilt))
    assert len(found) == 3
    assert sum(faces for _, faces in found) == len(rebuilt.surfaces)
    assert sum(volume for volume, _ in found) == pytest.approx(mesh.volume, rel=1e-2)


def test_a_solid_of_planes_is_refused_with_a_cure_that_works(tmp_path):
    made = nl.reconstruct(trimesh.creation.box((3, 2, 1)), tolerance=0.01)
    file = nl.export(tmp_path / "part.step", made)
    with pytest.raises(ValueError, match=r"no surface other than planes.*; save the part as an STL"):
        nl.read(file)
    with pytest.raises(
        ValueError, match=r"'\.step' is none of the formats \.stl, .*, or save it as one of these"
    ):
        nl.reconstruct(file, tolerance=0.01)
    assert nl.read(nl.export(tmp_path / "part.stl", made)).volume == pytest.approx(6)
