"""Bench of rtl/vt.v."""

import cocotb
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import WATCHDOG, Unit, drive, simulate, unknown
from nurbs_lab.hardware import Format
from nurbs_lab.hardware.feed import RECORDS, LoadedFeed


@pytest.mark.parametrize("word", [21, 35])
def test_vt(word):
    simulate("vt", __file__, WORD=word)


def feeds(format, rng):
    """The ends of the range, a record for each sample, longer ones, and a full table."""
    top = (format.largest >> 1 << format.ramp_guard) + (1 << format.ramp_guard - 1) - 1
    yield LoadedFeed(format, ((1, top, 0, 0), (2, 0, top, 0)), 0, 1)
    for count in (0, 1, 3, 2 * RECORDS - 1):
        for longest in (2, 12):
            speeds = rng.integers(0, top // 2, (count, 2)).tolist()
            lengths = rng.integers(1, longest, count).tolist()
            records = [
                (n, a, (b - a) // n, (a - b) // n**2) for n, (a, b) in zip(lengths, speeds, strict=True)
            ]
            yield LoadedFeed(format, tuple(records), top // 7, 1)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, [])
    dut.advance.value = 0
    await unit.reset()
    format = Format(len(dut.now) + 1)
    for feed in feeds(format, unit.rng):
        await load(dut, feed.writes())
        samples = feed.samples()
        expected = [next(samples)]
        command = dut.start
        for _ in range(40):
            expected = [expected[-1], next(samples), next(samples)]
            await give(dut, command)
            for cycle in range(1, 23):
                await FallingEdge(dut.clk)
                reached = cycle >= (7 if command is dut.start else 1)
                found = [speed.value for speed in (dut.now, dut.half, dut.whole)]
                assert not reached or int(found[0]) == expected[0]
                assert cycle < 14 or int(found[1]) == expected[1]
            assert (dut.busy.value, dut.overflow.value, int(found[2])) == (0, 0, expected[2])
            command = dut.advance


@cocotb.test(**WATCHDOG)
async def a_speed_out_of_range_is_told(dut):
    """Negative or too large, in any of the three, until the next start."""
    unit = Unit(dut, [])
    dut.advance.value = 0
    await unit.reset()
    format = Format(len(dut.now) + 1)
    most = (1 << format.word + 26) - 1
    half_unit = 1 << format.ramp_guard - 1
    for wrong, told in ((-half_unit - 1, 1), (most, 1), (most - half_unit, 0), (-half_unit, 0)):
        for place in range(4):
            words = (1, 0, 0, 0) * place + (1, wrong, 0, 0) + (0, 5, 0, 0)
            await load(dut, [(4, index, word) for index, word in enumerate(words)])
            for command in (dut.start, dut.advance, dut.advance):
                await give(dut, command)
                await ClockCycles(dut.clk, 22)
            assert dut.overflow.value == told


async def load(dut, writes):
    dut.load.value = 1
    for space, index, word in writes:
        if space == 4:
            dut.load_index.value = index
            drive(dut.load_data, word)
            await RisingEdge(dut.clk)
    unknown(dut.load_data)
    dut.load.value = 0


async def give(dut, command):
    command.value = 1
    await RisingEdge(dut.clk)
    command.value = 0
