"""Bench of rtl/square_root.v: every case of a small width, extremes of the shipped one."""

import cocotb
import pytest

from cocotb_tests.bench import WATCHDOG, Unit, extremes, simulate
from nurbs_lab.hardware.arithmetic import square_root


@pytest.mark.parametrize("word", [5, 35])
def test_square_root(word):
    simulate("square_root", __file__, WORD=word)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, ["radicand"])
    await unit.reset()
    width = len(dut.radicand)
    near = [
        root * root + step
        for root in extremes(unit.rng, width // 2, 50, False)
        for step in (0, root, root + 1)
    ]
    for radicand in range(1 << width) if width == 10 else [*extremes(unit.rng, width, 300, False), *near]:
        cycles = await unit.ask(radicand)
        assert dut.root.value.to_unsigned() == square_root(radicand), radicand
        assert cycles == (width // 2 + 4) // 4 + 1


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = Unit(dut, ["radicand"])
    await unit.reset()
    await unit.cut_short(99, after=5)
    await unit.ask(144)
    assert dut.root.value.to_unsigned() == 12
