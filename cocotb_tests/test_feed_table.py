"""Bench of rtl/feed_table.v: every distance of every record, taken at once and with pauses."""

import cocotb
import pytest
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.bench import WATCHDOG, Unit, drive, simulate


@pytest.mark.parametrize("word", [21, 35])
def test_steps(word):
    simulate("feed_table", __file__, WORD=word)


@cocotb.test(**WATCHDOG)
async def equals_the_sums(dut):
    unit = Unit(dut, [])
    dut.take.value = dut.load.value = dut.final_bank.value = dut.closed.value = 0
    await unit.reset()
    width, rng = len(dut.distance), unit.rng
    for pauses in (0.0, 0.6):
        top = 1 << width - 8
        terms = rng.integers(-top // 64, top // 64, (20, 3)).tolist()
        records = [(int(rng.integers(1, 9)), *row) for row in terms]
        dut.load.value = 1
        first = int(rng.integers(1, 20))  # in bank 0; bank 1 has the rest, and comes late
        for n, record in enumerate(records):
            place = n if n < first else 128 + n - first
            for i, value in enumerate(record):
                dut.load_index.value = place << 2 | i
                drive(dut.load_data, value)
                await RisingEdge(dut.clk)
        dut.last_record.value = (len(records) - first - 1) << 7 | first - 1
        dut.closed.value, dut.final_bank.value = 1, 2
        dut.load.value, dut.start.value = 0, 1
        await RisingEdge(dut.clk)
        dut.start.value = 0
        for n, (periods, d, e, f) in enumerate(records):
            for left in range(periods, 0, -1):
                waited = 0
                await FallingEdge(dut.clk)
                while dut.valid.value == 0 or rng.random() < pauses:
                    waited += dut.valid.value == 0
                    awaited = n == first and left == periods and waited < 20
                    dut.closed.value = 1 if n < first or awaited else 3
                    await FallingEdge(dut.clk)
                assert waited <= (6 if n != first or left != periods else 26)
                assert dut.distance.value.to_signed() == d
                assert dut.is_last.value == (left == 1 and n == len(records) - 1)
                d, e = d + e, e + f
                dut.take.value = 1
                await RisingEdge(dut.clk)
                dut.take.value = 0
        await FallingEdge(dut.clk)
        assert dut.valid.value == 0
