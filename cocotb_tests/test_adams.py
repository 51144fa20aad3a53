"""Bench of rtl/adams.v in every arrangement, with Python in the place of its rows."""

import cocotb
import pytest
from cocotb.triggers import RisingEdge

from cocotb_tests.bench import WATCHDOG, Unit, packed, signed, simulate
from cocotb_tests.rows import Rows, field
from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, evaluate_cu
from nurbs_lab.hardware.stepper import Twin

#: Orders a step, by arrangement.
ORDERS = {0: 4, 1: 1, 2: 1}


@pytest.mark.parametrize("arrangement", [0, 1, 2])
def test_adams(arrangement):
    rows = 4 if arrangement == 1 else 1
    simulate("adams", __file__, DIM=2, ARRANGEMENT=arrangement, ROWS=rows)


def ends(dut, row, slopes):
    """The points of an order."""
    return field(dut.row_u_a, 34, row), field(dut.row_u_b, 34, row)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    unit = Unit(dut, [], held=True)
    dut.push.value = 0
    await unit.reset()
    arrangement = dut.ARRANGEMENT.value.to_unsigned()
    feed = plan_feed(paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    plan = build_program(paper.CURVE, feed, 1e-3, 2000)
    twin, loaded = Twin(plan), plan.curve
    rows = Rows(dut, loaded, unit.rng, ends, count=len(dut.row_done))
    u, s, past = int(0.15 * 2**33), 5_000_000, []
    for _ in range(60):
        dut.u.value, dut.s.value = u, s
        here = evaluate_cu(loaded, u).point
        if not past:
            k, ahead = 0, u + 3_000_000
        elif len(past) < 4:
            k = twin.kout(s, u - past[0][0], twin.chord(here, past[0][1]))
            ahead = twin.shifted(u, 24 * k)
        else:
            old_u, old_points, old_k = ([row[i] for row in past[:4]] for i in range(3))
            await unit.ask()
            k, ahead = twin.adams(u, here, old_u, old_points, old_k[:3], s)
            assert signed(dut.k) == k
            assert dut.u_next.value.to_unsigned() == ahead
        dut.push.value = 1
        dut.push_point.value, dut.push_k.value = packed(here, 35), k
        await RisingEdge(dut.clk)
        dut.push.value = 0
        past, u, s = [(u, here, k), *past], ahead, s + int(unit.rng.integers(-9999, 9999))
    assert rows.orders == 56 * ORDERS[arrangement]
