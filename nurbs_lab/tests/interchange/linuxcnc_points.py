"""A program for Debian's own Python: the moves that LinuxCNC's interpreter makes of a file, as JSON.

Each is [line, kind, points]; arcs are sampled. The interpreter counts in inches.
"""

import json
import math
import sys

import gcode


class Canon:
    """What the interpreter calls for every move; calls of all other kinds are taken and forgotten."""

    parameter_file = "x.var"

    def __init__(self):
        self.moves, self.at, self.shift = [], (0.0, 0.0, 0.0), {"g5x": (0.0,) * 3, "g92": (0.0,) * 3}
        self.axes = (0, 1, 2)

    def __getattr__(self, name):
        return lambda *args: None

    def next_line(self, state):
        self.state = state

    def get_external_length_units(self):
        return 1.0

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7

    def get_block_delete(self):
        return False

    def check_abort(self):
        return False

    def get_tool(self, pocket):
        return (-1, *[0.0] * 12, 0)

    def set_g5x_offset(self, index, *offset):
        self.shift["g5x"] = offset[:3]

    def set_g92_offset(self, *offset):
        self.shift["g92"] = offset[:3]

    def set_plane(self, plane):
        self.axes = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}[plane]

    def add(self, kind, points):
        moved = [[sum(v) for v in zip(p, *self.shift.values(), strict=True)] for p in points]
        self.moves.append([self.state.sequence_number, kind, [[25.4 * x for x in p] for p in moved]])
        self.at = moved[-1]

    def straight_traverse(self, *end):
        self.add("rapid", [end[:3]])

    def straight_feed(self, *end):
        self.add("line", [end[:3]])

    def arc_feed(self, x, y, cx, cy, turns, z, *others):
        at = [a - b - c for a, b, c in zip(self.at, *self.shift.values(), strict=True)]
        x0, y0, z0 = (at[i] for i in self.axes)
        first = math.atan2(y0 - cy, x0 - cx)
        turn = math.atan2(y - cy, x - cx) - first
        sense = 1 if turns > 0 else -1
        turn = sense * ((sense * turn - 1e-9) % (2 * math.pi) + 1e-9 + 2 * math.pi * (abs(turns) - 1))
        radius = math.hypot(x0 - cx, y0 - cy)
        points = []
        for i in range(1, 17):
            angle = first + turn * i / 16
            point = cx + radius * math.cos(angle), cy + radius * math.sin(angle), z0 + (z - z0) * i / 16
            points.append([point[self.axes.index(k)] for k in range(3)])
        self.add("arc", points)


canon = Canon()
result, line = gcode.parse(sys.argv[1], canon, "G21", "")
if result > gcode.MIN_ERROR:
    sys.exit(f"line {line}: {gcode.strerror(result)}")
json.dump(canon.moves, sys.stdout)
