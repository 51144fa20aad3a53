"""The least work of `benchmarks.counts`, beside kernels run on numbers that count what is done to them."""

import math
from functools import reduce
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from numba.core.dispatcher import Dispatcher

import nurbs_lab as nl
from benchmarks import counts
from nurbs_lab.mesh import _kernels_graph as builder
from nurbs_lab.mesh import mesh_graph, slice_mesh
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.feed import constant_feed
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.steppers import adams, corrected, one_step
from nurbs_lab.nurbs import span_kernels

#: A division or square root takes about as long as so many additions, one after the other.
ROOT = 5


class Counted:
    """A number that knows how many operations, one after the other, it waited for: (plain ones, roots)."""

    __array_ufunc__ = None  # so that NumPy's floats leave the work to it
    operations = 0

    def __init__(self, value, chain=(0, 0)):
        self.value, self.chain = float(value), chain

    def _after(self, other, value, root=0):
        Counted.operations += 1
        chains = [self.chain, getattr(other, "chain", (0, 0))]
        plain, roots = max(chains, key=lambda chain: chain[0] + ROOT * chain[1])
        return Counted(value, (plain + 1 - root, roots + root))

    def __float__(self):
        return self.value

    def __abs__(self):
        return Counted(abs(self.value), self.chain)

    def __add__(self, other):
        idle = not isinstance(other, Counted) and other == 0.0
        return self if idle else self._after(other, self.value + float(other))

    def __sub__(self, other):
        return self._after(other, self.value - float(other))

    def __rsub__(self, other):
        return self._after(other, float(other) - self.value)

    def __mul__(self, other):
        idle = not isinstance(other, Counted) and other == 1.0
        return self if idle else self._after(other, self.value * float(other))

    def __truediv__(self, other):
        return self._after(other, self.value / float(other), 1)

    def __rtruediv__(self, other):
        return self._after(other, float(other) / self.value, 1)

    def __pow__(self, other):
        return self._after(other, self.value**other)

    __radd__, __rmul__ = __add__, __mul__

    def __lt__(self, other):
        return self.value < float(other)

    def __le__(self, other):
        return self.value <= float(other)

    def __gt__(self, other):
        return self.value > float(other)

    def __ge__(self, other):
        return self.value >= float(other)

    def __eq__(self, other):
        return self.value == float(other)

    __hash__ = None


class Watched(np.ndarray):
    """An array that notes the operations done before each of its elements was set."""

    def __array_finalize__(self, other):
        self.operations = []

    def __setitem__(self, key, value):
        self.operations.append(Counted.operations)
        super().__setitem__(key, value)


def square_root(x):
    """Of a number that counts, or of a plain one."""
    return x._after(0.0, math.sqrt(x.value), 1) if isinstance(x, Counted) else math.sqrt(x)


def as_plain_python(monkeypatch, *modules, **names):
    """Kernels as plain Python, and other names, in these modules."""
    for module in modules:
        for name, value in list(vars(module).items()):
            if isinstance(value, Dispatcher):
                monkeypatch.setattr(module, name, value.py_func)
        for name, value in names.items():
            if hasattr(module, name):
                monkeypatch.setattr(module, name, value)


POINTS = np.array([(0, 0.1, 0.2), (1, 2.3, -0.4), (2.2, 1.7, 0.9), (3.1, 3.3, 1.6)])
KERNELS = {
    "paper": (adams, "_quotients", lambda: (np.zeros(6, object), adams.MENDED, 4)),
    "chord-corrected": (corrected, "_chord", lambda: (np.zeros(3), 2, 0.0)),
}


@pytest.mark.parametrize("degree", [2, 3])
@pytest.mark.parametrize("name", KERNELS)
def test_a_step_does_what_its_kernel_does(name, degree, monkeypatch):
    module, kernel, options = KERNELS[name]
    track = prepare(nl.NurbsCurve(degree, [0] * (degree + 1) + [1] * (degree + 1), POINTS[: degree + 1]))
    period = track.length / 40
    feed = constant_feed(track.length, 1.0, period).table
    numpy = SimpleNamespace(
        empty=lambda shape: np.empty(shape, object), isfinite=lambda x: math.isfinite(float(x)), inf=math.inf
    )
    as_plain_python(
        monkeypatch, _kernels, span_kernels, adams, corrected, one_step, np=numpy, sqrt=square_root
    )
    u = np.empty(41, object).view(Watched)
    u[0] = Counted(0)
    getattr(module, kernel)(track.spans, feed, period, 0, 20, u, np.zeros(4, np.int64), *options())
    chained, roots = np.diff([value.chain for value in u[10:21]], axis=0).T
    least = counts.steps(name, 1, degree)
    assert np.diff(u.operations[10:]).tolist() == [least["operations"]] * 10
    assert set(chained) == {least["chained"]}
    assert set(roots) == {least["roots"]}


def test_a_point_costs_its_horner_sums():
    u, rows = Counted(0.3), np.random.default_rng(0).normal(size=(4, 4))
    before = Counted.operations
    local = u - 0.25
    for row in rows[:3]:
        reduce(lambda total, factor: total * local + factor, row[1:], Counted(row[0]))
    assert Counted.operations - before == counts.curve_points(1, 3)["operations"]
    before = Counted.operations
    weight, *xyz = (
        reduce(lambda total, factor: total * u + factor, row[1:], Counted(row[0])) for row in rows
    )
    inverse = 1.0 / weight
    assert len([inverse * x for x in xyz]) == 3
    assert Counted.operations - before == counts.surface_points(1, 3)["operations"]


def test_slicing_a_box_moves_what_its_arrays_hold():
    box = trimesh.creation.box()
    graph = mesh_graph(box)
    layers = slice_mesh(graph, [0.0])
    level = mark = carrier = listed = 4
    segment = (
        2 * listed + 2 * mark + graph.triangles[0].nbytes + graph.twins[0].nbytes + 3 * 8 + 2 * 8 + carrier
    )
    once = graph.vertices.nbytes + 8 * 2 * level + graph.triangles.nbytes + graph.junk.nbytes + 12 * mark
    least = counts.slices(graph, layers)
    assert least["bytes"] == once + 8 * segment  # the four sides have two triangles each
    assert least["walk_s"] > 0.0


def test_building_the_graph_of_a_box_moves_what_its_arrays_hold():
    box = trimesh.creation.box()
    graph = mesh_graph(box)
    number = half_edge = 4
    vertices = box.vertices.nbytes + graph.vertices.nbytes + 8 * number
    triangles = box.faces.nbytes + 4 * graph.triangles.nbytes + graph.junk.nbytes
    edges = 36 * 2 * 2 * half_edge + graph.twins.nbytes + graph.kinds.nbytes
    assert counts.building(graph)["bytes"] == vertices + triangles + edges


def test_the_bare_sort_is_that_of_the_graph():
    graph = mesh_graph(trimesh.creation.icosphere(subdivisions=3))
    *places, order = counts.sorted_places(graph)
    assert np.array_equal(order, builder.sort_edges(graph.triangles, graph.junk, len(graph.vertices)))
    passes, sorted_ = np.empty_like(order), np.empty_like(order)
    passes[places[0]] = np.arange(len(order))
    sorted_[places[1]] = passes
    assert np.array_equal(sorted_, order)
