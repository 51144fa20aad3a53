"""Bench of rtl/ui_out.v, which has no clock."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import Timer

from cocotb_tests.bench import SEED, WATCHDOG, drive, extremes, simulate
from nurbs_lab.hardware.arithmetic import round_shift
from nurbs_lab.hardware.stepper import ADAMS, RUNGE_KUTTA


@pytest.mark.parametrize("adams", [0, 1])
def test_ui_out(adams):
    simulate("ui_out", __file__, WORD=35, ADAMS=adams)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    rng = np.random.default_rng(SEED)
    word = dut.WORD.value.to_unsigned()
    numbers = extremes(rng, word, 100)
    factors = ADAMS if dut.ADAMS.value.to_unsigned() else RUNGE_KUTTA
    top = (1 << (word - 1)) - 1
    parameters = extremes(rng, word - 1, 50, False)
    for _ in range(1000):
        u = int(rng.choice(parameters))
        slopes = [int(k) for k in rng.choice(numbers, 4)]
        drive(dut.u, u)
        for i, k in enumerate(slopes):
            drive(getattr(dut, f"k_{i}"), k)
        await Timer(1, "ns")
        moved = u + round_shift(sum(f * k for f, k in zip(factors, slopes, strict=True)), 8)
        assert dut.u_next.value.to_unsigned() == min(max(moved, 0), top)
