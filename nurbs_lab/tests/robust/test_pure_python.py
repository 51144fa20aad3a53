"""The kernels say the same as plain Python as when compiled, which lets coverage see into them."""

import os
import pickle
import subprocess
import sys
import tempfile
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import BALL, CALLS, CURVE, LIMITS, LINE, PLANE, leaves

FIN = SimpleNamespace(  # three triangles on one edge, one of no area, open all around
    vertices=np.array([(0, 0, 0), (0, 0, 4), (3, 0, 2), (-3, 1, 2), (0, -3, 2), (0, 0, 2)]),
    faces=[(0, 1, 2), (1, 0, 3), (0, 1, 4), (0, 1, 5)],
)
KINK = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 2, 2, 2], [(0, 0), (1, 2), (2, 0), (3, 2), (4, 0)])


def sliced_file():
    with tempfile.NamedTemporaryFile(suffix=".stl") as file:
        BALL.export(file.name)
        return nl.mesh.slice_stl(file.name, np.linspace(-3, 3, 5))


#: Beside `CALLS`, whatever reaches the lines of kernels that those do not.
MORE = {
    "a closed curve": lambda: nl.interpolate_curve(LINE, closed=True),
    "a closed curve of even degree": lambda: nl.interpolate_curve(LINE, 2, closed=True),
    "given slopes": lambda: nl.interpolate_curve(LINE, end_derivatives=((1, 0, 0), (0, 1, 0))),
    "a closed fit": lambda: nl.approximate_curve(LINE, tolerance=0.25, closed=True),
    "derivatives beyond the degree": lambda: CURVE.derivative(0.25, 5),
    "lengths around a kink": lambda: KINK.parameter_at(np.linspace(0, KINK.length(), 9)),
    "many points around a kink": lambda: KINK(np.linspace(0, 2, 300)),
    "a plane surface": lambda: nl.interpolate_surface(PLANE).grid([0.25, 0.5], [0.5]),
    "a fin": lambda: nl.slice_mesh(FIN, [1.0, 2.0, 3.0]),
    "a hollow box": lambda: nl.slice_mesh(
        trimesh.util.concatenate([trimesh.creation.box((4, 4, 4)), trimesh.creation.box((2, 2, 2))]),
        [0.0, 1.0],
    ),
    "a file": sliced_file,
    "limits of the axes": lambda: nl.plan_feed(CURVE, **LIMITS, axis_acceleration=(40, 30, 20)),
} | {
    f"stepper {name}": lambda name=name: nl.trace(nl.paper.CURVE, 4.0, stepper=name, period_s=2.0**-6)
    for name in nl.STEPPERS
    if name != "rtl"  # which has no kernel
}
NAMES = [*CALLS, *MORE]


def result(name):
    call, good = CALLS[name] if name in CALLS else (MORE[name], {})
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
            same = 1e-7 if name == "plan_feed" else 1e-13  # jerks are third differences of a search's answer
            np.testing.assert_allclose(compiled, plain, rtol=same, atol=same * np.abs(plain).max(initial=0))
        else:
            np.testing.assert_array_equal(compiled, plain)
