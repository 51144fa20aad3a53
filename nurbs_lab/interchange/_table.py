"""A tool path as comma-separated values: one row a period.

``t`` in s, ``u``, ``x``, ``y``, ``z`` in mm, and ``v`` in mm/s, the mean speed by chord of the period that
ends in the row (0 in the first).
"""

import numpy as np

HOLDS = ("paths",)


def write(path, parts):
    if len(parts.paths) != 1:
        raise ValueError(f"a .csv file holds one tool path, got {len(parts.paths)}; write one file each")
    (tool_path,) = parts.paths
    points = np.asarray(tool_path.points)
    v = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(tool_path.t)]
    axes = list("xyz")[: points.shape[1]]
    table = np.column_stack([tool_path.t, tool_path.u, points, v])
    np.savetxt(path, table, delimiter=",", fmt="%.17g", header=",".join(["t", "u", *axes, "v"]), comments="")
