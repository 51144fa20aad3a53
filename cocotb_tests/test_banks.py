"""Bench of rtl/banks.v: numbers come back; a bank closes with its bounds, and opens as it is left."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge

from cocotb_tests.bench import SEED, WATCHDOG, reset, simulate

DIM, WORD = 2, 29
#: Axis and side of each bound of a bank; the last one is the step.
EVERY = ((0, 0), (0, 1), (1, 0), (1, 1), (3, 1))
THIRD = ((2, 0), (2, 1))  # of the axis that is not there


def test_banks():
    simulate("banks", __file__, DIM=DIM, WORD=WORD)


class Banks:
    def __init__(self, dut):
        self.dut = dut
        for name in (
            "load",
            "close",
            "bound_beyond",
            "busy",
            "begins",
            "done",
            "period_taken",
            "point_bank",
            "feed_bank",
        ):
            getattr(dut, name).value = 0

    async def write(self, space, index, data=0, beyond=0):
        dut = self.dut
        dut.load.value, dut.load_space.value, dut.load_index.value = 1, space, index
        dut.load_data.value, dut.bound_beyond.value = data & (1 << 64) - 1, beyond
        await FallingEdge(dut.clk)
        dut.load.value = dut.bound_beyond.value = 0

    async def pulse(self, name):
        getattr(self.dut, name).value = 1
        await FallingEdge(self.dut.clk)
        getattr(self.dut, name).value = 0

    async def close(self, bank, periods, final=0, bounds=EVERY, beyond=None):
        """Shape, bounds and close; whether the bank is closed then."""
        dut = self.dut
        await self.write(3, bank << 3, periods << 16 | final << 13)
        for axis, side in bounds:
            await self.write(3, axis << 5 | side << 4 | bank << 3 | 4, 0, (axis, side) == beyond)
        dut.load_space.value, dut.load_index.value = 7, bank
        await self.pulse("close")
        assert (dut.outside.value == 1) != bool(dut.closed.value.to_unsigned() >> bank & 1)
        return dut.outside.value == 0

    async def writable(self):
        """Which banks may be written, by space 0 to 3; and space 5."""
        found = []
        for space, bit in ((0, 8), (1, 9), (2, 9), (3, 3)):
            for bank in range(2):
                self.dut.load_space.value, self.dut.load_index.value = space, bank << bit
                await FallingEdge(self.dut.clk)
                found.append(int(self.dut.writable.value))
        self.dut.load_space.value = 5
        await FallingEdge(self.dut.clk)
        return found, int(self.dut.writable.value)


@cocotb.test(**WATCHDOG)
async def numbers_come_back(dut):
    banks, rng = Banks(dut), np.random.default_rng(SEED)
    await reset(dut)
    await FallingEdge(dut.clk)
    kept = {}
    for space, places in ((0, 512), (2, 1024)):
        for index in rng.permutation(places)[:200].tolist():
            if space == 0 and index % 8 == 6:
                continue
            kept[space, index] = int(rng.integers(-(1 << WORD - 1), 1 << WORD - 1))
            await banks.write(space, index, kept[space, index])
    lengths = {piece: int(rng.integers(1 << 63)) for piece in range(0, 64, 7)}
    for piece, length in lengths.items():
        await banks.write(0, piece << 3 | 6, length)
    for (space, index), value in kept.items():
        ask, answer = ((dut.metric_at, dut.metric), (dut.coefficient_at, dut.coefficient))[space // 2]
        ask.value = index
        dut.root_at.value = index & 511
        await FallingEdge(dut.clk)
        assert answer.value.to_signed() == value
        if space == 0:
            assert dut.root.value.to_unsigned() == value & (1 << WORD) - 1
    for piece, length in lengths.items():
        dut.length_at.value = piece
        await FallingEdge(dut.clk)
        assert dut.length.value.to_unsigned() == length
    for bank in range(2):
        await banks.write(3, bank << 3, 1 << 12 | 77 << 5 | 13 + bank)
    assert dut.last_piece.value.to_unsigned() == 14 << 5 | 13
    assert dut.last_record.value.to_unsigned() == 77 << 7 | 77
    assert dut.cubic.value.to_unsigned() == 3
    await banks.write(3, 0, 0)
    assert dut.cubic.value.to_unsigned() == 2
    for axis in range(DIM):
        await banks.write(3, 1 + axis, 5 + axis)
    assert dut.end_point.value.to_unsigned() == 6 << WORD | 5


@cocotb.test(**WATCHDOG)
async def banks_close_and_open(dut):
    banks = Banks(dut)
    await reset(dut)
    await FallingEdge(dut.clk)
    assert dut.starved.value == 0
    await banks.write(5, 6, 10)
    for missing in EVERY:
        assert not await banks.close(0, 8, bounds=[which for which in EVERY if which != missing])
        assert not await banks.close(0, 8, beyond=missing)
    for limit in (4, 8, 11):  # a limit that comes after the bounds
        for axis, side in EVERY:
            await banks.write(3, axis << 5 | side << 4 | 4)
        await banks.write(5, limit)
        assert not await banks.close(0, 8, bounds=())
    assert await banks.close(0, 9, bounds=(*EVERY, *THIRD))
    assert await banks.writable() == ([1] * 8, 1)
    dut.busy.value = 1
    await banks.pulse("begins")
    assert await banks.writable() == ([0, 1] * 4, 0)
    assert dut.starved.value == 1  # 9 of the reserve of 10
    assert await banks.close(1, 7)
    assert dut.starved.value == 0
    assert await banks.writable() == ([0] * 8, 0)
    dut.feed_bank.value = 1
    await FallingEdge(dut.clk)
    assert dut.closed.value == 3
    dut.point_bank.value = 1
    await FallingEdge(dut.clk)
    assert dut.closed.value == 2
    for taken in range(16):
        assert dut.starved.value == (16 - taken < 10)
        await banks.pulse("period_taken")
    assert await banks.close(0, 3, final=1)
    assert dut.starved.value == 0
    dut.busy.value, dut.done.value = 0, 1
    await FallingEdge(dut.clk)
    dut.done.value = 0
    await FallingEdge(dut.clk)
    assert dut.closed.value == 0
