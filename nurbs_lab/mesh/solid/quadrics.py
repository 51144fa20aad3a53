"""Planes, cylinders, cones, spheres and tori: distances, normals, and least-squares fits to points.

Directions of first guesses come from facets: the line through the centre of the circle around a facet, along
its normal, passes through the axis of every surface of revolution whose facets are trapezoids of two rings.
"""

from dataclasses import dataclass, replace

import numpy as np

_STEPS = 12  # of Gauss and Newton at most
ON = 1e-5  # lengths of the part: vertices so near to a surface lie on it
_FAR = 1e-3  # from the surface after three steps, in lengths of the part: the search is given up
_TOLD = 3e-7  # of the largest singular value: numbers of a surface that points tell less about stay
SAME = 2e-6  # lengths of the part: planes, sizes and sines of angles that differ by less are one
_LARGEST = 20.0  # radius in lengths of the part: larger ones are planes
_ANGLES = np.radians((0.5, 89.5))  # half angles of cones
_CROSS = np.cross(np.eye(3)[:, None], np.eye(3)).reshape(3, 9)  # the vector product, as a matrix


@dataclass(frozen=True)
class Quadric:
    """One surface. ``radius`` is that of the tube of a torus, ``other`` its large one or a half angle.

    The normals, times ``sign``, point out of the material.
    """

    kind: str
    point: np.ndarray
    axis: np.ndarray
    radius: float = 0.0
    other: float = 0.0
    sign: float = 1.0

    def distances_and_normals(self, points):
        """Signed distances ``(n,)`` of points, and unit normals ``(n, 3)`` that point to growing distance."""
        at = points - self.point
        if self.kind == "plane":
            return at @ self.axis, np.broadcast_to(self.axis, at.shape)
        if self.kind == "sphere":
            size = np.linalg.norm(at, axis=-1)
            return size - self.radius, at / np.maximum(size, 1e-300)[..., None]
        height = at @ self.axis
        across = at - height[..., None] * self.axis
        rho = np.linalg.norm(across, axis=-1)
        across = across / np.maximum(rho, 1e-6)[..., None]  # shorter at an apex, which has no normal
        if self.kind == "cylinder":
            return rho - self.radius, across
        if self.kind == "cone":
            cosine, sine = np.cos(self.other), np.sin(self.other)
            return rho * cosine - height * sine, across * cosine - sine * self.axis
        size = np.maximum(np.hypot(rho - self.other, height), 1e-300)
        normals = ((rho - self.other) / size)[..., None] * across + (height / size)[..., None] * self.axis
        return size - self.radius, normals

    def distances(self, points):
        """Signed distances ``(n,)``."""
        return self.distances_and_normals(points)[0]

    def distances_and_slopes(self, points):
        """Signed distances ``(n,)``, and their derivatives by those numbers of `moved` that its kind has."""
        at, (gaps, normals) = points - self.point, self.distances_and_normals(points)
        e, f = across(self.axis)
        height = at @ self.axis
        aside = at - height[:, None] * self.axis
        rho = np.maximum(np.linalg.norm(aside, axis=1), 1e-300)
        if self.kind == "cone":
            other = -rho * np.sin(self.other) - height * np.cos(self.other)
        else:
            other = -np.einsum("ij,ij->i", normals, aside) / rho
        turns = np.cross(normals, at) @ np.column_stack([f, -e])
        slopes = np.column_stack([-normals, turns, np.full(len(at), -1.0), other])
        return gaps, slopes[:, ROUND[self.kind]]

    def moved(self, x):
        """The surface with its point, axis and sizes changed by (3, 2, 1, 1) numbers."""
        axis = self.axis + np.stack(across(self.axis), axis=1) @ x[3:5]
        sizes = {"radius": self.radius + x[5], "other": self.other + x[6]}
        return replace(self, point=self.point + x[:3], axis=axis / np.linalg.norm(axis), **sizes)

    def scaled(self, size, centre):
        """The same, larger by a factor and then moved."""
        other = self.other if self.kind == "cone" else self.other * size
        return replace(self, point=self.point * size + centre, radius=self.radius * size, other=other)

    def sound(self) -> bool:
        """Whether the sizes are those of a surface of its kind; a fillet may be the outside of a spindle."""
        if self.kind == "cone":
            return bool(_ANGLES[0] < self.other < _ANGLES[1])
        if self.kind == "torus":
            return bool(0.0 < self.radius < _LARGEST * self.other < _LARGEST**2)
        return bool(self.kind == "plane" or 0.0 < self.radius < _LARGEST)


#: Which of the seven numbers of `Quadric.moved` each round kind has, simplest first.
ROUND = {
    "cylinder": [0, 1, 2, 3, 4, 5],
    "sphere": [0, 1, 2, 5],
    "cone": [0, 1, 2, 3, 4, 6],
    "torus": [0, 1, 2, 3, 4, 5, 6],
}


def across(axis):
    """Two unit vectors that make a right-handed frame with a unit vector, which is the third."""
    turn = (axis @ _CROSS).reshape(3, 3)
    e = turn[np.abs(axis).argmin()]
    e = e / np.linalg.norm(e)
    return e, e @ turn


def fit(kind, points, places, normals, weights):
    """The surface of a kind nearest to points; facets ``places, normals, weights`` give the first guess.

    Returns None if there is none.
    """
    if len(points) < len(ROUND.get(kind, ())):
        return None
    with np.errstate(all="ignore"):
        try:
            for first in _guesses(kind, points, places, normals, weights):
                found = first if kind in ("plane", "sphere") else improved(first, points)
                if found is not None and found.sound():
                    return found
        except np.linalg.LinAlgError:
            pass
    return None


def improved(quadric, points):
    """Gauss-Newton on the distances; None where it goes astray.

    What the points hardly tell stays as it was guessed: in a file of single precision they are off by 1e-7.
    Nor are more steps made where points are not on a surface that can hardly come nearer to them.
    """
    free = ROUND[quadric.kind]
    for step in range(_STEPS):
        gaps, slopes = quadric.distances_and_slopes(points)
        if not np.isfinite(slopes).all() or (step > 3 and np.abs(gaps).max() > _FAR):
            return None
        x = np.zeros(7)
        x[free] = np.linalg.lstsq(slopes, -gaps, rcond=_TOLD)[0]
        if not np.abs(x).max() < 1.0:  # far away
            return None
        quadric = quadric.moved(x)
        vain = np.linalg.norm(gaps + slopes @ x[free]) > 0.99 * np.linalg.norm(gaps)
        if np.abs(x).max() < 1e-13 or (vain and np.abs(gaps).max() > ON):
            break
    return quadric


def _guesses(kind, points, places, normals, weights):
    """A plane or a sphere by least squares; guesses of the others from the directions of facets.

    Of cones there are two, the nearer one first: the planes of narrow facets hardly tell the axis, and the
    normals of a single ring of facets all meet in one point of it.
    """
    centre = points.mean(axis=0)
    if kind == "plane":
        axis = np.linalg.svd(points - centre, full_matrices=False)[2][2]
        return [Quadric("plane", centre, axis if axis @ (weights @ normals) > 0.0 else -axis)]
    if kind == "sphere":
        return [Quadric("sphere", *_round_through(points))]
    mean = weights @ normals / weights.sum()
    spread = normals - (mean if kind == "cone" else 0.0)
    even = np.linalg.eigh((spread * weights[:, None]).T @ spread)[1][:, 0]
    if kind == "cylinder":
        frame = np.stack(across(even))
        middle, _, radius = _round_through(points @ frame.T)
        return [Quadric(kind, middle @ frame + (centre @ even) * even, even, radius)]
    foot, axis = _turned_about(places, normals, weights)
    height = (points - foot) @ axis
    rho = np.linalg.norm(points - foot - height[:, None] * axis, axis=1)
    if kind == "torus":
        (major, middle), _, radius = _round_through(np.column_stack([rho, height]))
        return [Quadric(kind, foot + middle * axis, axis, radius, float(major))]
    away = height - height.mean()
    slope = (away @ rho) / (away @ away)
    apex = foot + (height.mean() - rho.mean() / slope) * axis
    turned = Quadric(kind, apex, np.sign(slope) * axis, 0.0, float(np.arctan(abs(slope))))
    apex = np.linalg.lstsq(normals, np.einsum("ij,ij->i", normals, places), rcond=1e-9)[0]
    even = even if even @ (centre - apex) > 0.0 else -even
    touched = Quadric(kind, apex, even, 0.0, float(np.arcsin(np.clip(abs(mean @ even), 0.0, 1.0))))
    return sorted([touched, turned], key=lambda one: np.abs(one.distances(points)).max())


def _turned_about(places, normals, weights):
    """A point and the direction of the line that passes nearest to the normals of facets at places."""
    rows = np.concatenate([np.cross(places, normals), normals], axis=1) * np.sqrt(weights)[:, None]
    full = rows.T @ rows
    join = np.linalg.pinv(full[3:, 3:], rcond=1e-9) @ full[3:, :3]
    axis = np.linalg.eigh(full[:3, :3] - full[:3, 3:] @ join)[1][:, 0]
    return np.cross(axis, -join @ axis), axis


def _round_through(points):
    """The circle or sphere nearest to points, linear in its squared form: centre, an axis, and radius."""
    centre = points.mean(axis=0)
    at = points - centre
    rows = np.column_stack([2.0 * at, np.ones(len(at))])
    x = np.linalg.lstsq(rows, (at**2).sum(axis=1), rcond=1e-12)[0]
    return centre + x[:-1], np.array([0.0, 0.0, 1.0]), float(np.sqrt(max(x[-1] + x[:-1] @ x[:-1], 0.0)))


def made_equal(surfaces):
    """Surfaces whose axes, radii, angles and lines of axes agree within a limit, with equal ones.

    Those of earlier surfaces stand. The second result is the largest change of each surface, 0 for most.
    """
    out = []
    for one in surfaces:
        for other in out:
            axis = np.sign(one.axis @ other.axis) * other.axis
            beside = one.point - other.point
            beside = beside - (beside @ axis) * axis
            if np.linalg.norm(one.axis - axis) < SAME:
                one = replace(one, axis=axis)
                if np.linalg.norm(beside) < SAME and "plane" not in (one.kind, other.kind):
                    one = replace(one, point=one.point - beside)
            if abs(one.radius - other.radius) < SAME:
                one = replace(one, radius=other.radius)
            if one.kind == other.kind and abs(one.other - other.other) < SAME:
                one = replace(one, other=other.other)
        out.append(one)
    rows = [np.array([(*q.point, *q.axis, q.radius, q.other) for q in some]) for some in (surfaces, out)]
    return out, np.abs(rows[1] - rows[0]).max(axis=1)


def circumcentres(corners):
    """Centres and unit axes of the circles through three points each, ``(..., 3, 3)``."""
    a, b = (corners[..., k, :] - corners[..., 0, :] for k in (1, 2))
    normal = np.cross(a, b)
    square = np.maximum((normal**2).sum(axis=-1, keepdims=True), 1e-300)
    up = np.cross(normal, a) * (b**2).sum(axis=-1, keepdims=True)
    up += np.cross(b, normal) * (a**2).sum(axis=-1, keepdims=True)
    return corners[..., 0, :] + up / (2.0 * square), normal / np.sqrt(square)
