"""Curves that the field measures its interpolators on, as data with their sources."""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from nurbs_lab import paper
from nurbs_lab.nurbs import NurbsCurve

_STORED = ("butterfly", "zigzag", "circle", "figure-of-eight")


@dataclass(frozen=True)
class BenchmarkCurve:
    """A curve (mm), where it was published, and what to know about it."""

    name: str
    curve: NurbsCurve
    source: str
    notes: str


@cache
def benchmark_curves():
    """All benchmark curves by name: paper, butterfly, zigzag, circle, figure-of-eight.

    Returns
    -------
    dict of str to BenchmarkCurve
    """
    source = "section 4 of the paper this project follows"
    own = BenchmarkCurve("paper", paper.CURVE, source, "degree 2, plane")
    return {"paper": own} | {name: _load(name) for name in _STORED}


def _load(name):
    data = json.loads(files("nurbs_lab.motion").joinpath("data", f"{name}.json").read_text())
    curve = NurbsCurve(data["degree"], data["knots"], data["control_points"], data["weights"])
    return BenchmarkCurve(name, curve, data["source"], data["notes"])
