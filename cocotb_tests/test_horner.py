"""Bench of rtl/horner.v: points of random pieces, rounded level by level, and cycles."""

from fractions import Fraction

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, packed, simulate, words
from nurbs_lab.hardware.arithmetic import round_shift


@pytest.mark.parametrize(("dim", "word"), [(2, 35), (3, 25)])
def test_horner(dim, word):
    simulate("horner", __file__, DIM=dim, WORD=word)


@cocotb.test(**WATCHDOG)
async def points_of_pieces(dut):
    word, dim = dut.WORD.value.to_unsigned(), dut.DIM.value.to_unsigned()
    rng, mask = np.random.default_rng(SEED), (1 << word) - 1
    dut.run.value = dut.jump.value = 0
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    await RisingEdge(dut.clk)
    await FallingEdge(dut.clk)
    for n in range(150):
        most = 1 << word - 4
        piece = rng.integers(-most, most, (dim, 4)).tolist()
        t = [0, (1 << word - 1) - 1, int(rng.integers(1 << word - 1))][min(n, 2)]
        if n == 3:  # an error of 1.4975 of 1.5 at 35 bits
            piece[0], t = [0, 3 << word - 3, 0, -1 << word - 5], 17178386328 >> 35 - word
        dut.t.value, dut.clear.value = t, 1
        await FallingEdge(dut.clk)
        dut.clear.value, dut.run.value = 0, 1
        cycles, ends = 0, False
        while not ends:
            cycles += 1
            axis, power = divmod(dut.asks_for.value.to_unsigned(), 4)
            ends = dut.ends.value == 1
            await FallingEdge(dut.clk)
            dut.coefficient.value = piece[axis][power] & mask if axis < dim else 0
            assert dut.pending.value == 1
        dut.run.value = 0
        await FallingEdge(dut.clk)
        assert (cycles, dut.pending.value) == (9 + dim, 0)
        expected = []
        for a in piece:
            x = a[3]
            for c in a[2::-1]:
                x = round_shift(x * t, word - 1) + c
            expected.append(x)
            part = Fraction(t, 1 << word - 1)
            exact = sum(c * part**power for power, c in enumerate(a))
            assert abs(x - exact) <= (1 + part + part**2) / 2
        assert words(dut.point.value.to_unsigned(), word, dim) == tuple(expected)
    target = rng.integers(-(1 << word - 1), 1 << word - 1, dim).tolist()
    dut.target.value, dut.jump.value = packed(target, word), 1
    await FallingEdge(dut.clk)
    assert words(dut.point.value.to_unsigned(), word, dim) == tuple(target)
