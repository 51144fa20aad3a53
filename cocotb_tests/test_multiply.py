"""Bench of rtl/multiply.v: exact, a pair a cycle, two or three cycles later."""

from itertools import product

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, drive, extremes, signed, simulate


@pytest.mark.parametrize(("word", "latency"), [(9, 2), (21, 3), (35, 2), (35, 3)])
def test_multiply(word, latency):
    simulate("multiply", __file__, WORD=word, LATENCY=latency)


@cocotb.test(**WATCHDOG)
async def stream_of_pairs(dut):
    """A new pair at every cycle; each product some cycles after its operands were sampled."""
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    numbers = extremes(np.random.default_rng(SEED), len(dut.a), 40)
    pairs, latency = list(product(numbers, numbers)), dut.LATENCY.value.to_unsigned()
    await RisingEdge(dut.clk)
    for i in range(len(pairs) + latency):
        a, b = pairs[i] if i < len(pairs) else (0, 0)
        drive(dut.a, a)
        drive(dut.b, b)
        await RisingEdge(dut.clk)
        if i >= latency:
            a, b = pairs[i - latency]
            assert signed(dut.product) == a * b
