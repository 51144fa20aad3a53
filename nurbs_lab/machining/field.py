"""The heights of the resting tip over a grid: what passes are laid out on."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.machining.drop import Contact

MOST_NODES = 50_000_000


@dataclass(frozen=True, eq=False)
class TipField:
    """Heights of the tip at the nodes of a grid.

    Attributes
    ----------
    origin : (2,) array
        First node, in mm.
    step : float
        Between nodes, in mm.
    z : (nx, ny) array
        Height of the tip, ``floor`` where it meets nothing above it.
    floor : float
    gentle, steep : (nx, ny) array
        Slope of the surface of tips towards the less and the more steep sides of each node, in radians.
    """

    origin: np.ndarray
    step: float
    z: np.ndarray
    floor: float
    gentle: np.ndarray | None = None
    steep: np.ndarray | None = None

    @property
    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """x and y of the nodes."""
        return tuple(self.origin[d] + self.step * np.arange(n) for d, n in enumerate(self.z.shape))

    def index(self, xy) -> tuple[np.ndarray, np.ndarray]:
        """The node nearest to each point."""
        nearest = np.rint((xy - self.origin) / self.step).astype(int)
        return tuple(np.clip(nearest[:, d], 0, n - 1) for d, n in enumerate(self.z.shape))

    def surface(self):
        """The triangles between the nodes, each cell cut from its first corner to its third."""
        import trimesh

        x, y = np.meshgrid(*self.nodes, indexing="ij")
        index = np.arange(x.size).reshape(x.shape)
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        faces = [np.dstack(corners).reshape(-1, 3) for corners in ([a, b, c], [a, c, d])]
        points = np.column_stack([x.ravel(), y.ravel(), self.z.ravel()])
        return trimesh.Trimesh(points, np.concatenate(faces), process=False)


def tip_field(touch: Contact, step, floor, margin) -> TipField:
    """Drop the cutter on a grid over the part and ``margin`` around it."""
    low, high = touch.part.bounds[:, :2] + [[-margin] * 2, [margin] * 2]
    counts = np.ceil((high - low) / step).astype(int) + 1
    if counts.prod() > MOST_NODES:
        raise ValueError(
            f"scallop is too small for a part of this size: {counts.prod():.3g} places to look at; "
            f"at most {MOST_NODES:.0e} are possible"
        )
    origin = 0.5 * (low + high) - 0.5 * step * (counts - 1)
    x, y = (origin[d] + step * np.arange(counts[d]) for d in (0, 1))
    xy = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    z = np.maximum(touch.heights(xy), floor).reshape(counts)
    squares = [np.zeros(counts), np.zeros(counts)]
    for axis in (0, 1):
        rise = np.abs(np.diff(z, axis=axis)) / step
        pad = [(1, 1) if d == axis else (0, 0) for d in (0, 1)]
        both = np.pad(rise, pad, mode="edge")
        before, after = (both.take(range(k, k + counts[axis]), axis) for k in (0, 1))
        for square, side in zip(squares, (np.minimum, np.maximum), strict=True):
            square += side(before, after) ** 2
    gentle, steep = (np.arctan(np.sqrt(square)) for square in squares)
    return TipField(origin, step, z, floor, gentle, steep)
