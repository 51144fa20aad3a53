"""Random programs beside where they go: a machine that writes its blocks while it moves, and reads nothing.

Every coordinate is spelt in one of several ways (digits, expressions, parameters), in mm or inches, absolute
or relative, behind shifts of the origin; the points come from closed forms in the machine's coordinates.
"""

import numpy as np
from scipy.interpolate import BSpline

PLANES = {"G17": (0, 1, 2), "G18": (2, 0, 1), "G19": (1, 2, 0)}
HEAD = "G21 G90 G94 G17 G91.1\nG0 X0 Y0 Z0\nF600 S300 M3\no<leg> sub\nG1 X[#1 * 2] Y[0 - #2]\no<leg> endsub"
PLUNGE_MM = 0.254  # above the last depth, where the next peck of G73 and G83 begins


class Machine:
    """Its ``text``, and ``moves`` as (kind, points, feed in mm/s)."""

    def __init__(self, seed, blocks=60):
        self.rng = np.random.default_rng(seed)
        self.at, self.lines, self.moves = np.zeros(3), [HEAD], []
        self.scale, self.relative, self.plane, self.names = 1.0, False, "G17", 0
        self.g54, self.g92 = np.zeros((2, 3))
        kinds = self.line, self.arc, self.drill, self.polar, self.flow, self.spline, self.by_time, self.state
        for kind in self.rng.choice(len(kinds), blocks, p=[0.2, 0.25, 0.1, 0.05, 0.1, 0.05, 0.05, 0.2]):
            kinds[kind]()
        self.text = "\n".join([*self.lines, "M2", ""])

    def go(self, end, kind="cut", feed=10.0):
        if np.abs(end - self.at).max() > 1e-9:
            self.moves.append((kind, np.array([self.at, end]), feed if kind == "cut" else None))
        self.at = np.array(end)

    def along(self, points):
        self.moves.append(("cut", points, 10.0))
        self.at = points[-1]

    def spelt(self, mm):
        value, kind, part = mm / self.scale, self.rng.integers(6), round(self.rng.uniform(-9, 9), 3)
        if kind == 0:
            return f"[{value - part:.10f} + {part}]"
        if kind == 1:
            self.names = self.names % 9 + 1
            self.lines.append(f"#{40 + self.names}={value / 2:.11f}")
            return f"[#{40 + self.names} * 2]"
        return f"{value:.10f}"

    def words(self, end, axes=(0, 1, 2), letters="XYZ"):
        origin = self.at if self.relative else self.g54 + self.g92
        return " ".join(f"{letters[i]}{self.spelt(end[i] - origin[i])}" for i in axes)

    def somewhere(self, axes=(0, 1, 2)):
        end = self.at.copy()
        end[list(axes)] = self.rng.uniform(-30, 30, len(axes))
        return end

    def line(self):
        axes = np.flatnonzero(self.rng.random(3) < 0.6)
        end, kind = self.somewhere(axes), self.rng.integers(2)
        words = self.words(end, axes)
        self.lines.append(f"{'g1' if kind else 'G00'} {words} (to there) G64 P0.05")
        self.go(end, "cut" if kind else "rapid")

    def arc(self):
        a, b, c = PLANES[self.plane]
        radius, first, whole = self.rng.uniform(1, 20), self.rng.uniform(0, 6), self.rng.random() < 0.2
        turn = self.rng.choice([-1, 1]) * (2 * np.pi if whole else self.rng.uniform(0.2, 6))
        more, rise = self.rng.choice([0, 1], p=[0.8, 0.2]), self.rng.choice([0, self.rng.uniform(-9, 9)])
        part = np.linspace(0, 1, 25)
        angle = first + (turn + np.sign(turn) * more * 2 * np.pi) * part
        points = np.tile(self.at, (25, 1))
        points[:, a] += radius * (np.cos(angle) - np.cos(first))
        points[:, b] += radius * (np.sin(angle) - np.sin(first))
        points[:, c] += rise * part
        around = f"P{1 + more} " if more else ""
        if not whole and not more and abs(abs(turn) - np.pi) > 0.3 and self.rng.random() < 0.4:
            around += f"R{self.spelt(radius if abs(turn) < np.pi else -radius)}"
        else:
            for i, offset in ((a, -radius * np.cos(first)), (b, -radius * np.sin(first))):
                around += f"{'IJK'[i]}{self.spelt(offset)} "
        axes = (a, b, c) if rise else (a, b)
        self.lines.append(f"G{3 if turn > 0 else 2} {self.words(points[-1], axes)} {around}")
        self.along(points)

    def drill(self):
        a, b, c = PLANES[self.plane]
        code, back = self.rng.choice([81, 82, 83, 73, 85]), self.rng.choice(["G98", "G99"])
        top, depth, step = self.at[c] + self.rng.uniform(-4, 3), *self.rng.uniform(1, 5, 2)
        level, bottom = max(self.at[c], top) if back == "G98" else top, top - depth
        origin = self.at if self.relative else self.g54 + self.g92
        height = f"R{self.spelt(top - origin[c])} "
        height += (
            f"{'XYZ'[c]}{self.spelt(-depth if self.relative else bottom - origin[c])} Q{self.spelt(step)} "
        )
        words = f"{back} G{code} {height if code in (73, 83) else height[: height.index('Q')]}"
        words += "P0.1 " if code == 82 else ""
        times = 2 if self.relative else 1
        for _ in range(1 if self.relative else 2):
            place = self.somewhere((a, b))
            self.lines.append(f"{words}{self.words(place, (a, b))} " + f"L{times}" * (times > 1))
            words, move = "", place - self.at
            for _ in range(times):
                place = self.at + move
                self.hole(c, place, (level, top, bottom), step, code)
        self.lines.append("G80")

    def hole(self, c, place, heights, step, code):
        def to(height, kind="rapid"):
            self.go(np.where(np.arange(3) == c, height, self.at), kind)

        level, top, bottom = heights
        to(max(self.at[c], top))
        self.go(np.where(np.arange(3) == c, self.at[c], place), "rapid")
        to(top)
        depth = top - step
        while code in (73, 83) and depth > bottom:
            to(depth, "cut")
            if code == 83:
                to(top)
            to(depth + PLUNGE_MM)
            depth -= step
        to(bottom, "cut")
        if code == 85:
            to(top, "cut")
        to(level)

    def polar(self):
        if self.plane == "G17" and not self.relative:
            radius, angle, end = self.rng.uniform(1, 20), self.rng.uniform(-180, 180), self.at.copy()
            turn = np.radians(angle)
            end[:2] = (self.g54 + self.g92)[:2]
            end[:2] += radius * np.array([np.cos(turn), np.sin(turn)])
            self.lines.append(f"G1 @{self.spelt(radius)} ^{angle:.10f}")
            self.go(end)

    def flow(self):
        name, step = 100 + len(self.lines), self.rng.uniform(1, 5, 2)
        if self.relative:
            words = self.words(self.at + np.r_[step, 0], (0, 1))
            self.lines += [f"o{name} repeat [3]", f"G1 {words}", f"o{name} endrepeat"]
            for _ in range(3):
                self.go(self.at + np.r_[step, 0])
        elif self.rng.random() < 0.5:
            value, end = self.rng.integers(4), self.somewhere((0, 1))
            words = self.words(end, (0, 1))
            self.lines += [f"#1={value}", f"o{name} if [#1 eq 2 or #1 gt 2]", f"G1 {words}", f"o{name} endif"]
            if value >= 2:
                self.go(end)
        else:
            end, (x, y, _) = self.somewhere((0, 1)), self.g54 + self.g92
            first, second = (end[0] - x) / self.scale / 2, (y - end[1]) / self.scale
            self.lines.append(f"o<leg> call [{first:.11f}] [{second:.10f}]")
            self.go(end)

    def spline(self):
        if self.plane != "G17" or self.relative:
            return
        place = self.somewhere()  # Debian's module for Python draws splines at the height of the last line
        self.lines.append(f"G1 {self.words(place)}")
        self.go(place)
        ends, inner = [self.somewhere((0, 1)) for _ in range(5)], np.linspace(0, 1, 25)
        if self.rng.random() < 0.5:
            one, two, end = ends[:3]
            offsets = zip("IJPQ", [*(one - self.at)[:2], *(two - end)[:2]], strict=True)
            words = " ".join(f"{letter}{self.spelt(value)}" for letter, value in offsets)
            self.lines.append(f"G5 {words} {self.words(end, (0, 1))}")
            self.along(BSpline([0] * 4 + [1] * 4, [self.at, one, two, end], 3)(inner))
        else:
            weights = [1.0, *self.rng.uniform(0.5, 2, 5).round(3)]
            rows = [f"{self.words(end, (0, 1))} P{w}" for end, w in zip(ends, weights[1:], strict=True)]
            self.lines += [f"G5.2 {rows[0]} L4", *rows[1:], "G5.3"]
            knots, points = [0] * 4 + [1, 2] + [3] * 4, np.array([self.at, *ends])
            rational = BSpline(knots, np.column_stack([points * np.c_[weights], weights]), 3)(3 * inner)
            self.along(rational[:, :3] / rational[:, 3:])

    def by_time(self):
        end = self.somewhere()
        words, minutes = self.words(end), self.rng.uniform(0.01, 1)
        self.lines += [
            f"G93 G1 {words} F{1 / minutes:.10f}",
            "G94 F600" if self.scale == 1 else "G94 G21 F600",
        ]
        self.scale = 1.0
        self.go(end, feed=np.linalg.norm(end - self.at) / minutes / 60)

    def state(self):
        kind = self.rng.integers(6)
        if kind == 0:
            self.relative = not self.relative
            self.lines.append("G91" if self.relative else "G90")
        elif kind == 1:
            self.scale = 26.4 - self.scale
            self.lines.append("G20" if self.scale > 1 else "G21")
        elif kind in (2, 3):
            self.plane = self.rng.choice(list(PLANES))
            self.lines.append(self.plane)
        elif kind == 4:
            values = self.rng.uniform(-20, 20, 3).round(3)
            self.g92 = self.at - self.g54 - values * self.scale
            self.lines.append("G92 X{} Y{} Z{}".format(*values))
        else:
            values = self.rng.uniform(-20, 20, 3).round(3)
            self.g54 = values * self.scale
            self.relative, place = False, self.somewhere()  # LinuxCNC's interpreter forgets where it is
            self.lines += ["G10 L2 P1 X{} Y{} Z{} G90".format(*values), f"G0 {self.words(place)}"]
            self.go(place, "rapid")
