"""Bench of rtl/boards/axes.v: steps of the twin after every period, and every fault stops."""

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import SEED, WATCHDOG, packed, reset, simulate, unknown, words
from nurbs_lab.hardware.axes import count_steps, points_checksum

PULSE, PERIOD = 2, 120


def test_axes():
    simulate("axes", __file__, PULSE=PULSE, SETUP=3)


class Axes:
    def __init__(self, dut):
        self.dut, self.rng = dut, np.random.default_rng(SEED)
        self.scales = tuple(int(self.rng.integers(1 << 30, 1 << 32)) for _ in range(3))
        dut.enable.value, dut.origin.value, dut.s_axis_tvalid.value = 1, 0, 0
        dut.period.value, dut.scales.value = PERIOD, packed(self.scales, 32)

    async def origin(self):
        self.dut.origin.value = 1
        await RisingEdge(self.dut.clk)
        self.dut.origin.value = 0

    def random_points(self, count, fastest=PERIOD / (2 * PULSE + 1)):
        """Random moves of up to the given steps a period, and u."""
        moves = self.rng.integers(-1000, 1001, (count, 3)) / 1000 * fastest * 1024
        places = np.cumsum(moves, axis=0) + self.rng.integers(-(1 << 20), 1 << 20, 3)
        points = [
            tuple(int(x * 2.0**32 / scale) for x, scale in zip(row, self.scales, strict=True))
            for row in places
        ]
        return self.rng.integers(0, 1 << 40, count).tolist(), points

    async def offer(self, u, point, last=False, void=False):
        """One beat; returns when it has been taken."""
        dut = self.dut
        dut.s_axis_tdata.value = packed([u, *point], 40)
        dut.s_axis_tlast.value, dut.s_axis_tuser.value, dut.s_axis_tvalid.value = last, void, 1
        await FallingEdge(dut.clk)
        while dut.s_axis_tready.value != 1:
            await FallingEdge(dut.clk)
        await RisingEdge(dut.clk)
        dut.s_axis_tvalid.value = 0
        unknown(dut.s_axis_tdata)

    @property
    def steps(self):
        return words(int(self.dut.positions.value), 32, 3)

    async def rest(self):
        await ClockCycles(self.dut.clk, 2)
        while self.dut.moving.value == 1:
            await RisingEdge(self.dut.clk)


@cocotb.test(**WATCHDOG)
async def steps_of_the_twin(dut):
    """Two periods after each point its steps have been made, over two runs with a pause between them."""
    axes = Axes(dut)
    await reset(dut)
    await axes.origin()
    u, points = axes.random_points(60)
    expected = count_steps(points, axes.scales)
    for i, (position, point) in enumerate(zip(u, points, strict=True)):
        await axes.offer(position, point, last=i in (29, 59))
        await FallingEdge(dut.clk)
        if i >= 2 and i not in (30, 31):
            assert axes.steps == expected[i - 2]
        if i == 29:
            await axes.rest()
            assert axes.steps == expected[i]
            await ClockCycles(dut.clk, 3 * PERIOD)
            axes.dut.s_axis_tlast.value = 0
    await axes.offer(0, (0, 0, 0), last=True, void=True)
    await axes.rest()
    assert axes.steps == expected[-1]
    assert dut.points_taken.value.to_unsigned() == 60
    assert dut.checksum.value.to_unsigned() == points_checksum(u, points)
    assert (dut.late.value, dut.too_fast.value, dut.lost.value) == (0, 0, 0)


@cocotb.test(**WATCHDOG)
async def faults_stop(dut):
    """Late, too far, disabled: nothing moves and no point is taken until the origin is set."""
    axes = Axes(dut)
    await reset(dut)
    unit = (2.0**32 / np.array(axes.scales) * 1024).tolist()  # a step of each axis
    fastest = PERIOD / (2 * PULSE + 1)
    for axis in range(3):
        for steps, flag in ((1.001 * fastest, 1), (-1.001 * fastest, 1), (0.999 * fastest, 0)):
            await axes.origin()
            await axes.offer(0, (0, 0, 0))
            far = [0, 0, 0]
            far[axis] = round(steps * unit[axis])
            await axes.offer(1, far, last=True)
            await ClockCycles(dut.clk, 15)
            assert dut.too_fast.value == flag
            await axes.rest()
            assert (axes.steps == (0, 0, 0)) == bool(flag)
    await axes.origin()
    near = [round(3 * x) for x in unit]
    await axes.offer(0, (0, 0, 0))
    await axes.offer(1, near)
    await ClockCycles(dut.clk, 2 * PERIOD + 5)
    assert dut.late.value == 1
    assert axes.steps == (3, 3, 3)
    dut.s_axis_tvalid.value = 1
    await ClockCycles(dut.clk, 2 * PERIOD)
    assert dut.points_taken.value.to_unsigned() == 2
    dut.s_axis_tvalid.value = 0
    await axes.origin()
    assert dut.late.value == 1
    await RisingEdge(dut.clk)
    assert dut.late.value == 0
    await axes.offer(0, near)
    await axes.offer(1, (0, 0, 0))
    await ClockCycles(dut.clk, PERIOD)
    dut.enable.value = 0
    await ClockCycles(dut.clk, 2)
    assert dut.moving.value == 0
    assert dut.placed.value == 0
    assert axes.steps == (0, 0, 0)
