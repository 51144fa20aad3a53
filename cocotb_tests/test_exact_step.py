"""Bench of rtl/exact_step.v: equal to its twin bit for bit, in 17 or 24 cycles."""

import cocotb
import pytest
from cocotb.triggers import FallingEdge

from cocotb_tests.bench import WATCHDOG, Unit, drive, simulate
from cocotb_tests.curves import exact_curve
from nurbs_lab import plan_feed
from nurbs_lab.hardware import Format, build_exact_program
from nurbs_lab.hardware.exact import advance
from nurbs_lab.hardware.exact_program import T_GUARD, is_cubic


@pytest.mark.parametrize("word", [25, 35])
def test_exact_step(word):
    simulate("exact_step", __file__, WORD=word)


class StepUnit(Unit):
    """Holds the operands, and answers for the memory of the coefficients."""

    piece = None

    async def serve(self):
        dut, asked = self.dut, 0
        while True:
            await FallingEdge(dut.clk)
            if self.piece is not None:
                drive(dut.metric, self.piece.metric[asked])
            asked = min(dut.coefficient.value.to_unsigned(), 4)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = StepUnit(dut, ["cubic", "t", "y", "ds", "shift"], held=True)
    dut.metric.value = 0
    await unit.reset()
    cocotb.start_soon(unit.serve())
    word = dut.WORD.value.to_unsigned()
    bits, found = word - 1, set()
    for degree in (1, 2, 3):
        curve = exact_curve(unit.rng, degree, 2)
        feed = plan_feed(curve, speed=1.0, acceleration=50.0, period_s=1e-3)
        program = build_exact_program(curve, feed, 1e-3, format=Format(word))
        for _ in range(60):
            unit.piece = program.pieces[unit.rng.integers(len(program.pieces))]
            y = min(int(unit.piece.root * unit.rng.uniform(0.9, 1.1)), (1 << bits) - 1)
            t = int(unit.rng.uniform(0, 0.99) * (1 << bits + T_GUARD))
            ds = int(unit.rng.uniform(0, 1) ** 3 * (1 << bits)) if unit.rng.random() < 0.9 else 0
            ds = min(ds, (1 << bits - 6 + unit.piece.shift + T_GUARD) // y)  # at most 1/64 of the piece
            cycles = await unit.ask(is_cubic(program.pieces), t, y, ds, unit.piece.shift)
            t_next, y_next, h = advance(unit.piece, t, y, ds, bits, is_cubic(program.pieces))
            assert dut.t_next.value.to_unsigned() == t_next
            assert dut.y_next.value.to_unsigned() == y_next % (1 << bits)
            steep = not -1 << bits - 8 <= h < 1 << bits - 8
            assert dut.unsettled.value == steep
            assert cycles == (24 if is_cubic(program.pieces) else 17)
            found.add((is_cubic(program.pieces), steep))
    assert len(found) == 4


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = StepUnit(dut, ["cubic", "t", "y", "ds", "shift"], held=True)
    dut.metric.value = 0
    await unit.reset()
    for cycles in (1, 5, 16, 17):
        await unit.cut_short(0, 0, 1, 0, 9, after=cycles)
        assert await unit.ask(1, 0, 1, 0, 9) == 24
