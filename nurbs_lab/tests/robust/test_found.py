"""Calls that `make fuzz` found to be refused in the words of a library, each with its argument named."""

import re

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import PARTS
from nurbs_lab.tests.robust.calls_pictures import PICTURES
from nurbs_lab.tests.robust.test_inputs import Broken

STOPS = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0, 0), (0, 0, 0), (1, 1, 1)])  # has no tangent at u = 0
FOUND = [
    ("animation", "frame_s", 1e-9, "0.01 to 6"),
    ("animation", "frame_s", 100.0, "0.01 to 6"),
    ("animation", "values", Broken(), "a sequence"),
    ("leaderboard", "rows", Broken(), "a sequence"),
    ("surface", "color", np.zeros(()), "a colour"),
    ("curve", "curve", STOPS, "no value at u = 0"),
    ("Reconstruction.to_mesh", "tolerance", 1e-9, "needs more than"),
    ("load_feed", "period_s", 1e-300, "too short"),
    ("count_cycles", "steps", 100_000, "5 to 1000"),
    ("build_exact_program", "period_s", 1e-300, "too short"),
]


@pytest.mark.parametrize(("name", "argument", "bad", "said"), FOUND)
def test_found_calls_are_refused_by_name(name, argument, bad, said):
    call, good = (PICTURES | HARDWARE | PARTS)[name]
    good = good | {"comb": True} if name == "curve" else good
    with pytest.raises((ValueError, TypeError), match=rf"^{argument}\b.*{re.escape(said)}"):
        call(**{**good, argument: bad})
