"""Bench of rtl/differences.v, which has no clock."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import Timer

from cocotb_tests.bench import SEED, WATCHDOG, drive, extremes, signed, simulate
from nurbs_lab.hardware.stepper import DIFFERENCES


@pytest.mark.parametrize("word", [17, 35])
def test_differences(word):
    simulate("differences", __file__, WORD=word)


def samples_of(word, rng):
    """Any five numbers; five near each other; some whose difference is the last that fits, or one beyond."""
    numbers, limit = extremes(rng, word, 100), 1 << (word - 1)
    for _ in range(500):
        yield [int(x) for x in rng.choice(numbers, 5)]
        yield [int(rng.choice(numbers)) // 2 + int(step) for step in rng.integers(-99, 99, 5)]
    for target in (limit - 1, limit, -limit, -limit - 1):
        newest = target % 3  # 25 = 1 (mod 3), so the oldest alone, thrice, gives the rest
        yield [newest, 0, 0, 0, (target - 25 * newest) // 3]


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    word = dut.WORD.value.to_unsigned()
    limit, flags = 1 << (word - 1), []
    for samples in samples_of(word, np.random.default_rng(SEED)):
        for i, sample in enumerate(samples):
            drive(getattr(dut, f"x_{i}"), sample)
        await Timer(1, "ns")
        expected = sum(factor * sample for factor, sample in zip(DIFFERENCES, samples, strict=True))
        flags.append(dut.overflow.value == 1)
        assert flags[-1] == (not -limit <= expected < limit)
        assert flags[-1] or signed(dut.difference) == expected
    assert flags[-4:] == [False, True, False, True]
