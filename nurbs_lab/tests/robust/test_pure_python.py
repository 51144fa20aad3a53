"""The kernels say the same as plain Python as when compiled, which lets coverage see into them."""

import os
import pickle
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import chdir
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.mesh._kernels_read import unused_vertices
from nurbs_lab.motion._scurve_problem import Block
from nurbs_lab.tests.robust.calls import BALL, CURVE, LINE, PLANE, QUICK, SURFACE, leaves

PLACES = np.array([(0, 0, 0), (0, 0, 4), (3, 0, 2), (-3, 1, 2), (0, -3, 2), (0, 0, 2), (6, 0, 2)])
FIN = SimpleNamespace(  # triangles on one edge: two at the same angle, one of no area, open all around
    vertices=PLACES, faces=[(1, 0, 6), (0, 1, 2), (1, 0, 3), (0, 1, 4), (0, 1, 5)]
)
PAIR = SimpleNamespace(vertices=PLACES, faces=[(0, 1, 2), (0, 1, 3), (1, 3, 0)])  # wound alike, one twice
KINK = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 2, 2, 2], [(0, 0), (1, 2), (2, 0), (9, 2), (12, 0)])
FREE = nl.NurbsCurve(2, [0, 1, 2, 3, 3, 4, 5], [(0, 0), (1, 2), (2, 0), (3, 2)])  # not clamped
FOUR = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0, 0, 0), (1, 2, 0, 1), (2, 0, 1, 3)], [1, 2, 1])
LOOP = nl.NurbsCurve(3, [0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (2, 1), (-2, 1), (0, 0)])
LEAP = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1, 0)], [1, 1000])  # run through ever faster
CROWD = nl.NurbsCurve(1, [0, 0, 1e-3, 2e-3, 3e-3, 1, 1], [(0, 0), (1, 1), (2, 0), (3, 1), (4, 0)])
UNEVEN = nl.NurbsCurve(
    3,
    [0, 0, 0, 0, 0.3, 0.3, 0.3, 0.6, 1, 1, 1, 1],
    [(0, 0), (0.1, 2), (0.2, 0.1), (0.3, 5), (4, 1), (4.5, 0), (4.6, 3), (9, 0)],
    [1, 3, 0.3, 1, 3, 0.3, 0.3, 1],
)
HOLLOWS = nl.NurbsSurface(
    (3, 3),
    ([0] * 4 + [1] * 4,) * 2,
    [[(i, j, 9 * (i % 3 == j % 3 == 0)) for j in range(4)] for i in range(4)],
)
PEAKS = [(1.5, 1.5, 9), (1.5, 1.5, 2), (0.1, 0.2, 40), (9, 9, 9)]
BEND = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0), (2, 0), (3, 2)])


def s_curve(axes, cells=12):
    """The fastest motion with limited jerk over a few cells, and the same slowed down."""
    along = np.tile(np.full(axes, 0.3), (cells + 1, 1))
    across = np.outer(np.linspace(-1.0, 1.0, cells + 1), np.full(axes, 0.4))
    block = Block(
        nodes=np.linspace(0.0, 1.0, cells + 1) ** 1.2,
        ends=np.array([0.25, 0.0, 0.16, 0.0]),
        caps=np.linspace(1.0, 2.0, cells),
        causes=np.full(cells, "speed", object),
        along=np.hstack([along, -along]),
        across=np.hstack([across, -across]),
        acceleration=2.0,
        jerk=20.0,
        speeds=(0.5, 0.4),
        ramp_times=(0.0, 0.0),
        ramp_jerk=20.0,
    )
    middle = np.linspace(0.25, 0.16, cells)
    assert block.make_feasible(middle)
    fastest, weight = middle, block.solve(middle, 1e-4)
    slowed = fastest.copy()
    block.stretch_to(slowed, weight, 1.2 * block.phases(fastest)[0].sum())
    return fastest, *block.phases(slowed)[:2]


def sliced_file(scale=1.0):
    with tempfile.TemporaryDirectory() as folder, chdir(folder):  # its name stays out of what is refused
        trimesh.Trimesh(scale * BALL.vertices, BALL.faces, process=False).export("ball.stl")
        with ThreadPoolExecutor(1) as one:  # whose worker reads the file in blocks
            return nl.slice_mesh("ball.stl", np.linspace(-3, 3, 5), executor=one)


def walks(name):
    """A level feed, from rest to rest over a kink, in long uneven steps, and round a loop in one."""
    length = KINK.length()
    rest = nl.plan_feed(KINK, speed=length, acceleration=8 * length, period_s=0.02)
    yield nl.trace(nl.paper.CURVE, 4.0, stepper=name, period_s=2.0**-6)
    yield nl.trace(KINK, rest, stepper=name)
    yield nl.trace(UNEVEN, 0.99 * UNEVEN.length(), stepper=name, period_s=0.2)
    yield nl.trace(LOOP, LOOP.length() / 1.0001, stepper=name, period_s=1.0)


def refusal(call):
    with pytest.raises(ValueError, match=" ") as refused:
        call()
    return str(refused.value)


#: Beside `QUICK`, whatever reaches the lines of kernels that those do not.
MORE = {
    "a closed curve": lambda: nl.interpolate_curve(LINE, closed=True),
    "a closed curve of even degree": lambda: nl.interpolate_curve(LINE, 2, closed=True),
    "given slopes": lambda: nl.interpolate_curve(LINE, end_derivatives=((1, 0, 0), (0, 1, 0))),
    "a closed fit": lambda: nl.approximate_curve(LINE, tolerance=0.25, closed=True),
    "derivatives beyond the degree": lambda: CURVE.derivative(0.25, 5),
    "the end of a curve that is not clamped": lambda: FREE([2.5, 3.0]),
    "lengths in four dimensions": lambda: FOUR.parameter_at(np.linspace(0, FOUR.length(), 5)),
    "lengths around a kink": lambda: KINK.parameter_at(np.linspace(0, KINK.length(), 9)),
    "lengths run through ever faster": lambda: LEAP.parameter_at(np.linspace(0, 1, 9)),
    "many points around a kink": lambda: KINK(np.linspace(0, 2, 300)),
    "many points among crowded knots": lambda: CROWD(np.linspace(0, 0.01, 300)),
    "a plane surface": lambda: nl.interpolate_surface(PLANE).grid([0.25, 0.5], [0.5]),
    "a long row of a surface": lambda: SURFACE.grid([0.25], np.linspace(0, 1, 99)),
    "places nearest to hollows": lambda: HOLLOWS.closest_point(PEAKS),
    "a fin": lambda: nl.slice_mesh(FIN, [1.0, 2.0, 3.0]),
    "a pair": lambda: nl.slice_mesh(PAIR, [1.0, 2.0, 3.0]),
    "a hollow box": lambda: nl.slice_mesh(
        trimesh.util.concatenate([trimesh.creation.box((4, 4, 4)), trimesh.creation.box((2, 2, 2))]),
        [0.0, 1.0],
    ),
    "a file": sliced_file,
    "corners above 255 in the text of a file": lambda: unused_vertices(
        np.frombuffer(b"v 0 0 0\n" * 300 + b"f 1 -150 299\n", np.uint8)
    ),
    "a file without numbers": lambda: refusal(lambda: sliced_file(np.nan)),
    "an S-curve": lambda: s_curve(0),
    "an S-curve within limits of axes": lambda: s_curve(2),
    "0 / 0": lambda: refusal(lambda: nl.trace(CROWD, 4.0, stepper="rk4-minus", period_s=0.01)),
} | {
    f"stepper {name}": lambda name=name: list(walks(name))
    for name in nl.STEPPERS
    if name not in ("rtl", "board")  # which have no kernel
}
#: Plans with jerk, whose grids of thousands of cells plain Python has no time for; see `s_curve`.
LONG = ("plan_feed", "plan_windows", "Program.trace")
#: Steppers that iterate until only rounding is left: the last bit decides how often.
TO_ROUNDING = ("stepper exact", "stepper history-arc", "stepper multistep")
NAMES = [name for name in [*QUICK, *MORE] if name not in LONG]


def result(name):
    call, good = QUICK[name] if name in QUICK else (MORE[name], {})
    return list(leaves(call(**good)))


@pytest.fixture(scope="module")
def interpreted(tmp_path_factory):
    file = tmp_path_factory.mktemp("plain") / "results"
    code = (
        "import pickle, sys, numpy as np; np.seterr(over='ignore');"  # hashes wrap around without a warning
        "from nurbs_lab.tests.robust import test_pure_python as t;"
        "pickle.dump({name: t.result(name) for name in t.NAMES}, open(sys.argv[1], 'wb'))"
    )
    subprocess.run(
        [sys.executable, "-c", code, file], env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, check=True
    )
    return pickle.loads(file.read_bytes())


@pytest.mark.parametrize("name", NAMES)
def test_kernels_say_the_same_compiled_and_interpreted(name, interpreted):
    for compiled, plain in zip(result(name), interpreted[name], strict=True):
        assert (compiled.dtype, compiled.shape) == (plain.dtype, plain.shape)
        if compiled.dtype.kind == "f":
            same = 1e-7 if name.startswith("an S-curve") else 1e-13  # jerks are differences of results
            size = np.abs(plain[np.isfinite(plain)]).max(initial=0.1)  # errors are differences of these
            np.testing.assert_allclose(compiled, plain, rtol=same, atol=same * size)
        elif name not in TO_ROUNDING:  # integers count evaluations there
            np.testing.assert_array_equal(compiled, plain)
