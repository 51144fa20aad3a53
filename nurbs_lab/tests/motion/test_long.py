"""Long work runs in parts: the same bits, and no memory but the path itself."""

import tracemalloc

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.common import progress
from nurbs_lab.motion import benchmark_curves

#: Without the reading of Eq. (20) that is unstable.
NAMES = [name for name in nl.motion.software_steppers() if name != "rk4-plus"]


def arrays(path):
    return {name: value for name, value in vars(path).items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("curve", ["paper", "circle"])
def test_blocks_change_no_bit(curve, name, monkeypatch):
    curve = benchmark_curves()[curve].curve
    feed = nl.plan_feed(curve, speed=4.0, acceleration=40.0, jerk=800.0, period_s=5e-3)
    whole = nl.trace(curve, feed, stepper=name)
    monkeypatch.setattr(progress, "STEPS", 7)
    monkeypatch.setenv("NURBS_LAB_PROGRESS", "0")
    parts = nl.trace(curve, feed, stepper=name)
    assert len(whole.moved) > 10 * 7
    for field, value in arrays(whole).items():
        np.testing.assert_array_equal(getattr(parts, field), value, err_msg=field)


def test_a_long_path_takes_little_more_memory_than_its_own_arrays():
    count = 200_000
    period = benchmark_curves()["circle"].curve.length() / 4.0 / count
    nl.trace(benchmark_curves()["circle"].curve, 4.0, stepper="chord-corrected", period_s=1e-2)
    tracemalloc.start()
    path = nl.trace(benchmark_curves()["circle"].curve, 4.0, stepper="chord-corrected", period_s=period)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(path.moved) == pytest.approx(count, abs=2)
    kept = sum(value.nbytes for value in arrays(path).values())
    assert peak < 1.05 * kept + 24 * progress.STEPS
