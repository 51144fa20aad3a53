"""Bench of rtl/multiply.v: exact, a pair a clock, three clocks later."""

from itertools import product

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, drive, extremes, signed, simulate


@pytest.mark.parametrize("word", [9, 21, 35])
def test_multiply(word):
    simulate("multiply", __file__, WORD=word)


@cocotb.test(**WATCHDOG)
async def stream_of_pairs(dut):
    """A new pair at every clock; each product three clocks after its operands were sampled."""
    Clock(dut.clk, CLOCK_NS, unit="ns").start()
    numbers = extremes(np.random.default_rng(SEED), len(dut.a), 40)
    pairs = list(product(numbers, numbers))
    for i in range(len(pairs) + 3):
        a, b = pairs[i] if i < len(pairs) else (0, 0)
        drive(dut.a, a)
        drive(dut.b, b)
        await RisingEdge(dut.clk)
        if i >= 3:
            a, b = pairs[i - 3]
            assert signed(dut.product) == a * b
