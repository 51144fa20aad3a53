"""The whole interpolator with exact slopes behind its AXI ports: hold, rest, override, abort."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, with_timeout
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp, AxiStreamBus, AxiStreamSink

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, reset, simulate, words
from cocotb_tests.curves import exact_curve
from nurbs_lab import plan_feed
from nurbs_lab.hardware import build_exact_program, run_exact
from nurbs_lab.hardware.interpolator import ABORT, CONTROL, FORGET, STATUS, register_writes

OVERRIDE, RESTING = 0x20, 1 << 3


@pytest.mark.parametrize("ahead", [1, 0])
def test_override(ahead):
    simulate("nurbs_interpolator", __file__, SLOPE=1, DIM=2, AHEAD=ahead)


@cocotb.test(**WATCHDOG)
async def a_hold_rests_on_the_path_and_an_abort_there_ends_the_run(dut):
    dut.permit.value, dut.halt.value = 1, 0
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1)
    await reset(dut)

    async def write(address, value):
        return (await bus.write(address, value.to_bytes(4, "little"))).resp

    async def status(register=STATUS):
        return int.from_bytes((await bus.read(register, 4)).data, "little")

    async def frame():
        beats = await with_timeout(sink.recv(), 1_000_000 * CLOCK_NS, "ns")
        return [words(int(beat), 40, 3)[1:] for beat in beats.tdata], beats.tuser

    curve = exact_curve(np.random.default_rng(SEED), 2, 2)
    feed = plan_feed(curve, speed=4 * curve.length(), acceleration=1000 * curve.length(), period_s=1e-3)
    program = build_exact_program(curve, feed, 1e-3)
    planned = run_exact(program).points
    for end in ("resumed", "aborted"):
        for address, value in register_writes(program):
            assert await write(address, value) == AxiResp.OKAY
        await ClockCycles(dut.clk, 1500)
        assert await status(CONTROL) == 0  # it keeps no order
        assert not await status() & RESTING
        assert await write(OVERRIDE, 0) == AxiResp.OKAY
        await ClockCycles(dut.clk, 10_000)  # a stop of 4 periods, and some at rest
        assert await status() & RESTING
        if end == "resumed":
            assert await write(OVERRIDE, 1000) == AxiResp.OKAY
            points, _ = await frame()
            assert points[-1] == planned[-1]
            assert len(points) > len(planned) + 50
        else:
            assert await write(CONTROL, ABORT) == AxiResp.OKAY
            points, void = await frame()
            assert void[-1] == 1
            assert points[-1] == points[-2] == points[-40]
        steps = np.abs(np.diff(points, axis=0)).max(axis=1)
        assert steps.max() <= program.largest_step
        assert np.sum(steps == 0) > 40

    # A curve beyond a limit is not closed, as its flags tell, and no point of it leaves.
    far = build_exact_program(curve, feed, 1e-3, axis_limits=[(-1e9, 1e9), (1e9, 1e9)])
    for address, value in register_writes(far):
        assert await write(address, value) == AxiResp.OKAY
    await ClockCycles(dut.clk, 100)
    assert await status() == 1 << 13 | 1 << 11 | 1 << 1
    assert sink.empty()


@cocotb.test(**WATCHDOG)
async def a_command_acts_on_the_point_after_the_next(dut):
    """A hold at any time of a period, the points taken once a period: of those after it one is as planned.

    Without AHEAD five are. The motion to a point begins as it is taken, so a command acts within two periods.
    """
    rng, period = np.random.default_rng(SEED), 1500
    dut.permit.value, dut.halt.value, dut.m_axis_tready.value = 1, 0, 0
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    await reset(dut)
    curve = exact_curve(rng, 2, 2)
    feed = plan_feed(curve, speed=4 * curve.length(), acceleration=1000 * curve.length(), period_s=1e-3)
    program = build_exact_program(curve, feed, 1e-3)
    planned = run_exact(program).points

    async def take(count):
        found = []
        for _ in range(count):
            await ClockCycles(dut.clk, period - 1)
            await FallingEdge(dut.clk)
            assert dut.m_axis_tvalid.value == 1, "a point is late"
            found.append(words(dut.m_axis_tdata.value.to_unsigned(), 40, 3)[1:])
            dut.m_axis_tready.value = 1
            await RisingEdge(dut.clk)
            dut.m_axis_tready.value = 0
        return found

    for wait in (0, int(rng.integers(1, period - 40))):
        for address, value in register_writes(program):
            await bus.write(address, value.to_bytes(4, "little"))
        points = await take(12)
        taking = cocotb.start_soon(take(7))
        await ClockCycles(dut.clk, wait)
        await bus.write(OVERRIDE, bytes(4))
        points += await taking
        same = [here == plan for here, plan in zip(points, planned, strict=False)]
        assert same.index(False) - 12 == (1 if dut.AHEAD.value.to_unsigned() else 5), wait
        await bus.write(CONTROL, FORGET.to_bytes(4, "little"))
