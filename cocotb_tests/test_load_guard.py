"""Bench of rtl/load_guard.v: what cannot be right raises bad, what is right does not."""

import cocotb
from cocotb.triggers import RisingEdge

from cocotb_tests.bench import WATCHDOG, drive, reset, simulate
from nurbs_lab import paper
from nurbs_lab.hardware import build_program
from nurbs_lab.hardware.interpolator import close_load
from nurbs_lab.motion.feed import constant_feed

ONE = 1 << 33


def test_load_guard():
    simulate("load_guard", __file__, WORD=35, DIM=2, RATIONAL=0)


WRONG = {
    "a knot below the one before": (0, 1, 0),
    "a knot before its turn": (0, 2, ONE),
    "a coordinate before its turn": (2, 4, 0),
    "a knot above 1": (0, 1, ONE + 1),
    "too many knots": (0, 70, ONE),
    "a reciprocal of level 6": (1, 5 << 7, 1),
    "a coordinate too large": (2, 0, 1 << 34),
    "a coordinate too small": (2, 0, -(1 << 34) - 1),
    "a weight of 0": (2, 3, 0),
    "a weight below 1/1024": (2, 3, (ONE >> 10) - 1),
    "a wrong checksum": (7, 0, 1),
    "no largest step": (5, 4, 0),
    "a negative weight": (2, 3, -1),
    "a weight above 1": (2, 3, ONE + 1),
    "too many points": (2, 64 << 2, 0),
    "degree 0": (3, 0, 6 << 3),
    "degree 6": (3, 0, 6 << 3 | 6),
    "fewer points than the degree needs": (3, 0, 1 << 3 | 2),
    "more points than fit": (3, 0, 64 << 3 | 2),
    "weights without a divider": (3, 0, 1 << 10 | 6 << 3 | 2),
    "a domain beyond the knots": (3, 2, ONE + 1),
    "a speed too wide": (4, 1, 1 << 61),
    "a change of speed too wide": (4, 2, -(1 << 61) - 1),
    "a record with too many samples": (4, 4, 1 << 32),
    "no period": (5, 0, 0),
    "a number that is not there": (5, 1, 8),
    "an unknown space": (6, 0, 0),
    "nothing to close": (7, 0, 0),
    "an unknown index": (5, 5, 1),
}


@cocotb.test(**WATCHDOG)
async def every_mistake_is_seen(dut):
    dut.load.value = dut.clear.value = 0
    await reset(dut)
    good = build_program(paper.CURVE, constant_feed(paper.CURVE.length(), 4.0, 1e-3), 1e-3, 2000).batches()[0]
    good += [(4, 1, (1 << 61) - 1), (4, 2, -(1 << 61)), (4, 4, (1 << 32) - 1)]  # the largest that are right
    good = [(*at, ONE >> 10 if at == [2, 3] else data) for *at, data in good]  # the smallest weight
    good.append(close_load(good))
    begun = [(0, 0, ONE), (2, 0, 0), (2, 1, 0)]

    async def write(writes):
        dut.load.value = 1
        for space, index, data in writes:
            dut.space.value, dut.index.value = space, index
            drive(dut.data, data)
            await RisingEdge(dut.clk)
        dut.load.value = 0
        await RisingEdge(dut.clk)

    for name, wrong in WRONG.items():
        dut.clear.value = 1
        await RisingEdge(dut.clk)
        dut.clear.value = 0
        await write(good)
        assert (dut.bad.value, dut.ready.value) == (0, 1), name
        await write([wrong] if wrong[0] == 7 and not wrong[2] else [*begun, wrong])
        assert (dut.bad.value, dut.ready.value) == (1, 0), name
        await write(good)
        assert dut.bad.value == 1, "bad is sticky"

    # What a run needs: without one of it nothing is ready, whatever else is loaded, before it and with it.
    turns = {write[:2] for write in good if write[0] in (0, 2)}
    latest = {(0, 9), (2, 27)}  # the others are missed by the one that comes next
    needed = [*turns, (3, 0), (3, 1), (3, 2), (4, 0), (5, 0), (5, 4), *((5, 8 + i) for i in range(4))]
    for name in (None, *needed):
        kept = [write for write in (*good[:-1], (5, 12, 0), (5, 13, 1)) if write[:2] != name]
        dut.clear.value = 1
        await RisingEdge(dut.clk)
        dut.clear.value = 0
        await write([*kept, close_load(kept)])
        assert (dut.bad.value, dut.ready.value) == (name in turns - latest, name is None), name
