"""Bench of rtl/runge_kutta.v, with Python in the place of its row."""

import cocotb
import pytest
from cocotb.triggers import RisingEdge

from cocotb_tests.bench import WATCHDOG, Unit, packed, signed, simulate
from cocotb_tests.rows import Rows
from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, evaluate_cu
from nurbs_lab.hardware.arithmetic import round_shift
from nurbs_lab.hardware.stepper import Twin


@pytest.mark.parametrize("cached", [0, 1])
def test_runge_kutta(cached):
    simulate("runge_kutta", __file__, DIM=2, CACHED=cached)


def shifted(dut, row, slopes):
    """The points of an order: u and the u before, moved by the latest slope."""
    factor = 24 if dut.row_whole.value else 12 if dut.row_half.value else 0
    move = round_shift(factor * slopes[0], 8)
    return dut.u.value.to_unsigned() + move, dut.u_before.value.to_unsigned() + move


async def keep(dut, rows, kept):
    """The row's point in every clock of point_done."""
    while True:
        await RisingEdge(dut.clk)
        if dut.point_done.value == 1:
            kept.append(rows.point)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    names = "first u u_before point_before s_now s_half s_whole first_du first_chord"
    unit = Unit(dut, names.split(), held=True)
    await unit.reset()
    feed = plan_feed(paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    plan = build_program(paper.CURVE, feed, 1e-3, 2000)
    twin, loaded = Twin(plan), plan.curve
    rows = Rows(dut, loaded, unit.rng, shifted)
    kept = []
    cocotb.start_soon(keep(dut, rows, kept))
    for step in range(40):
        u = int(unit.rng.integers(1 << 24, loaded.last_u - (1 << 24)))
        before = u - int(unit.rng.integers(1 << 16, 1 << 23))
        s = [int(distance) for distance in unit.rng.integers(1 << 18, 1 << 26, 3)]
        first = step % 5 == 0
        here, earlier = evaluate_cu(loaded, u).point, evaluate_cu(loaded, before).point
        await unit.ask(first, u, before, packed(earlier, 35), *s, plan.first_du, plan.first_chord)
        k, u_next = twin.runge_kutta(u, here, [] if first else [before], [earlier], s)
        assert signed(dut.k) == k
        assert dut.u_next.value.to_unsigned() == u_next
        assert kept.pop() == here
        assert not kept
    assert rows.orders == 4 * 40
