"""Random curves for the benches, feeds on them, and the units that evaluate them."""

from dataclasses import replace

import numpy as np

from cocotb_tests.bench import Unit, load_bus, words
from nurbs_lab import NurbsCurve, plan_feed
from nurbs_lab.hardware import Format, build_program, load_curve
from nurbs_lab.motion.prepared_curve import prepare


def random_curve(rng, degree: int, dim: int, rational: bool) -> NurbsCurve:
    """A curve with uneven and double knots, clamped or not, at any place and scale."""
    count = int(rng.integers(degree + 1, 20))
    knots = rng.uniform(-3, 5) + np.cumsum(rng.uniform(0.05, 1.0, count + degree + 1))
    if degree > 1 and count > degree + 3:
        knots[degree + 2] = knots[degree + 1]
    if rng.random() < 0.5:
        knots[: degree + 1] = knots[degree]
        knots[count:] = knots[count]
    weights = rng.uniform(0.05, 3.0, count) if rational else None
    return NurbsCurve(degree, knots, rng.normal(size=(count, dim)) * 10.0 ** rng.uniform(-2, 3), weights)


def exact_curve(rng, degree: int, dim: int) -> NurbsCurve:
    """A polynomial curve that goes forward, as exact slopes want it: without weights and cusps."""
    points = np.cumsum(rng.uniform(0.3, 1.0, (degree + 4, dim)), axis=0) * 10.0 ** rng.uniform(-1, 2)
    inner = np.cumsum(rng.uniform(0.7, 1.0, 3))
    knots = np.concatenate([np.zeros(degree + 1), inner, np.full(degree + 1, 4.0)])
    return NurbsCurve(degree, knots, points)


def planned(curve, periods, speed=0.5, **options):
    """Leaves rest on this curve for its ``speed`` lengths a second, cut after some periods by a long step."""
    length = prepare(curve).length
    feed = plan_feed(curve, speed=speed * length, acceleration=100 * speed * length, period_s=1e-3)
    anywhere = {"largest_step": 2 * np.ptp(curve.control_points)}
    return build_program(curve, feed, 1e-3, periods, **{**anywhere, **options})


def with_feed(plan, records, end_speed):
    """The plan with another table of the feed."""
    return replace(plan, feed=replace(plan.feed, records=records, end_speed=end_speed))


class CurveUnit(Unit):
    """A unit that evaluates the curve it is loaded with: ``cu`` or ``cuk``."""

    def __init__(self, dut, operands):
        super().__init__(dut, operands)
        self.format, self.dim = Format(dut.WORD.value.to_unsigned()), dut.DIM.value.to_unsigned()

    async def load(self, curve):
        self.loaded = load_curve(curve, self.format)
        await load_bus(self.dut, self.loaded.writes())

    async def load_random(self, degree, rational):
        await self.load(random_curve(self.rng, degree, self.dim, rational))

    async def load_weight(self, weight):
        """Give every point a weight that the loader would refuse."""
        await load_bus(self.dut, [(2, i << 2 | 3, weight) for i in range(len(self.loaded.points))])

    def answer(self):
        """The point and its flags, as the twin gives them."""
        dut = self.dut
        flags = (bool(flag.value) for flag in (dut.out_of_range, dut.overflow, dut.by_zero))
        return (words(dut.point.value.to_unsigned(), self.format.word, self.dim), *flags)
