"""Bench of rtl/divide.v: every case of a small width, extremes and ties of others, never a reset between."""

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
    if word == 5:
        return product(range(-(1 << 9), 1 << 9), range(1 << word))
    numerators = extremes(rng, 2 * word, 60)
    denominators = extremes(rng, word, 20, sign=False)
    # Ties, an odd number of halves, and their neighbours.
    largest = (1 << word - 1) - 1
    halves = product((0, 1, 5, largest - 1, largest, -1, -2, -8, -largest), (1, 3, (1 << word - 1) - 1))
    ties = [((2 * q + 1) * d + step, 2 * d) for q, d in halves for step in (-1, 0, 1)]
    return [*product(numerators, denominators), *ties]


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, ["numerator", "denominator"])
    await unit.reset()
    word = len(dut.denominator)
    for numerator, denominator in cases(dut, unit.rng):
        cycles = await unit.ask(numerator, denominator)
        found = signed(dut.quotient), dut.overflow.value == 1, dut.by_zero.value == 1
        assert found == divide(numerator, denominator, word), (numerator, denominator)
        assert cycles == (word + 3) // 4 + 1


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = Unit(dut, ["numerator", "denominator"])
    await unit.reset()
    await unit.cut_short(100, 3, after=5)
    await unit.ask(-14, 4)
    assert signed(dut.quotient) == -4
