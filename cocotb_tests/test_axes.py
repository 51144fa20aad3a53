"""Bench of rtl/boards/axes.v: steps of the twin after every period, and every fault stops."""

from fractions import Fraction
from math import floor

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import SEED, WATCHDOG, packed, reset, simulate, unknown, words
from nurbs_lab.hardware import load_host

twin = load_host().axes_twin
count_steps, points_checksum = twin.count_steps, twin.points_checksum
PULSE, PERIOD = 2, 120
HALF = Fraction(1, 2)
#: A bench that waits for ever ends sooner than others.
WATCHDOG = WATCHDOG | {"timeout_time": 5}
SETTLED = 13  # cycles from the tick until the motion of the period begins


def test_axes():
    simulate("axes", __file__, PULSE=PULSE, SETUP=3)


class Axes:
    def __init__(self, dut):
        self.dut, self.rng = dut, np.random.default_rng(SEED)
        self.scales = tuple(int(self.rng.integers(1 << 30, 1 << 32)) for _ in range(3))
        dut.enable.value, dut.origin.value, dut.s_axis_tvalid.value = 1, 0, 0
        dut.period.value, dut.scales.value = PERIOD, packed(self.scales, 32)
        dut.largest.value = packed([1 << 31] * 3, 32)

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

    async def offer(self, u, point, last=False, void=False, outputs=0):
        """One beat; returns when it has been taken."""
        dut = self.dut
        dut.s_axis_tdata.value = packed([u, *point], 40)
        dut.s_axis_tlast.value, dut.s_axis_tuser.value, dut.s_axis_tvalid.value = last, outputs << 1 | void, 1
        await FallingEdge(dut.clk)
        while dut.s_axis_tready.value != 1:
            await FallingEdge(dut.clk)
        await RisingEdge(dut.clk)
        dut.s_axis_tvalid.value = 0
        unknown(dut.s_axis_tdata)

    @property
    def steps(self):
        return words(int(self.dut.positions.value), 32, 3)

    @property
    def flags(self):
        names = ("too_fast", "late", "lost", "elsewhere", "cut")
        return tuple(name for name in names if getattr(self.dut, name).value == 1)

    async def rest(self):
        await ClockCycles(self.dut.clk, 2)
        while self.dut.moving.value == 1:
            await RisingEdge(self.dut.clk)


@cocotb.test(**WATCHDOG)
async def steps_of_the_twin(dut):
    """A period after the motion to a point began it is made, over two runs with a pause between them.

    Another period and other scales wait for the next origin.
    """
    axes = Axes(dut)
    await reset(dut)
    await axes.origin()
    dut.period.value, dut.scales.value = PERIOD // 3, packed([x - 1000 for x in axes.scales], 32)
    u, points = axes.random_points(60)
    points[30] = points[29]  # a run begins where the one before ended
    expected = count_steps(points, axes.scales)
    for i, (position, point) in enumerate(zip(u, points, strict=True)):
        await axes.offer(position, point, last=i in (29, 59))
        await ClockCycles(dut.clk, SETTLED)
        if i >= 1 and i != 30:
            assert axes.steps == expected[i - 1]
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
    assert axes.flags == ()
    assert dut.placed.value == 1


@cocotb.test(**WATCHDOG)
async def outputs_come_with_the_motion(dut):
    """13 cycles after their point, for its period; a laser's only while an axis moves; off after the run."""
    axes = Axes(dut)
    await reset(dut)
    assert dut.outputs.value == 0
    await axes.origin()
    u, points = axes.random_points(40)
    points[7:] = [points[6], points[6], *points[7:-2]]
    bits = axes.rng.integers(0, 16, 40).tolist()
    bits[7], bits[8] = 15, 8
    expected = twin.outputs_on(bits, points, axes.scales)
    assert expected[7:9] == [7, 0]
    for i, (position, point) in enumerate(zip(u, points, strict=True)):
        await axes.offer(position, point, last=i == 39, outputs=bits[i])
        for cycle in range(PERIOD - 1):
            await FallingEdge(dut.clk)
            now = expected[i] if cycle + 1 >= SETTLED else expected[i - 1] if i else 0
            assert dut.outputs.value.to_unsigned() == now, (i, cycle)
    await ClockCycles(dut.clk, 2)  # the tick, without a point
    for cycle in range(PERIOD):
        await FallingEdge(dut.clk)
        assert dut.outputs.value.to_unsigned() == (0 if cycle + 1 >= SETTLED else expected[-1]), cycle


@cocotb.test(**WATCHDOG)
async def whatever_stops_the_tool_turns_the_outputs_off(dut):
    """In the next cycle: a point that is late, too far or void, disabling, a new origin, a reset."""
    axes = Axes(dut)
    await reset(dut)
    _, points = axes.random_points(3)
    far = tuple(x + (1 << 30) for x in points[-1])
    for trouble in ("late", "too far", "void", "enable", "origin", "rst"):
        await axes.origin()
        for point in points:
            await axes.offer(0, point, outputs=15)
        await ClockCycles(dut.clk, SETTLED + 20)
        assert dut.outputs.value == 15
        if trouble in ("enable", "origin", "rst"):
            getattr(dut, trouble).value = int(trouble != "enable")
            await RisingEdge(dut.clk)
            await FallingEdge(dut.clk)
            assert dut.outputs.value == 0
            getattr(dut, trouble).value = int(trouble == "enable")
            continue
        if trouble != "late":
            void = trouble == "void"
            await axes.offer(0, points[-1] if void else far, last=void, void=void, outputs=15)
        cycles = 0
        while not axes.flags:
            await FallingEdge(dut.clk)
            cycles += 1
            assert cycles < 2 * PERIOD
        await FallingEdge(dut.clk)
        assert dut.outputs.value == 0
        assert dut.placed.value == 0


@cocotb.test(**WATCHDOG)
async def places_are_rounded_to_nearest(dut):
    """A thousandth of a step here or there decides which step is made: as exact fractions say."""
    axes = Axes(dut)
    await reset(dut)
    axes.scales = (1 << 31, 3 << 30, (1 << 32) - 1)
    dut.scales.value = packed(axes.scales, 32)
    for half in (511, 512, 513):
        await axes.origin()
        origin = axes.rng.integers(-1000, 1000, 3).tolist()
        # The coordinates whose places are nearest to half a step from the first.
        pairs = list(zip(origin, axes.scales, strict=True))
        point = [round(Fraction((x * scale >> 32) + 2048 + half << 32, scale)) for x, scale in pairs]
        await axes.offer(0, origin)
        await axes.offer(1, point, last=True)
        await axes.rest()
        expected = []
        for x, y, scale in zip(origin, point, axes.scales, strict=True):
            first, second = (floor(Fraction(z * scale, 1 << 32) + HALF) for z in (x, y))
            expected.append(floor(Fraction(second - first, 1024) + HALF))
        assert axes.steps == tuple(expected)


@cocotb.test(**WATCHDOG)
async def the_largest_step_holds(dut):
    """Of each axis by itself, to the last bit, by the register or by what the pins can make."""
    axes = Axes(dut)
    await reset(dut)
    axes.scales = (1 << 31,) * 3  # two units make 1/1024 of a step
    dut.scales.value = packed(axes.scales, 32)
    fastest = PERIOD * 1024 // (2 * PULSE + 1)
    for axis in range(3):
        for largest in (0, 5000, fastest, 1 << 31):
            limits = [1 << 31] * 3
            limits[axis] = largest
            dut.largest.value = packed(limits, 32)
            for size in {max(min(largest, fastest) + more, 0) for more in (-1, 0, 1)}:
                for sign in (1, -1):
                    await axes.origin()
                    await axes.offer(0, (0, 0, 0))
                    far = [0, 0, 0]
                    far[axis] = 2 * size * sign
                    await axes.offer(1, far, last=True)
                    await ClockCycles(dut.clk, SETTLED)
                    fault = size > min(largest, fastest)
                    assert axes.flags == (("too_fast",) if fault else ()), (axis, largest, size)
                    await axes.rest()
                    steps = 0 if fault else sign * size + 512 >> 10
                    assert axes.steps[axis] == steps
                    assert dut.placed.value == (not fault)


@cocotb.test(**WATCHDOG)
async def a_run_begins_where_the_tool_stands(dut):
    """The first point after a pause may lie a step away, no more, however much a period may move."""
    axes = Axes(dut)
    await reset(dut)
    axes.scales = (1 << 31,) * 3
    dut.scales.value = packed(axes.scales, 32)
    for axis in range(3):
        for away, flags in ((2048, ()), (-2048, ()), (2050, ("elsewhere",)), (-2050, ("elsewhere",))):
            await axes.origin()
            await axes.offer(0, (0, 0, 0))
            await axes.offer(1, (6000, 6000, 6000), last=True)
            await axes.rest()
            assert axes.steps == (3, 3, 3)
            begin = [6000, 6000, 6000]
            begin[axis] += away
            await axes.offer(2, begin)
            await ClockCycles(dut.clk, SETTLED)
            assert axes.flags == flags
            if flags:
                await ClockCycles(dut.clk, 3 * PERIOD)
                assert axes.steps == (3, 3, 3)
                assert dut.moving.value == 0
            else:
                await axes.offer(3, begin, last=True)
                await axes.rest()


@cocotb.test(**WATCHDOG)
async def nothing_moves_before_an_origin(dut):
    """After a reset, a late point, a cut, disabling: no point is taken until the origin is set again."""
    axes = Axes(dut)
    await reset(dut)
    near = [round(3.2 * 1024 * 2.0**32 / scale) for scale in axes.scales]
    far = [4 * x for x in near]

    async def nothing_moves(steps):
        dut.s_axis_tvalid.value, dut.s_axis_tuser.value = 1, 0
        dut.s_axis_tdata.value = packed([0, *far], 40)
        for _ in range(4 * PERIOD):
            await RisingEdge(dut.clk)
            assert dut.s_axis_tready.value == 0
            assert dut.step.value == 0
        dut.s_axis_tvalid.value = 0
        assert axes.steps == steps
        assert (dut.moving.value, dut.placed.value) == (0, 0)

    await nothing_moves((0, 0, 0))
    dut.enable.value = 0
    await axes.origin()  # refused without enable
    dut.enable.value = 1
    await nothing_moves((0, 0, 0))

    async def two_points(last=False):
        await axes.origin()
        await RisingEdge(dut.clk)
        assert axes.flags == ()
        await axes.offer(0, (0, 0, 0))
        await axes.offer(1, near, last)

    for trouble in ("late", "cut", "disabled", "void at rest"):
        await two_points()
        if trouble == "late":
            await ClockCycles(dut.clk, PERIOD + 5)
        elif trouble == "disabled":
            await ClockCycles(dut.clk, PERIOD // 2)
            dut.enable.value = 0
            await ClockCycles(dut.clk, 2)
            dut.enable.value = 1
        elif trouble == "cut":
            await axes.offer(2, near, last=True, void=True)
        else:
            await axes.offer(2, near)
            await axes.offer(3, near, last=True, void=True)
            await axes.rest()
            assert (axes.flags, axes.steps, dut.placed.value) == ((), (3, 3, 3), 1)
            continue
        await ClockCycles(dut.clk, 10)
        assert axes.flags == ((trouble,) if trouble in ("late", "cut") else ())
        steps = axes.steps
        assert all(0 < x <= 3 for x in steps)
        await nothing_moves(steps)
