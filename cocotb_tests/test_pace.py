"""Bench of rtl/pace.v: every distance equals the twin's, whatever the override does."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.bench import SEED, WATCHDOG, drive, reset, simulate
from nurbs_lab.hardware.exact import paced


@pytest.mark.parametrize("word", [21, 35])
def test_pace(word):
    simulate("pace", __file__, WORD=word)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    rng, width = np.random.default_rng(SEED), len(dut.distance)
    dut.take.value = dut.in_valid.value = dut.load.value = 0
    await reset(dut)
    for slew in (65535, 700, 9000, 20000):
        dut.rst.value = dut.load.value = 1
        drive(dut.load_data, slew)
        await RisingEdge(dut.clk)
        dut.rst.value = dut.load.value = 0
        moves = rng.integers(0, 1 << width - 12, 40).tolist()
        rates, found, number, last = [], [], 0, False
        wanted = 256
        while not last:
            await FallingEdge(dut.clk)
            dut.take.value = 0
            ready = number < len(moves) and rng.random() < 0.7
            dut.in_valid.value = int(ready)
            if ready:
                drive(dut.in_distance, moves[number])
                dut.in_last.value = int(number == len(moves) - 1)
            if rng.random() < 0.05:
                wanted = int(rng.choice([0, 256, rng.integers(0, 300)]))
            if len(rates) > 150:
                wanted = 256
            dut.rate.value = wanted
            dut.take.value = int(dut.valid.value == 1 and rng.random() < 0.8)
            await RisingEdge(dut.clk)
            if dut.take.value == 1:
                found.append(dut.distance.value.to_unsigned())
                last = dut.is_last.value == 1
            if dut.sampled.value == 1:
                rates.append(wanted)
            number += dut.in_take.value == 1
        assert found == list(paced(moves, rates, slew))
        assert sum(found) == sum(moves)
