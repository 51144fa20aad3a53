"""3MF and GLB: parts with their unit and their places."""

import json
import zipfile
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import trimesh

from nurbs_lab.mesh.formats.shape import Shape

_MOST_BYTES = 2**32  # of an unpacked part of a 3MF file, and of all that its components repeat
_FLOAT, _TRIANGLES, _STRIP = 5126, 4, 5  # numbers of glTF
_WORDS = {  # of glTF, beside those that all of its parts may have
    "nodes": "camera children skin matrix mesh rotation scale translation weights",
    "accessors": "bufferView byteOffset componentType normalized count type max min sparse",
    "bufferViews": "buffer byteOffset byteLength byteStride target",
}


def read_3mf(data):
    models, parts, left_out = {}, [], {}
    with zipfile.ZipFile(BytesIO(data)) as archive:

        def model(name):
            if name not in models:
                if archive.getinfo(name).file_size > _MOST_BYTES:
                    raise ValueError(f"{name} is larger than {_MOST_BYTES} bytes when it is unpacked")
                models[name] = ElementTree.fromstring(archive.read(name))
            return models[name]

        def add(name, number, placed, inside=()):
            objects = model(name).iterfind("{*}resources/{*}object")
            thing = next((one for one in objects if one.get("id") == number), None)
            if thing is None or (name, number) in inside:
                raise ValueError(f"object {number} of {name} is missing or holds itself")
            if thing.get("type", "model") != "model":
                left_out[f"its object {number} is a {thing.get('type')} and no part, and left out"] = None
                return
            if thing.find("{*}mesh") is not None:
                parts.append(_3mf_mesh(thing.find("{*}mesh"), placed))
            if sum(corners.nbytes for _, corners in parts) > _MOST_BYTES:
                raise ValueError(f"its components repeat one another to more than {_MOST_BYTES} bytes")
            for part in thing.iterfind("{*}components/*"):
                place = _placing(part) @ placed
                add(_path_of(part, name), part.get("objectid"), place, (*inside, (name, number)))

        relations = ElementTree.fromstring(archive.read("_rels/.rels"))
        roots = [one.get("Target") for one in relations if one.get("Type").endswith("/3dmodel")]
        root = roots[0].lstrip("/")
        for item in model(root).iterfind("{*}build/*"):
            add(_path_of(item, root), item.get("objectid"), _placing(item))
        _require_known(model(root), "unit", "requiredextensions", "recommendedextensions")
        unit = model(root).get("unit", "millimeter")
    points, corners = trimesh.util.append_faces([part[0] for part in parts], [part[1] for part in parts])
    return Shape(points, np.full(len(corners), 3), corners.ravel(), unit, tuple(left_out))


def _path_of(item, name):
    paths = [value for key, value in item.items() if key.endswith("}path")]  # of the production extension
    return paths[0].lstrip("/") if paths else name


def _placing(item):
    """The matrix ``(4, 4)`` that a row (x, y, z, 1) is multiplied by."""
    _require_known(item, "objectid", "transform", "partnumber", "printable")  # the last is of slicers
    placed = np.eye(4)
    if item.get("transform"):
        placed[:, :3] = np.array(item.get("transform").split(), dtype=float).reshape(4, 3)
    return placed


def _require_known(element, *names):
    """Refuse an attribute that is none of these, nor of an extension: it may be a damaged one of them."""
    if strange := {key for key in element.attrib if key[0] != "{"} - {*names}:
        raise ValueError(f"its {min(strange)!r} is not known there; it is damaged")


def _rows(mesh, table, element, names):
    rows = mesh.findall(f"{{*}}{table}/*")
    if strange := {row.tag.rpartition("}")[2] for row in rows} - {element}:
        raise ValueError(f"{min(strange)!r} stands among its {table}; it is damaged")
    return np.array([row.get(name) for row in rows for name in names], dtype=float)


def _3mf_mesh(mesh, placed):
    if "".join(mesh.itertext()).strip():
        raise ValueError("text stands among its vertices and triangles; it is damaged")
    points = _rows(mesh, "vertices", "vertex", "xyz").reshape(-1, 3)
    corners = _rows(mesh, "triangles", "triangle", ("v1", "v2", "v3")).astype(np.int64)
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        raise ValueError(f"a corner of a triangle is no number of one of the {len(points)} vertices")
    turned = np.linalg.det(placed[:3, :3]) < 0.0
    return points @ placed[:3, :3] + placed[3, :3], corners.reshape(-1, 3)[:, :: -1 if turned else 1]


def read_glb(data):
    if data[:8] != b"glTF\2\0\0\0" or int.from_bytes(data[8:12], "little") != len(data):
        raise ValueError("it does not begin as a GLB file of version 2 does, or not with its own length")
    head = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    for kind, words in _WORDS.items():
        for i, one in enumerate(head.get(kind, ())):
            if strange := one.keys() - words.split() - {"name", "extensions", "extras"}:
                raise ValueError(f"{kind}[{i}] has {min(strange)!r}, which this format does not know")
    if not head["asset"]["version"].startswith("2."):
        raise ValueError(f"its asset is of version {head['asset']['version']!r}, and not of 2")
    sizes = dict(enumerate(one["byteLength"] for one in head.get("buffers", ())))
    for i, view in enumerate(head.get("bufferViews", ())):
        if view.get("byteOffset", 0) + view["byteLength"] > sizes.get(view["buffer"], 0):
            raise ValueError(f"bufferViews[{i}] ends beyond its buffer; it is damaged")
    boxes, meshes = [], head.get("meshes", ())
    if any(node.get("mesh", 0) not in range(len(meshes)) for node in head["nodes"] if "mesh" in node):
        raise ValueError("a node of it has a mesh that is not there")
    for mesh in meshes:
        for part in mesh["primitives"]:
            points = head["accessors"][part["attributes"]["POSITION"]]
            corners = head["accessors"][part["indices"]] if "indices" in part else points
            plain = all("bufferView" in one and "sparse" not in one for one in (points, corners))
            plain &= points["componentType"] == _FLOAT
            if not plain or part.get("mode", _TRIANGLES) not in (_TRIANGLES, _STRIP):
                raise ValueError("its triangles are packed, in fans, or none; write plain ones")
            boxes.append([points["min"], points["max"]])
    if "EXT_mesh_gpu_instancing" in head.get("extensionsUsed", ()):
        raise ValueError("it repeats its parts by EXT_mesh_gpu_instancing; write each of them")
    scene = trimesh.load_scene(BytesIO(data), file_type="glb", skip_materials=True)
    solids = [part for part in scene.geometry.values() if isinstance(part, trimesh.Trimesh)]
    if any(part.faces.max(initial=0) >= len(part.vertices) for part in solids):
        raise ValueError("a corner of a triangle is no number of one of the vertices of its part")
    ends = [[part.vertices.min(axis=0), part.vertices.max(axis=0)] for part in scene.geometry.values()]
    notes = (
        () if np.allclose(ends, boxes, rtol=1e-5) else ("its points do not reach the ends that it states",)
    )
    mesh = scene.to_mesh()
    return Shape(np.array(mesh.vertices), np.full(len(mesh.faces), 3), mesh.faces.ravel(), "meter", notes)
