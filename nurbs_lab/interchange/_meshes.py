"""Triangle meshes and clouds of points: STL, OBJ and PLY."""

import numpy as np
import trimesh

from nurbs_lab.mesh.mesh_files import ply_counts
from nurbs_lab.mesh.mesh_input import arrays_of


def read(path):
    if path.suffix.lower() == ".ply" and not ply_counts(path.read_bytes()).get("face"):
        return trimesh.load(path).vertices.view(np.ndarray)
    return trimesh.Trimesh(*arrays_of(path), process=False)
