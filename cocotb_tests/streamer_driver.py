"""Driver of the bench of rtl/streamer.v: loads banks, begins runs, takes points, looks at every period."""

from dataclasses import replace

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import SEED, load_bus, met, words
from cocotb_tests.curves import exact_curve
from nurbs_lab import plan_feed
from nurbs_lab.hardware import Format, build_exact_program, run_exact
from nurbs_lab.hardware.feed import distances
from nurbs_lab.hardware.feed_override import FeedOverride

QUEUE = 5  # most periods that the override has taken ahead of the one in which the path is
FAULTS = {0: "overflow", 3: "too_far", 4: "beyond"}


class Machine:
    """Loads, runs, takes the points with stalls."""

    def __init__(self, dut):
        self.dut, self.rng, self.dim = dut, np.random.default_rng(SEED), dut.DIM.value.to_unsigned()
        self.format = Format(dut.WORD.value.to_unsigned())
        self.curves = np.random.default_rng(SEED)  # apart, so that no curve depends on the number of cycles
        dut.load.value = dut.go.value = dut.ready.value = dut.stop.value = dut.close.value = 0
        dut.rate.value = 256
        self.rates, self.abort = [], None  # as sampled in the latest run, and the first period after a stop
        self.rested, self.outputs, self.filled = False, [], 0

    def plan(self, degree, periods=220, jerk=None):
        curve = exact_curve(self.curves, degree, self.dim)
        seconds = periods * 1e-3
        speed = 1.2 * curve.length() / seconds
        feed = plan_feed(
            curve,
            speed=speed,
            acceleration=16 * speed / seconds,
            jerk=jerk and jerk * speed / seconds**2,
            period_s=1e-3,
        )
        plan = build_exact_program(curve, feed, 1e-3, format=self.format)
        pieces = tuple(replace(piece, outputs=(5 * n + 3) % 16) for n, piece in enumerate(plan.pieces))
        return replace(plan, pieces=pieces)

    async def begin(self, plan, banks=1, batches=None):
        self.later, self.filled = batches or plan.batches(), 0
        for bank in range(banks):
            await self.load_next(bank)
        self.dut.go.value = 1
        await RisingEdge(self.dut.clk)
        self.dut.go.value = 0

    async def load_next(self, bank):
        """Load the next bank and close it."""
        dut = self.dut
        await load_bus(dut, self.later.pop(0))
        dut.load_space.value, dut.load_index.value, dut.close.value = 7, bank, 1
        await RisingEdge(dut.clk)
        dut.close.value = 0
        self.filled += 1

    async def watch(self):
        """Note the rate of every period."""
        dut = self.dut
        while True:
            await met(dut, dut.sampled)
            self.rested |= dut.resting.value == 1
            starved = dut.starved.value == 1
            self.looks.append((self.filled, starved))
            self.rates.append(0 if starved else dut.rate.value.to_unsigned())
            if dut.stopping.value == 1 and self.abort is None:
                self.abort = len(self.rates) - 1

    async def points(self, stalls=0.0):
        dut, u, points, last = self.dut, [], [], False
        self.rates, self.looks, self.abort, self.rested, self.outputs = [], [], None, False, []
        watching = cocotb.start_soon(self.watch())
        while not last:
            dut.ready.value = int(stalls == 0.0)
            if stalls:
                await ClockCycles(dut.clk, int(self.rng.geometric(1.0 - stalls)))
                dut.ready.value = 1
            await met(dut, dut.valid)
            last, void = dut.last.value == 1, dut.stopped.value == 1
            assert not (void and dut.outputs.value.to_unsigned())
            if not void:
                self.outputs.append(dut.outputs.value.to_unsigned())
                u.append(dut.position.value.to_unsigned())
                points.append(words(dut.point_out.value.to_unsigned(), self.format.word, self.dim))
        await FallingEdge(dut.clk)
        watching.cancel()
        assert (dut.done.value, dut.busy.value, dut.valid.value) == (1, 0, 0)
        return u, points, void

    def check_starved(self, plan):
        """A bank is awaited where fewer periods are left than the reserve, as the bench counts them."""
        override = FeedOverride([*distances(plan.feed)], plan.override, self.format.word)
        starts = [period for _, period in plan.cuts()]
        for rate, (filled, starved) in zip(self.rates, self.looks, strict=True):
            left = starts[filled] - override.number - plan.override.reserve
            if filled == len(starts) - 1 or left >= QUEUE:
                assert not starved
            elif left < 0:
                assert starved
            override.step(rate)

    async def check(self, plan, flags=(), stalls=0.0):
        await self.begin(plan)
        u, points, void = await self.points(stalls)
        expected = run_exact(plan)
        assert expected.flags == flags
        assert (u, points, void) == (expected.u, expected.points, bool(flags))
        assert self.outputs == expected.outputs
        raised = self.dut.faults.value.to_unsigned()
        assert tuple(name for bit, name in FAULTS.items() if raised >> bit & 1) == flags
