"""Bench of rtl/boards/step_dir.v: sums are exact over a million steps, pulses keep their times at every turn.

The checks in every cycle are Verilog, for speed: rtl/boards/simulation/step_dir_run.v.
"""

import cocotb
import pytest
from cocotb.triggers import RisingEdge, Timer

from cocotb_tests.bench import SEED, WATCHDOG, simulate

CLOCK_HZ = 50e6


@pytest.mark.parametrize(
    ("pulse", "setup", "period", "steps"),
    [(1, 2, 250, 1_000_000), (2, 12, 125, 50_000), (50, 50, 50_000, 3000)],
    ids=str,
)
def test_step_dir(pulse, setup, period, steps):
    simulate("step_dir_run", __file__, PULSE=pulse, SETUP=setup, PERIOD=period, STEPS=steps, SEED=SEED)


@cocotb.test(**WATCHDOG)
async def every_step_is_made(dut):
    """Of at least as many as asked, and not one too many; as shipped at more than 400 kHz."""
    await RisingEdge(dut.finished)
    await Timer(1, "ns")
    assert int(dut.wrong.value) == 0
    assert dut.pins.value.to_signed() == dut.expected.value.to_signed()
    pulse = dut.PULSE.value.to_unsigned()
    fewest = int(dut.fewest.value)
    assert 2 * pulse <= fewest <= 2 * pulse + 2
    if pulse == 50:
        assert CLOCK_HZ / fewest > 400e3
