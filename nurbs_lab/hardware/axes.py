"""Twin of rtl/boards/axes.v: from points to steps of three axes, in integers."""

from itertools import pairwise

#: Bits of a place below one step; bits of a scale that its product with a coordinate loses.
STEP_BITS, SCALE_BITS = 10, 32
#: Least cycles from one step to the next, by the lengths of the pulses in rtl/boards/colorlight_i5.v.
SPACING = 101


def load_scale(steps_per_mm: float, point_fraction: int) -> int:
    """The register SCALE of an axis for coordinates of ``point_fraction`` fraction bits.

    Raises
    ------
    ValueError
        If the register cannot hold it.
    """
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


def count_steps(points, scales) -> list[tuple]:
    """Steps of each axis from the first point to each point."""
    origin = [place_of(x, scale) for x, scale in zip(points[0], scales, strict=True)]
    half = 1 << STEP_BITS - 1
    return [
        tuple(
            (place_of(x, scale) - start + half) >> STEP_BITS
            for x, scale, start in zip(point, scales, origin, strict=True)
        )
        for point in points
    ]


def largest_move(points, scales) -> float:
    """The most steps that an axis has to take in one period."""
    places = [[place_of(x, scale) for x, scale in zip(point, scales, strict=True)] for point in points]
    moves = (abs(b - a) for rows in pairwise(places) for a, b in zip(*rows, strict=True))
    return max(moves, default=0) / (1 << STEP_BITS)


def points_checksum(u, points) -> int:
    """The register CHECKSUM after these points."""
    checksum, mask = 0, 0xFFFFFFFF
    for row in zip(u, points, strict=True):
        for value in (row[0], *row[1]):
            checksum = (checksum << 1 & mask) | checksum >> 31
            checksum ^= value & mask ^ (value >> 32 & 0xFF)
    return checksum
