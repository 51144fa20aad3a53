"""A long path takes no memory but the path itself."""

import tracemalloc

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import benchmark_curves


@pytest.mark.parametrize("stepper", ["chord-corrected", "adams", "exact"])
def test_a_long_path_takes_little_more_memory_than_its_own_arrays(stepper):
    curve, count = benchmark_curves()["circle"].curve, 200_000
    nl.trace(curve, 4.0, stepper=stepper, period_s=1e-2)
    tracemalloc.start()
    path = nl.trace(curve, 4.0, stepper=stepper, period_s=curve.length() / 4.0 / count)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(path.moved) == pytest.approx(count, abs=2)
    kept = sum(value.nbytes for value in vars(path).values() if isinstance(value, np.ndarray))
    assert peak < 1.2 * kept
