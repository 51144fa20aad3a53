"""Bench of rtl/kout.v; the chord is X from the cycle after the start on."""

import cocotb
import pytest

from cocotb_tests.bench import WATCHDOG, Unit, extremes, packed, signed, simulate, unknown
from nurbs_lab.hardware.arithmetic import divide, square_root


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (35, 3), (21, 3)])
def test_kout(word, dim):
    simulate("kout", __file__, WORD=word, DIM=dim)


class ChordUnit(Unit):
    """Holds s and du until done, as kout asks, and takes the chord away after the start."""

    async def begin(self, *values):
        await super().begin(*values)
        unknown(self.dut.chord)


def twin(s, du, chord, word):
    return divide(s * du, square_root(sum(x * x for x in chord)), word)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    """Extremes and random operands; both flags are met, and leave nothing behind."""
    unit = ChordUnit(dut, ["s", "du", "chord"], held=True)
    await unit.reset()
    word, dim = len(dut.s) + 1, dut.DIM.value.to_unsigned()
    numbers, distances = extremes(unit.rng, word, 30), extremes(unit.rng, word - 1, 30, False)
    flags = set()
    for _ in range(700):
        s, du = (int(unit.rng.choice(values)) for values in (distances, numbers))
        chord = [int(x) for x in unit.rng.choice(numbers, dim)] if unit.rng.random() < 0.95 else [0] * dim
        cycles = await unit.ask(s, du, packed(chord, word))
        found = signed(dut.k), dut.overflow.value == 1, dut.by_zero.value == 1
        assert found == twin(s, du, chord, word), (s, du, chord)
        assert cycles == dim + 2 + (word + 4) // 4 + 1 + (word + 3) // 4 + 1
        flags.add(found[1:])
    assert flags == {(False, False), (True, False), (False, True)}


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = Unit(dut, ["s", "du", "chord"], held=True)
    await unit.reset()
    word, dim = len(dut.s) + 1, dut.DIM.value.to_unsigned()
    for cycles in range(0, 23, 3):
        await unit.cut_short(7, 7, packed([3] * dim, word), after=cycles + 1)
        await unit.ask(1000, 30, packed([-30, 40] + [0] * (dim - 2), word))
        assert signed(dut.k) == 600
