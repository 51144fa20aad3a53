"""What the work must do at least, counted by hand from the formulas, for `benchmarks.limits`.

Only what no order of the loops can save is counted: every array once for each pass that must stream through
it, no search, no test, no second visit that finds its data in the cache. `test_counts.py` counts again, by
numbers that notice what is done with them and by the sizes of the arrays.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from benchmarks.harness import medians


def curve_points(count: int, degree: int) -> dict[str, float]:
    """u read and a point in space written; the local parameter and three Horner sums."""
    return {"bytes": 32.0 * count, "operations": count * (1.0 + 6.0 * degree)}


def surface_points(count: int, degree: int) -> dict[str, float]:
    """A rational grid: a point in space written; four Horner sums along v (those along u serve a whole row,
    the local parameter a whole column), a division, three products."""
    return {"bytes": 24.0 * count, "operations": count * (8.0 * degree + 4.0)}


def steps(name: str, count: int, degree: int) -> dict[str, float]:
    """From one u to the next: 8 bytes; all operations; those of them that wait for one another.

    Without weights, at constant speed, each operation as early as its operands are there. A point: the local
    parameter (3), then a Horner sum, 2 operations a degree, in x, y and z; a distance adds 4 and a square
    root. The chain of each rule:

    - paper: point, distance, two quotients, the Adams sum (6);
    - chord-corrected: three levels of Neville's scheme (each 3 and a division), then twice point, distance
      and inverse interpolation (of two nodes 2 and a division, of three 5 and two).
    """
    horner = 2 * degree
    operations, chained, roots = {
        "paper": (24 + 3 * horner, 13 + horner, 3),
        "chord-corrected": (74 + 9 * horner, 30 + 2 * horner, 8),
    }[name]
    least = {"bytes": 8, "operations": operations, "chained": chained, "roots": roots}
    return {what: float(count * each) for what, each in least.items()}


def slices(graph, layers) -> dict[str, float]:
    """Slicing with the graph at hand, and the time of its bare walk.

    A vertex is read and its level written and read (32 bytes). A triangle and its flag are read, its mark is
    set (17). A segment is listed and found (8), marked (8), and reads its triangle, one twin and one new
    vertex (40); point and carrier are written (20). Its point costs 9 operations, the area 5.
    """
    contours = [contour for layer in layers for contour in layer.contours]
    carriers = np.concatenate([contour.triangles for contour in contours])
    table = np.zeros((len(graph.triangles), 3), np.int32)
    seconds, _ = medians({"walk": lambda: _follow(carriers, table)}, repeats=5)
    return {
        "bytes": 32.0 * len(graph.vertices) + 17.0 * len(graph.triangles) + 76.0 * len(carriers),
        "operations": 14.0 * len(carriers),
        "walk_s": seconds["walk"],
    }


def building(graph) -> dict[str, float]:
    """Building the graph of a mesh whose vertices are distinct, and the time of its bare sort.

    A vertex is read and written, and its number written (52 bytes; no search for its equal is counted). A
    triangle is read as trimesh has it (24), written with its flag (13), and read again by each sort and by
    the comparison of sorted neighbours (36). Its three half-edges are written and read by each of two sorts
    (48), and each has its twin and kind written (15). No operation on floating-point numbers.
    """
    first, second, order = sorted_places(graph)
    into, table = np.empty_like(order), np.zeros((len(graph.triangles), 3), np.int32)
    seconds, _ = medians({"sort": lambda: _sort(first, second, order, into, table)}, repeats=5)
    return {
        "bytes": 52.0 * len(graph.vertices) + 136.0 * len(graph.triangles),
        "operations": 0.0,
        "walk_s": seconds["sort"],
    }


def sorted_places(graph):
    """Where two stable sorts put the half-edges: by the higher vertex, then by the lower; and the result."""
    ends = graph.triangles[:, [(0, 1), (0, 2), (1, 2)]].reshape(-1, 2)
    by_higher = np.argsort(ends.max(axis=1), kind="stable")
    then = np.argsort(ends.min(axis=1)[by_higher], kind="stable")
    places = [np.empty(len(ends), np.int32) for _ in range(2)]
    for place, order in zip(places, (by_higher, then), strict=True):
        place[order] = np.arange(len(ends))
    return *places, by_higher[then].astype(np.int32)


@njit
def _follow(carriers, table):
    """Read the rows of the table in the order of the contours, each only when the one before has come."""
    ahead = 0  # as the table holds zeros: but the processor cannot know
    for f in carriers:
        ahead = table[f + ahead, 0]
    return ahead


@njit
def _sort(first, second, order, into, table):
    """Write the half-edges where the two sorts put them, then read their triangles in the sorted order."""
    for places in (first, second):
        for half in range(places.size):
            into[places[half]] = half
    total = 0
    for half in order:
        total += table[half // 3, 0]
    return total
