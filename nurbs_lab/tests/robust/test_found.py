"""Calls that `make fuzz` found to be refused in the words of a library, each with its argument named."""

import re
import time

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import CURVE, SMALL
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import CALLS
from nurbs_lab.tests.robust.calls_pictures import PICTURES
from nurbs_lab.tests.robust.test_inputs import Broken

STOPS = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0, 0), (0, 0, 0), (1, 1, 1)])  # has no tangent at u = 0
PATH = nl.paper.CURVE  # in a plane
FOUND = [
    ("animation", "frame_s", 1e-9, "0.01 to 6"),
    ("animation", "frame_s", 100.0, "0.01 to 6"),
    ("animation", "values", Broken(), "a sequence"),
    ("leaderboard", "rows", Broken(), "a sequence"),
    ("surface", "color", np.zeros(()), "a colour"),
    ("layers", "curves", [PATH, CURVE], "in space"),
    ("curve", "curve", STOPS, "no value at u = 0"),
    ("Reconstruction.to_mesh", "tolerance", 1e-9, "needs more than"),
    ("load_feed", "period_s", 1e-300, "too short"),
    ("count_cycles", "steps", 100_000, "5 to 1000"),
    ("build_exact_program", "period_s", 1e-300, "too short"),
    ("reconstruct", "layers", 470_873, "1 to 100000"),
    ("reconstruct by height", "layer_height", 1e-5, "more than 100000 layers"),
    ("trace_blocks", "override", 1e-7, "longer than 5000000 periods"),
    ("trace at one speed", "period_s", 1e-7, "at most 5000000"),
]


@pytest.mark.parametrize(("name", "argument", "bad", "said"), FOUND)
def test_found_calls_are_refused_by_name(name, argument, bad, said):
    call, good = (PICTURES | HARDWARE | CALLS)[name]
    good = good | {"comb": True} if name == "curve" else good
    with pytest.raises((ValueError, TypeError), match=rf"^{argument}\b.*{re.escape(said)}"):
        call(**{**good, argument: bad})


@pytest.mark.parametrize("tolerance", [1e-5, 1e-9, 1e-300])
def test_a_tolerance_that_no_smooth_patches_keep_takes_little_work(tolerance):
    start = time.process_time()
    made = nl.reconstruct(SMALL, layers=5, tolerance=tolerance)
    assert time.process_time() - start < 5.0
    assert made.deviation().max < 1e-7  # flat faces, exact but for rounding


def test_a_flag_may_be_a_bool_of_numpy():
    PICTURES["mesh"][0](SMALL, edges=np.True_)
