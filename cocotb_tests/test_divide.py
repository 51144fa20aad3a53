"""Bench of rtl/divide.v: every case of a small width, extremes of the shipped one, never a reset between."""

from itertools import product

import cocotb
import pytest

from cocotb_tests.bench import WATCHDOG, Unit, extremes, signed, simulate
from nurbs_lab.hardware.arithmetic import divide


@pytest.mark.parametrize("word", [5, 7, 35])
def test_divide(word):
    simulate("divide", __file__, WORD=word)


def cases(dut, rng):
    word = len(dut.denominator)
    if word < 9:
        return product(range(-(1 << 9), 1 << 9), range(1 << word))
    numerators = extremes(rng, 2 * word, 60)
    denominators = extremes(rng, word, 20, sign=False)
    return [
        *product(numerators, denominators),
        # Ties: an odd number of halves.
        *(((2 * q + 1) * d, 2 * d) for q in (0, -1, 5, -8) for d in (1, 3, 1 << 20)),
    ]


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, ["numerator", "denominator"])
    await unit.reset()
    word = len(dut.denominator)
    for numerator, denominator in cases(dut, unit.rng):
        clocks = await unit.ask(numerator, denominator)
        found = signed(dut.quotient), dut.overflow.value == 1, dut.by_zero.value == 1
        assert found == divide(numerator, denominator, word), (numerator, denominator)
        assert clocks == (word + 3) // 4 + 1


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = Unit(dut, ["numerator", "denominator"])
    await unit.reset()
    await unit.cut_short(100, 3, after=5)
    await unit.ask(-14, 4)
    assert signed(dut.quotient) == -4
