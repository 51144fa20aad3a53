"""Mesh files as people have them: right to the last polygon, or refused for the true reason."""

import json
import struct
import zipfile

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl

L = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3.0)])
CORNERS = b"v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\n"


def star(points, seed):
    """A polygon with as many reflex corners as others."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi * (np.arange(points) + rng.uniform(-0.3, 0.3, points)) / points
    radius = np.where(np.arange(points) % 2, rng.uniform(0.5, 1.0, points), rng.uniform(3.0, 6.0, points))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])


def prism(outline, height):
    """Vertices and polygons of a prism; its exact volume and area."""
    n, (x, y) = len(outline), outline.T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    length = np.linalg.norm(outline - np.roll(outline, -1, axis=0), axis=1).sum()
    vertices = np.vstack([np.column_stack([outline, np.full(n, z)]) for z in (0.0, height)])
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return (
        vertices,
        [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides],
        area * height,
        2 * area + length * height,
    )


def written(suffix, vertices, faces):
    rows = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
    lists = "".join(f"{len(face)} {' '.join(map(str, face))}\n" for face in faces)
    if suffix == ".obj":
        lines = "".join(f"f {' '.join(f'{i + 1}//{i + 1}' for i in face)}\n" for face in faces)
        return ("".join(f"v {row}\n" for row in rows.splitlines()) + lines).encode()
    if suffix == ".off":
        return f"OFF{len(vertices)} {len(faces)} 0\n{rows}{lists}".encode()
    kind = "ascii" if suffix == ".txt.ply" else f"binary_{suffix[1:-4]}_endian"
    head = f"ply\nformat {kind} 1.0\nelement vertex {len(vertices)}\n"
    head += "".join(f"property double {name}\n" for name in "xyz") + f"element face {len(faces)}\n"
    head = (head + "property list uchar int vertex_indices\nproperty uchar red\nend_header\n").encode()
    if kind == "ascii":
        return head + rows.encode() + lists.replace("\n", " 7\n").encode()
    order = "<" if "little" in kind else ">"
    packed = [struct.pack(f"{order}B{len(face)}iB", len(face), *face, 7) for face in faces]
    return head + vertices.astype(f"{order}f8").tobytes() + b"".join(packed)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".txt.ply", ".little.ply", ".big.ply"])
@pytest.mark.parametrize("outline", [L, star(8, 1), star(40, 2), 1e-2 * star(12, 3) + 5.0])
def test_polygons_of_any_shape_have_their_exact_volume_and_area(suffix, outline, tmp_path):
    vertices, faces, volume, area = prism(outline, 2.0)
    file = tmp_path / f"part{suffix}"
    file.write_bytes(written(suffix, vertices, faces))
    mesh = nl.read(file)
    assert mesh.is_watertight
    assert (mesh.volume, mesh.area) == pytest.approx((volume, area), rel=1e-9)


def test_a_face_that_crosses_itself_is_divided_and_named(tmp_path):
    file = tmp_path / "bow.obj"
    file.write_bytes(CORNERS + b"f 1 3 2 4\nf 1 2 3 4\nf 1 2 3 2\nf 1 1 1 1\n")
    with pytest.warns(UserWarning, match=r"bow.obj': 2 of its faces cross themselves"):
        assert len(nl.read(file).faces) == 8


@pytest.mark.parametrize(
    "text",
    [
        b"f 1 2 3 4\n",
        b"f -4 -3 -2 -1\n",
        b"g one\no two\nusemtl /dev/zero\nf 1 2 3 # a half\ns 1\nvn 0 0 1\nf -4//1 -2//1 4//1\n",
        b"f\t1\t2\\\n\t3\nf 1/ 3/9 4/9/9\r\n",
        b"l 1 2\np 3\nf 1 2 3\nv 9 9 9 1 0 0\nf -5 -3 -2\nf 5 5 5\n",
    ],
)
def test_objects_as_exporters_write_them(text, tmp_path):
    file = tmp_path / "part.obj"
    file.write_bytes(b"\xef\xbb\xbf" + CORNERS + b"mtllib nowhere.mtl\n" + text)
    assert nl.read(file).area == pytest.approx(12.0)


@pytest.mark.parametrize(("fourth", "said"), [("1.0", 0), ("-2.5", 1), ("1 2", 1), ("1 0 0", 0)])
def test_a_vertex_of_too_many_numbers_is_named(fourth, said, tmp_path, recwarn):
    (tmp_path / "part.obj").write_bytes(CORNERS.replace(b"\n", f" {fourth}\n".encode(), 1) + b"f 1 2 3 4\n")
    assert nl.read(tmp_path / "part.obj").area == pytest.approx(12.0)
    assert ["numbers after 'v'" in str(one.message) for one in recwarn] == said * [True]


TETRAHEDRON = trimesh.Trimesh([(0, 0, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1.5e-16)], [(0, 1, 2), (1, 0, 3)])
FACETS = "".join(
    f"facet normal 0 0 0\n outer loop\n{''.join(f'  vertex {x:g} {y:g} {z:E}{chr(10)}' for x, y, z in one)}"
    " endloop\nendfacet\n"
    for one in TETRAHEDRON.triangles
)


@pytest.mark.parametrize(
    "text",
    [
        f"solid facet vertex loop\n{FACETS}endsolid facet vertex\n",
        f"SOLID\n{FACETS.upper()}END SOLID",
        f"solid a\n{FACETS}endsolid a\nsolid b\nendsolid b\n",
        f"solid a\r{FACETS.replace(chr(10), chr(13)).replace('endloop', 'end loop')}endsolid a\r",
        f"  solid endsolid\n{FACETS.replace('endfacet', 'end facet')}\n\tend solid endsolid\n\n",
        f"\ufeffsolid a\n{FACETS}endsolid a\n\0",
    ],
)
def test_text_of_stl_by_its_grammar(text, tmp_path):
    file = tmp_path / "part.stl"
    file.write_text(text)
    assert nl.read(file).triangles == pytest.approx(TETRAHEDRON.triangles)


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("at", ["facet", "outer", "vertex", "endloop"])
def test_text_of_stl_that_lost_triangles_is_warned_of(first, at, tmp_path, recwarn):
    """Cut out between equal words, what is left keeps the grammar."""
    facets = trimesh.creation.icosphere(1, 5.0).export(file_type="stl_ascii").splitlines()[1:-1]
    k = next(k for k, line in enumerate(facets[:7]) if line.strip().startswith(at))
    left = facets[: 7 * first + k] + facets[7 * first + 35 + k :]
    for lines, lone in ((facets, False), (left, True)):
        (tmp_path / "part.stl").write_text("\n".join(["solid a", *lines, "endsolid a", ""]))
        assert len(nl.read(tmp_path / "part.stl").faces) == len(lines) // 7
        assert [("have no second triangle" in str(one.message)) for one in recwarn] == lone * [True]


def test_binary_stl_by_its_length(tmp_path):
    file = tmp_path / "part.stl"
    data = trimesh.creation.box((2, 3, 4)).export(file_type="stl")
    file.write_bytes(b"solid facet vertex endsolid".ljust(80) + data[80:])
    assert nl.read(file).volume == pytest.approx(24.0)
    for count, length in ((0, len(data)), (110250586, len(data)), (12, len(data) - 30)):
        file.write_bytes(data[:80] + struct.pack("<I", count) + data[84:length])
        fits = f"{(length - 84) / 50:.6g}"
        with pytest.raises(
            ValueError, match=f"header counts {count} triangles, but its length is that of {fits}"
        ):
            nl.read(file)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face 1\nproperty list uchar int vertex_index\nend_header\n"
OFF = "OFF\n3 1 0\n0 0 0\n9 0 0\n0 9 0\n"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.ply", f"{PLY}end_header\n0 0 0\nnan 0 0\n0 9 0\n", r"points\[1, 0\] is nan"),
        ("a.ply", f"{PLY}end_header\n0 0 0\n9 0 inf\n0 9 0\n", r"points\[1, 2\] is inf"),
        ("a.ply", f"{PLY}{FACE}0 0 0\n9 0 0\n3 0 1 2\n0 9 0\n", "line 12: a vertex has 4 numbers, and not 3"),
        ("a.ply", f"{PLY}{FACE}0 0 0\n9 0 0\n0 9 0\n3 0 1 7\n", "corners numbered 0 to 7"),
        ("a.ply", f"{PLY}{FACE}0 0 0\n9 0 0\n0 9 0\n2 0 1\n", "line 13: a face of 2 corners"),
        ("a.ply", f"{PLY}{FACE}0 0 0\n9 0 0\n0 9 0\n", "promises 4 lines, but 3 follow"),
        ("a.ply", f"{PLY}comm nt\n{FACE}0 0 0\n9 0 0\n0 9 0\n3 0 1 2\n", "its header has 'comm'"),
        ("a.off", f"{OFF}-3 0 1 2\n", "line 6: a face of -3 corners"),
        ("a.off", f"{OFF}2 0 1 2\n", "line 6: a face of 2 corners"),
        ("a.off", f"{OFF}4 0 1 2\n", "line 6: a face of 4 corners with 3 numbers"),
        ("a.off", "OFF 3 1 0\n0 0 0\n3 0 1 2\n9 0 0\n0 9 0\n", "line 3: a vertex has 4 numbers"),
        ("a.obj", "v 0 0 0\nv 1,5 0 0\nv 0 9 0\nf 1 2 3\n", "line 2: '1,5' is no number; .* point"),
        ("a.obj", f"{CORNERS.decode()}f 1 2\n", "fewer than three corners"),
        *(("a.obj", f"{CORNERS.decode()}f 1 2 {corner}\n", "is no number of a vertex")
          for corner in ("0", "5", "-5", "-", "x", "1.5", "/1", "9" * 30)),
        ("a.obj", f"{CORNERS.decode()}f 1/1 2/v 3\n", "'2/v', is no number of a vertex"),
        ("a.ply", f"{PLY}{FACE.replace('face', 'fce')}0 0 0\n9 0 0\n0 9 0\n3 0 1 2\n", "'fce' lists corners"),
        ("a.stl", f"solid a\n{FACETS.replace('vertex 1', 'vertex 1,')}endsolid\n", "line 2: '1,' is no"),
        ("a.stl", f"solid a\n{FACETS}facet normal 0 0 1\n", "line 16: .* there is 'facet'; a part"),
        ("a.stl", f"solid a\n{FACETS}", "after it a whole facet or 'endsolid' is due"),
        ("a.3mf", "no archive", "not a zip file"),
        ("a.glb", "no such thing", "does not begin as a GLB file"),
    ],
)  # fmt: skip
def test_what_is_damaged_is_refused_by_its_line(name, text, said, tmp_path):
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(ValueError, match=rf"{name}' cannot be read: .*{said}"):
        nl.read(file)


MODEL = """<model unit="inch" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="1"><mesh><vertices>
<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
<vertex x="0" y="0" z="1"/></vertices><triangles>
<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh></object>
<object id="2"><components>
<component objectid="1" transform="2 0 0 0 2 0 0 0 -2 5 0 0"/></components></object>
<object id="5" type="support"><mesh/></object>
<object id="3"><components><component objectid="3"/></components></object>
</resources><build><item objectid="1"/>
<item objectid="%s" transform="1 0 0 0 1 0 0 0 1 0 7 0"/></build></model>"""
RELATIONS = '<Relationships><Relationship Target="/3D/a.model" Type="http://x/3dmodel"/></Relationships>'


def test_units_and_placements_of_packages(tmp_path):
    def package(number, old="", new=""):
        with zipfile.ZipFile(tmp_path / "part.3mf", "w") as archive:
            archive.writestr("_rels/.rels", RELATIONS)
            archive.writestr("3D/a.model", (MODEL % number).replace(old, new, 1))
        return tmp_path / "part.3mf"

    mesh = nl.read(package(2, "<item ", '<item printable="1" '))  # as slicers write
    assert mesh.volume == pytest.approx(25.4**3 * (1 + 8) / 6)  # mirrored, and wound rightly
    assert mesh.bounds / 25.4 == pytest.approx(np.array([(0, 0, -2), (7, 9, 1)]))
    assert nl.read(package(2), unit="cm").volume == pytest.approx(1000 * 1.5)
    with pytest.warns(UserWarning, match="its object 5 is a support and no part, and left out"):
        assert nl.read(package(5)).volume == pytest.approx(25.4**3 / 6)
    for number, said in ((3, "holds itself"), (4, "object 4 of 3D/a.model is missing")):
        with pytest.raises(ValueError, match=said):
            nl.read(package(number))
    damages = ("transform", "tra"), ("unit", "u"), ("<triangle ", "triangle "), ("<vertex", "vertex")
    for damage in (*damages, ("<vertex ", "<vartex "), ("<triangle ", "<triangl ")):
        with pytest.raises(ValueError, match="damaged"):
            nl.read(package(2, *damage))


def test_units_and_placements_of_scenes(tmp_path):
    box, file = trimesh.creation.box((2, 3, 4)), tmp_path / "part.glb"
    scene = trimesh.Scene([box])
    scene.add_geometry(box, transform=np.diag([2.0, 2.0, 2.0, 1.0]) + np.eye(4, k=3) * 9)
    scene.export(file)
    assert nl.read(file, unit="mm").volume == pytest.approx(24 * 9)
    with pytest.warns(UserWarning, match="GLB is in metres"):
        assert nl.read(file).volume == pytest.approx(24e9 * 9)
    assert nl.slice_mesh(scene, 0.0)[0].area == pytest.approx(6 + 24)


CHANGES = "sparse normalized fan draco instances node corner version mesh mode indices ends view buffer"


@pytest.mark.parametrize("change", CHANGES.split())
def test_scenes_that_would_be_read_wrongly_are_refused(change, tmp_path):
    """Or named, if their points are not where the file says that they end."""
    data = trimesh.Scene([trimesh.creation.box((2, 3, 4))]).export(file_type="glb")
    size = int.from_bytes(data[12:16], "little")
    head, rest = json.loads(data[20 : 20 + size]), data[20 + size :]
    part = head["meshes"][0]["primitives"][0]
    points = head["accessors"][part["attributes"]["POSITION"]]
    if change == "sparse":
        points["sparse"] = {"count": 1}
    elif change == "normalized":
        points |= {"componentType": 5122, "normalized": True}
    elif change == "fan":
        part["mode"] = 6
    elif change == "draco":
        del points["bufferView"]
    elif change == "node":
        head["nodes"] = [{"meSh" if key == "mesh" else key: one[key] for key in one} for one in head["nodes"]]
    elif change == "corner":
        points["count"] -= 1
    elif change == "version":
        head["asset"]["version"] = "3.0"
    elif change == "mesh":
        head["nodes"] = [{**one, "mesh": 7} if "mesh" in one else one for one in head["nodes"]]
    elif change == "indices":
        del head["accessors"][part["indices"]]["bufferView"]
    elif change == "view":
        head["bufferViews"][0]["buffer"] = -1
    elif change == "buffer":
        head["buffers"][0]["byteLength"] = 100
    elif change == "mode":
        part["mode"] = 1  # lines
    elif change == "ends":
        points["max"][0] += 1
    else:
        head["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    lengths = [struct.pack("<I", n) for n in (20 + len(text) + len(rest), len(text))]
    (tmp_path / "a.glb").write_bytes(data[:8] + lengths[0] + lengths[1] + data[16:20] + text + rest)
    if change == "ends":
        with pytest.warns(UserWarning, match="its points do not reach the ends that it states"):
            nl.read(tmp_path / "a.glb", unit="m")
        return
    said = r"are packed|repeats its parts|has 'meSh'|no number of one|of version '3.0'|not there|its buffer"
    with pytest.raises(ValueError, match=said):
        nl.read(tmp_path / "a.glb")


def test_a_part_of_an_odd_size_without_a_unit_is_asked_for_it(tmp_path):
    for size, unit, factor in ((0.02, "Metres", 1e3), (2e4, "\u00b5m", 1e-3), (0.02, "IN", 25.4)):
        file = tmp_path / "part.obj"
        trimesh.creation.box((size, size, size)).export(file)
        with pytest.warns(UserWarning, match="across and states no unit"):
            assert nl.read(file).volume == pytest.approx(size**3)
        assert nl.read(file, unit=unit).volume == pytest.approx((factor * size) ** 3)
    with pytest.raises(ValueError, match="unit must be one of mm"):
        nl.read(file, unit="parsec")
    curve = nl.export(tmp_path / "curve.json", nl.paper.CURVE)
    with pytest.raises(ValueError, match="no mesh file; leave it out"):
        nl.read(curve, unit="m")
