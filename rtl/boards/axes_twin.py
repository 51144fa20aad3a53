"""Twin of axes.v: from points to steps of three axes, in integers."""

from itertools import pairwise

from nurbs_lab.hardware.arithmetic import checksum

#: Bits of a place below one step; bits of a scale that its product with a coordinate loses (axes.v).
STEP_BITS, SCALE_BITS = 10, 32
#: Least cycles from one step to the next, by the lengths of the pulses in colorlight_i5.v.
SPACING = 101
#: Outputs that are on only while the tool moves (axes.v).
ONLY_MOVING = 0b1000


def load_scale(steps_per_mm: float, point_fraction: int) -> int:
    """The register SCALE of an axis for coordinates of ``point_fraction`` fraction bits."""
    scale = round(steps_per_mm * 2.0 ** (STEP_BITS + SCALE_BITS - point_fraction))
    if not 0 < scale < 1 << 32:
        most = 2.0 ** (point_fraction - STEP_BITS)
        raise ValueError(
            f"steps_per_mm must be from {most * 2.0**-32:.3g} to {most:.3g} on a curve of this size, "
            f"got {steps_per_mm:g}"
        )
    return scale


def place_of(coordinate: int, scale: int) -> int:
    """A coordinate in steps, with ``STEP_BITS`` fraction bits."""
    return (coordinate * scale + (1 << SCALE_BITS - 1)) >> SCALE_BITS


def places_of(point, scales) -> tuple:
    return tuple(place_of(x, scale) for x, scale in zip(point, scales, strict=True))


def count_steps(points, scales) -> list[tuple]:
    """Steps of each axis from the first point to each point."""
    origin, half = places_of(points[0], scales), 1 << STEP_BITS - 1
    rows = [places_of(point, scales) for point in points]
    return [
        tuple((x - start + half) >> STEP_BITS for x, start in zip(row, origin, strict=True)) for row in rows
    ]


def largest_moves(program, scales) -> list[int]:
    """The most that an axis moves in one period at any rate, in 1/1024 of a step."""
    longest = max(bound for bounds in program.bounds() for which, bound in bounds if which == 7)
    return [(longest * scale >> SCALE_BITS) + 1 for scale in scales]


def outputs_on(outputs, points, scales) -> list[int]:
    """Outputs that are on while the tool moves to each point."""
    places = [places_of(point, scales) for point in points]
    moved = [False, *(a != b for a, b in pairwise(places))]
    return [bits if moves else bits & ~ONLY_MOVING for bits, moves in zip(outputs, moved, strict=True)]


def points_checksum(u, points, found=0) -> int:
    """The register CHECKSUM after these points."""
    values = (value for position, point in zip(u, points, strict=True) for value in (position, *point))
    return checksum((value ^ (value >> 32 & 0xFF) for value in values), found)
