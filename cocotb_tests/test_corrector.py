"""Bench of rtl/corrector.v, with Python in the place of its row."""

from dataclasses import replace

import cocotb
from cocotb.triggers import FallingEdge

from cocotb_tests.bench import WATCHDOG, Unit, drive, signed, simulate, unknown
from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, evaluate_cu
from nurbs_lab.hardware.arithmetic import divide, square_root
from nurbs_lab.hardware.stepper import Twin

OPERANDS = ["trials", "u", "last_u", "predicted", "s_now", "s_half", "s_whole"]
TOP = (1 << 34) - 1


def test_corrector():
    simulate("corrector", __file__, WORD=35)


class Row:
    """Answers each order with K of the chord from C(u), after any number of cycles; X until then."""

    def __init__(self, dut, loaded, rng):
        self.dut, self.loaded, self.rng, self.orders = dut, loaded, rng, 0
        self.faults = {}  # order -> flags (overflow, by_zero) to answer it with
        self.answers = dut.row_k, dut.row_overflow, dut.row_by_zero
        self.rest()
        cocotb.start_soon(self.serve())

    def rest(self):
        self.dut.row_done.value = 0
        for handle in self.answers:
            unknown(handle)

    async def serve(self):
        dut = self.dut
        while True:
            await FallingEdge(dut.clk)
            if dut.row_start.value != 1:
                continue
            self.orders += 1
            here, ahead = (evaluate_cu(self.loaded, p.value.to_unsigned()).point for p in (dut.u, dut.guess))
            chord = square_root(sum((a - b) ** 2 for a, b in zip(ahead, here, strict=True)))
            k, *flags = divide(dut.row_s.value.to_unsigned() * signed(dut.row_du), chord, 35)
            flags = self.faults.get(self.orders, flags)
            for _ in range(int(self.rng.integers(0, 9))):
                await FallingEdge(dut.clk)
            drive(dut.row_k, k)
            dut.row_overflow.value, dut.row_by_zero.value = map(int, flags)
            dut.row_done.value = 1
            await FallingEdge(dut.clk)
            self.rest()


async def ready(dut):
    """A reset corrector with its row, and the twin of the paper's path."""
    unit = Unit(dut, OPERANDS, held=True)
    feed = plan_feed(paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    twin = Twin(build_program(paper.CURVE, feed, 1e-3, 2000), False)
    row = Row(dut, twin.curve, unit.rng)
    await unit.reset()
    return unit, twin, row


async def check(unit, twin, trials, u, guess, speeds, flags=(False, False)):
    """Compare with the twin, or the flags with those expected."""
    twin.program = replace(twin.program, trials=trials)
    dut = unit.dut
    await unit.ask(trials, u, twin.curve.last_u, guess, *speeds)
    assert (dut.overflow.value == 1, dut.by_zero.value == 1) == flags
    if not any(flags):
        expected = twin.correct(u, evaluate_cu(twin.curve, u).point, guess, speeds)
        assert dut.guess.value.to_unsigned() == expected


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    """Steps of every size, forwards, backwards, at rest and beyond the end, for all numbers of trials."""
    unit, twin, row = await ready(dut)
    last_u, orders = twin.curve.last_u, set()
    for _ in range(400):
        trials = int(unit.rng.integers(0, 8))
        u = int(unit.rng.integers(0, last_u))
        move = int(unit.rng.integers(1, 1 << int(unit.rng.integers(1, 30))))
        guess = min(max(u + move * int(unit.rng.choice([1, 1, 1, 0, -1])), 0), TOP)
        speeds = [int(s) for s in unit.rng.integers(0, 1 << int(unit.rng.integers(4, 32)), 3)]
        before = row.orders
        await check(unit, twin, trials, u, guess, speeds)
        orders.add(row.orders - before)
    assert orders == set(range(8))


@cocotb.test(**WATCHDOG)
async def flags_come_and_go(dut):
    """Those of the row in any trial, and that of speeds whose sum does not fit; the next step is clean."""
    unit, twin, row = await ready(dut)
    u, guess, sixth = 1 << 30, (1 << 30) + (1 << 28), TOP // 6
    fits = [sixth, sixth, TOP - 5 * sixth]
    for trial in (1, 2, 3):
        for flags in ((True, False), (False, True)):
            row.faults = {row.orders + trial: flags}
            await check(unit, twin, 3, u, guess, [5_000_000] * 3, flags)
            await check(unit, twin, 3, u, guess, [5_000_000] * 3)
    await check(unit, twin, 1, u, guess, fits)
    await check(unit, twin, 1, u, guess, [*fits[:2], fits[2] + 1], (True, False))
    await check(unit, twin, 1, u, guess, fits)


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit, twin, _ = await ready(dut)
    u, guess, speeds = 1 << 30, (1 << 30) + 5_000_000, [5_000_000] * 3
    for cycles in range(12):
        # The reset is held until the row has answered too.
        await unit.cut_short(3, u, twin.curve.last_u, guess, *speeds, after=cycles + 1, held=10)
        await check(unit, twin, 2, u, guess, speeds)
