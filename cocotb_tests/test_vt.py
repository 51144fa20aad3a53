"""Bench of rtl/vt.v."""

import cocotb
import pytest
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.bench import WATCHDOG, Unit, drive, simulate, unknown
from nurbs_lab.hardware import Format, LoadedFeed


@pytest.mark.parametrize("word", [21, 35])
def test_vt(word):
    simulate("vt", __file__, WORD=word)


def feeds(format, rng):
    """Trapezoids, triangles, constant speeds, and lines at the limits of their registers."""
    top = format.largest_speed
    for cruise in (top, top // 3, top // 1000):
        for steps in (1, 3, 17):
            rise, fall = cruise // steps, cruise // int(rng.integers(1, 20))
            yield (0, rise, cruise, int(rng.integers(0, 40)), cruise, fall, 0)
            yield (cruise // 2, rise, cruise, 20, top, fall, cruise // 5)
        yield (cruise, 0, cruise, 999, 0, 0, cruise)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, [])
    dut.advance.value = 0
    await unit.reset()
    format = Format(len(dut.now) + 1)
    for lines in feeds(format, unit.rng):
        dut.load.value = 1
        for index, line in enumerate(lines):
            dut.load_index.value = index
            drive(dut.load_data, line)
            await RisingEdge(dut.clk)
        dut.load_index.value = 7  # where there is nothing to load
        unknown(dut.load_data)
        await RisingEdge(dut.clk)
        dut.load.value = 0
        samples = LoadedFeed(format, *lines, periods=1).samples()
        expected = [next(samples)]
        command = dut.start
        for _ in range(40):
            expected = [expected[-1], next(samples), next(samples)]
            command.value = 1
            await RisingEdge(dut.clk)
            command.value = 0
            for _ in range(4 if command is dut.start else 3):
                await FallingEdge(dut.clk)
            assert dut.busy.value == 0
            assert [int(dut.now.value), int(dut.half.value), int(dut.whole.value)] == expected
            command = dut.advance
