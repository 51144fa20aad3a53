"""Bench of rtl/boards/inputs.v against its twin: every cycle of bouncing contacts."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp

from cocotb_tests.bench import SEED, WATCHDOG, packed, reset, simulate
from nurbs_lab.hardware import load_host

say = load_host().say
COUNT, BOUNCE = 7, 12


def test_inputs():
    simulate("inputs", __file__, COUNT=COUNT, BOUNCE=BOUNCE)


class Inputs:
    """Debounced inputs, the place of an edge, and a halt; every bit of a mask is an input.

    Parameters
    ----------
    count : int
    bounce : int
        Cycles of bounce.
    """

    def __init__(self, count, bounce):
        self.bounce, self.away = bounce, [0] * count
        self.settling = self.seen = self.levels = self.watched = self.edges = self.hit = 0
        self.place = None

    def reset(self, pins):
        """A cycle with reset."""
        self.__init__(len(self.away), self.bounce)
        self.settling = self.seen = self.levels = pins

    def cycle(self, pins, positions, write=None):
        """A rising edge of the clock; ``write`` is what it writes to WATCH, if anything."""
        changed = calm = 0
        for i, away in enumerate(self.away):
            bit = 1 << i
            off = (self.seen ^ self.levels) & bit
            calm |= bit * (not off and not away)
            self.away[i] = away + 1 if off else max(away - 1, 0)
            if self.away[i] == self.bounce:
                self.away[i] = 0
                changed |= bit
        if not self.hit and not self.watched & ~calm:
            self.place = positions
        self.hit |= changed & self.watched & ~(self.seen ^ self.edges)
        self.levels ^= changed
        if write is not None:
            self.edges, self.watched, self.hit = write >> 16, write & 0xFFFF, 0
        self.settling, self.seen = pins, self.settling


def contact(rng):
    """Levels of a contact that changes from time to time, bounces, and is disturbed."""
    level = int(rng.integers(0, 2))
    while True:
        yield from [level] * int(rng.integers(1, 6 * BOUNCE))
        for length in rng.integers(1, BOUNCE, int(rng.integers(0, 5))):
            level ^= 1
            yield from [level] * int(length)
        level ^= int(rng.integers(0, 2))


@cocotb.test(**WATCHDOG)
async def levels_edges_and_places_are_those_of_the_twin(dut):
    rng, twin = np.random.default_rng(SEED), Inputs(COUNT, BOUNCE)
    contacts = [contact(rng) for _ in range(COUNT)]
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    dut.pins.value = dut.positions.value = 0
    await reset(dut)
    twin.reset(0)
    await FallingEdge(dut.clk)
    twin.cycle(0, (0, 0, 0))
    hits, ended = 0, False

    async def read(register):
        found = await bus.read(register & 0x3F, 4)
        assert found.resp == AxiResp.OKAY
        return int.from_bytes(found.data, "little")

    async def host():
        """Reads what holds still after an edge, and watches anew."""
        nonlocal hits, ended
        for n in range(60):
            watch = int(rng.integers(0, 1 << COUNT)) | int(rng.integers(0, 1 << COUNT)) << 16
            assert (await bus.write(say.WATCH & 0x3F, watch.to_bytes(4, "little"))).resp == AxiResp.OKAY
            assert await read(say.WATCH) == watch
            for _ in range(int(rng.integers(1, 40 * BOUNCE))):
                await RisingEdge(dut.clk)
                if dut.halt.value == 1:
                    break
            if dut.halt.value == 1:
                place = [await read(register) for register in say.PLACES]
                assert place == [x & 0xFFFFFFFF for x in twin.place]
                hits += 1
                found = await read(say.HIT)
                assert found
                assert found & ~twin.hit == 0
            assert (await bus.write(say.HIT & 0x3F, bytes(4))).resp == AxiResp.SLVERR, n
        assert (await bus.read(0x18, 4)).resp == AxiResp.SLVERR
        ended = True

    cocotb.start_soon(host())
    where = np.zeros(3, int)
    while not ended:
        where += rng.integers(-1, 2, 3)
        levels = sum(next(one) << i for i, one in enumerate(contacts))
        dut.pins.value, dut.positions.value = levels, packed([int(x) for x in where], 32)
        await RisingEdge(dut.clk)
        written = int(dut.data.value) if dut.write.value == 1 else None
        twin.cycle(levels, tuple(map(int, where)), written)
        await FallingEdge(dut.clk)
        assert dut.levels.value.to_unsigned() == twin.levels
        assert dut.hit.value.to_unsigned() == twin.hit
        assert dut.halt.value == (twin.hit != 0)
    assert hits > 20
    dut.rst.value, dut.pins.value = 1, 5
    await RisingEdge(dut.clk)
    await FallingEdge(dut.clk)
    assert (dut.levels.value.to_unsigned(), dut.hit.value.to_unsigned()) == (5, 0)
    assert dut.watched.value.to_unsigned() == dut.edges.value.to_unsigned() == 0
    dut.rst.value = 0
    assert [await read(register) for register in (say.LEVELS, say.WATCH, say.HIT)] == [5, 0, 0]


@cocotb.test(**WATCHDOG)
async def an_edge_is_told_in_time_and_a_spike_never(dut):
    """Counted from the pin: BOUNCE + 2 cycles, the place of the edge; BOUNCE - 1 cycles away are none."""
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    dut.pins.value = dut.positions.value = 0
    await reset(dut)
    await bus.write(say.WATCH & 0x3F, (1 << 16 | 1).to_bytes(4, "little"))
    for length in (BOUNCE - 1, 4 * BOUNCE):
        for cycle in range(4 * BOUNCE):
            dut.pins.value, dut.positions.value = cycle < length, cycle
            await RisingEdge(dut.clk)
            await FallingEdge(dut.clk)
            assert dut.halt.value == (length > BOUNCE and cycle >= BOUNCE + 1)
    assert dut.place.value.to_unsigned() == 1  # two cycles late, and one before the edge is seen
