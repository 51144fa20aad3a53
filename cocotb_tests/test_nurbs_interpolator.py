"""Bench of rtl/nurbs_interpolator.v, the whole with stepper, behind its AXI ports."""

from dataclasses import replace

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, Timer, with_timeout
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp, AxiStreamBus, AxiStreamSink

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, reset, simulate, words
from cocotb_tests.curves import planned, random_curve, with_feed
from nurbs_lab.hardware import Format, run_twin
from nurbs_lab.hardware.interpolator import (
    ABORT,
    CONTROL,
    CYCLES,
    CYCLES_HIGH,
    FAULTS,
    FORGET,
    GO,
    LOAD_AT,
    LOAD_HIGH,
    LOAD_LOW,
    SHAPE,
    STATUS,
    register_writes,
)

BUSY, ENDED, WAITS, BAD, ABORTED = 1 << 0, 1 << 1, 1 << 2, 1 << 11, 1 << 14


@pytest.mark.parametrize(
    ("arrangement", "dim", "rational", "word", "points"),
    [(0, 3, 1, 35, 64), (1, 2, 1, 35, 64), (2, 2, 0, 27, 24), (2, 3, 1, 35, 64)],
    ids=str,
)
def test_nurbs_interpolator(arrangement, dim, rational, word, points):
    parameters = {"ARRANGEMENT": arrangement, "DIM": dim, "RATIONAL": rational}
    simulate("nurbs_interpolator", __file__, WORD=word, MAX_POINTS=points, **parameters)


class Machine:
    """The interpolator with a bus master and a stream sink; ``stalls`` are fractions of idle cycles."""

    def __init__(self, dut, stalls=(0.0, 0.0)):
        self.dut = dut
        self.rng = np.random.default_rng(SEED)
        dut.permit.value, dut.halt.value = 1, 0
        self.bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
        self.sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1)
        channels = self.bus.write_if, self.bus.read_if
        for channel in (channels[0].aw_channel, channels[0].w_channel, channels[1].ar_channel):
            channel.set_pause_generator(self.pauses(stalls[0]))
        self.sink.set_pause_generator(self.pauses(stalls[1]))
        self.dim, self.rational = dut.DIM.value.to_unsigned(), bool(dut.RATIONAL.value)
        self.format = Format(dut.WORD.value.to_unsigned())

    def planned(self, curve, periods):
        return planned(curve, periods, format=self.format)

    def pauses(self, fraction):
        while True:
            yield bool(self.rng.random() < fraction)

    async def write(self, address, value):
        return (await self.bus.write(address, value.to_bytes(4, "little"))).resp

    async def read(self, address):
        return int.from_bytes((await self.bus.read(address, 4)).data, "little")

    async def start(self, plan):
        (address, forget), *load, (_, go) = register_writes(plan)
        assert await self.write(address, forget) == AxiResp.OKAY
        # The three registers of a load stand side by side: the master does not await each answer.
        values = [value.to_bytes(4, "little") for _, value in load]
        for i in range(0, len(values), 3):
            assert (await self.bus.write(LOAD_LOW, b"".join(values[i : i + 3]))).resp == AxiResp.OKAY
        assert await self.write(address, go) == AxiResp.OKAY

    async def points(self):
        """The whole stream up to its last flag: u and points."""
        frame = await with_timeout(self.sink.recv(), 2_000_000 * CLOCK_NS, "ns")
        void = frame.tuser if isinstance(frame.tuser, list) else [frame.tuser] * len(frame.tdata)
        assert not any(void[:-1])
        beats = [
            words(int(beat), 40, self.dim + 1) for beat, v in zip(frame.tdata, void, strict=True) if not v
        ]
        return [beat[0] for beat in beats], [beat[1:] for beat in beats]

    async def check(self, plan):
        """Run, and compare all that comes with the twin."""
        await self.start(plan)
        while not self.dut.over.value:  # no cycle between busy and ended
            assert self.dut.busy.value
            await FallingEdge(self.dut.clk)
        u, points = await self.points()
        expected = run_twin(plan)
        assert u == expected.u
        assert points == [tuple(point) for point in expected.points]
        await ClockCycles(self.dut.clk, 2)
        raised = sum(1 << bit for bit, name in FAULTS.items() if name in expected.flags)
        assert await self.read(STATUS) == ENDED | raised
        assert await self.read(CYCLES) > 0


@cocotb.test(**WATCHDOG)
async def curves_one_after_another(dut):
    """Without a reset, without stalls and with many on both sides."""
    machine = Machine(dut, stalls=(0.3, 0.7))
    await reset(dut)
    for degree in (1, 3, 5):
        for _ in range(2):
            curve = random_curve(machine.rng, degree, machine.dim, rational=machine.rational and degree > 1)
            await machine.check(machine.planned(curve, 8))


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    machine = Machine(dut)
    await reset(dut)
    curve = random_curve(machine.rng, 2, machine.dim, rational=False)
    for cycles in (3, 400, 1500):
        await machine.start(machine.planned(curve, 30))
        await ClockCycles(dut.clk, cycles)
        dut.rst.value = 1
        await ClockCycles(dut.clk, 2)
        dut.rst.value = 0
        machine.sink.clear()
        await machine.check(machine.planned(curve, 8))


@cocotb.test(**WATCHDOG)
async def registers(dut):
    """What is not allowed is refused, and a run without a good curve ends at once with its flag."""
    machine = Machine(dut)
    await reset(dut)
    for address in (CONTROL, STATUS, LOAD_LOW, LOAD_HIGH, LOAD_AT, CYCLES, CYCLES_HIGH):
        assert await machine.read(address) == 0
    for address in (STATUS, CYCLES, SHAPE, CYCLES_HIGH, 0x20, LOAD_LOW + 1):
        assert await machine.write(address, 1) == AxiResp.SLVERR
    assert (await machine.bus.read(0x20, 4)).resp == AxiResp.SLVERR
    for orders in (0, 3, 5, 6, 7, 8, 1 << 31 | 1):
        assert await machine.write(CONTROL, orders) == AxiResp.SLVERR
    assert await machine.read(STATUS) == 0
    await machine.write(CONTROL, 1)
    assert await machine.read(STATUS) == BAD | ENDED
    await machine.write(CONTROL, 2)
    assert await machine.read(STATUS) == 0
    await machine.write(LOAD_HIGH, 0x12345678)
    await machine.write(LOAD_LOW, 0x9ABCDEF0)
    assert await machine.read(LOAD_HIGH) == 0x12345678
    assert await machine.read(LOAD_LOW) == 0x9ABCDEF0
    built = 0, dut.ARRANGEMENT.value.to_unsigned(), machine.dim, machine.format.word
    low = built[0] << 20 | built[1] << 16 | built[2] << 8 | built[3]
    assert (
        await machine.read(SHAPE) == machine.rational << 31 | dut.MAX_POINTS.value.to_unsigned() << 24 | low
    )
    assert await machine.read(CYCLES_HIGH) == 0
    assert await machine.write(LOAD_AT, 1 << 13) == AxiResp.SLVERR
    plan = machine.planned(random_curve(machine.rng, 2, machine.dim, rational=False), 10)
    await machine.start(plan)
    assert await machine.write(LOAD_AT, 0) == AxiResp.SLVERR
    assert await machine.write(CONTROL, GO) == AxiResp.SLVERR
    assert await machine.read(STATUS) & ~WAITS == BUSY
    await machine.points()


@cocotb.test(**WATCHDOG)
async def flags_end_the_run(dut):
    """Overflow, division by zero, a step back: a last point; the flag stays until it is forgotten."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(random_curve(machine.rng, 2, machine.dim, rational=False), 10)
    still = with_feed(plan, (), 0)
    wild = replace(plan, first_chord=1)
    brake = with_feed(plan, ((9, *plan.feed.records[0][1:]),), 0)
    for broken, bit in ((wild, 8), (still, 9), (brake, 10)):
        await machine.start(broken)
        u, _ = await machine.points()
        expected = run_twin(broken)
        assert u == expected.u
        assert expected.flags == (FAULTS[bit],)
        await ClockCycles(dut.clk, 3)
        assert await machine.read(STATUS) == 1 << bit | ENDED
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def weights_without_a_divider_are_refused(dut):
    """With its flag, at once and without a point; where there are dividers the curve runs."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(random_curve(machine.rng, 2, machine.dim, rational=True), 3)
    if machine.rational:
        await machine.check(plan)
        return
    await machine.start(plan)
    await ClockCycles(dut.clk, 9)
    assert await machine.read(STATUS) == BAD | ENDED
    assert machine.sink.empty()
    await machine.write(CONTROL, 2)
    await machine.check(machine.planned(random_curve(machine.rng, 2, machine.dim, rational=False), 3))


@cocotb.test(**WATCHDOG)
async def a_mixture_of_two_curves_never_runs(dut):
    """Half a curve loaded over another, one number lost, one changed: refused until all is loaded again."""
    machine = Machine(dut)
    await reset(dut)
    one, other = (
        machine.planned(random_curve(machine.rng, 2, machine.dim, rational=False), 6) for _ in range(2)
    )
    writes = register_writes(other)
    half = writes[1 : 1 + len(writes) // 6 * 3]
    lost = [*writes[:4], *writes[7:]]
    changed = [*writes[:4], (LOAD_LOW, writes[4][1] ^ 2), *writes[5:]]
    for broken in (half, lost[1:], lost, changed):
        await machine.check(one)
        for address, value in [*broken, (CONTROL, GO)]:
            await machine.write(address, value)
        await ClockCycles(dut.clk, 3)
        assert await machine.read(STATUS) & ~ABORTED == BAD | ENDED
        assert machine.sink.empty()
    await machine.check(one)


@cocotb.test(**WATCHDOG)
async def an_abort_is_always_answered(dut):
    """Also while nobody takes points: flags are live, and a beat that waits is withdrawn on demand only."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(random_curve(machine.rng, 2, machine.dim, rational=False), 30)
    machine.sink.clear_pause_generator()
    machine.sink.pause = True
    await machine.start(plan)
    await ClockCycles(dut.clk, 3000)
    assert await machine.read(STATUS) == BUSY | WAITS
    assert await machine.write(CONTROL, ABORT) == AxiResp.OKAY
    assert await machine.read(STATUS) == BUSY | WAITS | ABORTED
    assert await machine.write(CONTROL, FORGET) == AxiResp.OKAY
    assert await machine.read(STATUS) == 0
    machine.sink.pause = False
    machine.sink.clear()
    await machine.start(plan)
    await ClockCycles(dut.clk, 1000)
    await machine.write(CONTROL, ABORT)
    u, _ = await machine.points()
    assert u == run_twin(plan).u[: len(u)]
    await ClockCycles(dut.clk, 3)
    assert await machine.read(STATUS) == ENDED | ABORTED
    await machine.write(CONTROL, FORGET)
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def ready_comes_from_registers(dut):
    """READY does not follow VALID within a cycle (AXI, A3.1.1), and address and data may come apart."""
    await reset(dut)
    for name in ("awvalid", "wvalid", "arvalid", "awaddr", "awprot", "wdata", "wstrb", "araddr", "arprot"):
        getattr(dut, f"s_axil_{name}").value = 0
    dut.s_axil_bready.value = dut.s_axil_rready.value = 1
    await ClockCycles(dut.clk, 3)
    for channel in ("aw", "w", "ar"):
        valid, ready = (getattr(dut, f"s_axil_{channel}{end}") for end in ("valid", "ready"))
        await FallingEdge(dut.clk)
        assert ready.value == 1
        for level in (1, 0, 1, 0):
            valid.value = level
            await Timer(1, "ns")
            assert ready.value == 1
    assert dut.s_axil_bvalid.value == 0
