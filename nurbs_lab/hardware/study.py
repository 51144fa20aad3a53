"""Word lengths: how the accuracy of the whole path follows the bits, and why 35 are shipped."""

from functools import partial
from typing import NamedTuple

import numpy as np

from nurbs_lab.common.checks import as_sequence
from nurbs_lab.common.executor import map_items
from nurbs_lab.hardware.formats import Format
from nurbs_lab.hardware.interpolator import build_program
from nurbs_lab.hardware.stepper import run_twin
from nurbs_lab.motion import trace


class Accuracy(NamedTuple):
    """The path of one word length beside float64 by the same method."""

    word: int
    #: Largest difference of u at the same step, as a part of the domain; infinite if the run raised a flag.
    u_error: float
    #: Most that the fluctuation of a step, by chord, is worse than in float64; the last step is left out.
    added_fluctuation: float


def word_length_study(curve, feed, period_s, words=range(23, 37, 2), *, executor=None) -> list[Accuracy]:
    """Run the twin of the paper's scheme for several word lengths, on an executor if one is given.

    Two bits of word buy a factor of about four. With 35 the paper's path is below 1e-8 in u, and four
    18 x 18 multipliers take no more bits: that is why 35 is shipped.
    """
    formats = [Format(word) for word in as_sequence("words", words)]
    reference = trace(curve, feed, stepper="paper", period_s=period_s)
    run = partial(_accuracy, curve, feed, period_s, reference)
    return map_items(run, formats, executor, what="word length")


def _accuracy(curve, feed, period_s, reference, format):
    first, last = curve.domain
    plan = build_program(curve, feed, period_s, len(reference.moved), format=format)
    result = run_twin(plan)
    u = np.clip(plan.curve.from_u(result.u), first, last)
    common = min(len(u), len(reference.u)) - 1
    chord = np.linalg.norm(np.diff(curve(u[:common]), axis=0), axis=1)
    worse = np.abs(chord - reference.chord[: common - 1]) / reference.commanded[: common - 1]
    error = np.inf if result.flags else np.abs(u[:common] - reference.u[:common]).max() / (last - first)
    return Accuracy(format.word, float(error), float(worse.max(initial=0.0)))
