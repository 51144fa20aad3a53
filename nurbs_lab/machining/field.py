"""Heights of the resting tip over a grid, from which passes are laid out."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from nurbs_lab.machining.drop import Contact
from nurbs_lab.nurbs.tessellation import grid_triangles

MOST_NODES = 5e7
MOST_OF_TIPS = 5e6  # nodes of a field that is cut by planes, which takes 500 bytes a node


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
        Height of the tip, ``floor`` where there is no contact above the floor.
    floor : float
    at : (nx, ny, 2) array or None
        Places of the nodes if some are moved from the grid, by less than a step.
    """

    origin: np.ndarray
    step: float
    z: np.ndarray
    floor: float
    at: np.ndarray | None = None

    @property
    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """x and y of the nodes."""
        return tuple(self.origin[d] + self.step * np.arange(n) for d, n in enumerate(self.z.shape))

    @property
    def bounds(self) -> np.ndarray:
        """Of the nodes and their heights, ``(2, 3)``."""
        ends = self.origin + self.step * (np.array(self.z.shape) - 1)
        return np.array([[*self.origin, self.floor], [*ends, self.z.max()]])

    def places(self) -> np.ndarray:
        """x and y of every node, ``(nx ny, 2)``."""
        at = np.stack(np.meshgrid(*self.nodes, indexing="ij"), axis=-1) if self.at is None else self.at
        return at.reshape(-1, 2)

    def index(self, xy) -> tuple[np.ndarray, np.ndarray]:
        """The node nearest to each point."""
        nearest = np.rint((xy - self.origin) / self.step).astype(int)
        return tuple(np.clip(nearest[:, d], 0, n - 1) for d, n in enumerate(self.z.shape))

    @property
    def slope(self) -> np.ndarray:
        """Slope at each node in radians, from the nodes on both sides of it."""
        return np.arctan(np.hypot(*np.gradient(self.z, self.step)))

    def surface(self):
        """The triangles between the nodes, each cell cut from its first corner to its third."""
        points = np.column_stack([self.places(), self.z.ravel()])
        return trimesh.Trimesh(points, grid_triangles(*self.z.shape), process=False)


def tip_field(touch: Contact, step, floor, margin, wrong="scallop is too small for this part") -> TipField:
    """Drop the cutter on a grid over the part and ``margin`` around it."""
    low, high = touch.part.bounds[:, :2] + [[-margin] * 2, [margin] * 2]
    field = empty_field(low, high, step, floor, wrong, MOST_OF_TIPS)
    return replace(field, z=touch.heights(field.places(), floor).reshape(field.z.shape))


def empty_field(low, high, step, floor, wrong, most=MOST_NODES) -> TipField:
    """A field at its floor, over the rectangle from ``low`` to ``high``.

    ``wrong`` is the beginning of the error message for a field of more than ``most`` nodes.
    """
    counts = np.ceil((high - low) / step) + 1
    require_size(counts.prod(), most, wrong, "nodes of a grid")
    counts = counts.astype(int)
    return TipField(0.5 * (low + high) - 0.5 * step * (counts - 1), step, np.full(counts, floor), floor)


def require_size(size, most, wrong, what):
    """Refuse work that would take too long or too much memory."""
    if not size <= most:
        raise ValueError(f"{wrong}: it needs {size:.3g} {what}, at most {most:.3g} are possible")
