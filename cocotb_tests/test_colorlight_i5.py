"""Bench of rtl/boards/colorlight_i5.v: the pins of the chip, with the host of the package at the other end.

The loop that makes the clock is a model. A load takes most of the time, so one test does everything.
"""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge, Timer, ValueChange

import nurbs_lab as nl
from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, simulate
from cocotb_tests.serial_line import SerialLine
from nurbs_lab.hardware import build_exact_program, load_host, run_exact
from nurbs_lab.hardware.interpolator import CONTROL, OVERRIDE, STATUS, register_writes
from nurbs_lab.nurbs import NurbsCurve

host = load_host()
say, count_steps, load_scale = host.say, host.axes_twin.count_steps, host.axes_twin.load_scale
DIVIDER, SILENCE, PERIOD, BOUNCE = 4, 6000, 1500, 100  # cycles
ENABLED, MOVING, PRESSED, TRIPPED, SILENT = 1 << 0, 1 << 1, 1 << 8, 1 << 9, 1 << 13
PLACED = 1 << 2
BUSY, RESTING = 1 << 0, 1 << 3


def test_colorlight_i5():
    simulate("colorlight_i5", __file__, DIVIDER=DIVIDER, WATCHDOG=SILENCE, PULSE=5, SETUP=7, BOUNCE=BOUNCE)


def small_program():
    """A parabola in space, from rest to rest, and its scales."""
    curve = NurbsCurve(2, [0, 0, 0, 1, 1, 1], [[0, 0, 0], [0.25, 0.5, 0.1], [0.75, 0.125, 0]])
    period_s = PERIOD * CLOCK_NS * 1e-9
    feed = nl.plan_feed(curve, speed=1300.0, acceleration=2.2e6, period_s=period_s, tangential_only=True)
    program = build_exact_program(curve, feed, period_s, outputs=say.outputs("spindle", "laser"))
    return program, (load_scale(800.0, program.point_fraction),) * 3


def started(talk, program, scales):
    """Load a program and let it run."""
    yield from talk.load(program, scales, PERIOD, host.axes_twin.largest_moves(program, scales))
    yield from talk.ask(say.BOARD_CONTROL, say.ORIGIN)
    yield from talk.ask(*register_writes(program)[-1])


def ran(talk, program, scales):
    """Run a program, and compare what the board did with the twin; its steps."""
    yield from started(talk, program, scales)
    while not (status := (yield from talk.look())).ended:
        assert status.placed
        assert not status.flags
        yield from talk.refill(status.register)
        yield say.PAUSE_S
    yield from talk.compare(say.twin_of(program), scales, status)
    return status.steps


class Pins:
    """Counts the steps on the pins, and keeps what came at the outputs."""

    def __init__(self, dut):
        self.dut, self.steps, self.tools = dut, [0, 0, 0], []
        cocotb.start_soon(self.watch())
        cocotb.start_soon(self.watch_tools())

    async def watch_tools(self):
        while True:
            await ValueChange(self.dut.tools)
            self.tools.append(int(self.dut.tools.value))

    async def watch(self):
        was = 0
        while True:
            await ValueChange(self.dut.step)
            now = int(self.dut.step.value)
            for axis in range(3):
                if now & ~was & 1 << axis:
                    self.steps[axis] += -1 if int(self.dut.dir.value) >> axis & 1 else 1
            was = now


async def as_simulated(line):
    """Random requests without a curve: the simulated board answers as the chip, bit for bit."""
    board, rng = host.Simulation(), np.random.default_rng(SEED)
    orders = (0, 1, 2, 4, 8)
    writes = {
        CONTROL: orders,
        say.BOARD_CONTROL: orders,
        OVERRIDE: (0, 7, 256, 511),
        say.PERIOD: (1499, 1500),
    }
    writes |= {say.SCALE_Y: (5, 6), say.WATCH: (0, 1 << 6 | 1 << 22, 3), say.LARGEST_Z: (8, 9)}
    reads = (*writes, STATUS, STATUS, say.BOARD_STATUS, say.HIT, say.LEVELS, say.CLOCK, say.STEPS_X)
    reads = [address for address in reads if address != CONTROL]
    for _ in range(100):
        request = say.encode(say.ASK, 0, int(rng.choice(reads)) >> 2, 0)
        if rng.random() < 0.6:
            address = int(rng.choice([*writes, CONTROL, say.BOARD_CONTROL]))
            request = say.encode(say.ASK, 0, 0x80 | address >> 2, int(rng.choice(writes[address])))
        await line.send(request)
        assert await line.take() == board.exchange(request), request.hex(" ")
    for order in ((say.BOARD_CONTROL, say.DISABLE), (CONTROL, 2), (say.WATCH, 0), (say.PERIOD, PERIOD)):
        await line.send(say.encode(say.ASK, 0, 0x80 | order[0] >> 2, order[1]))
        await line.take()


@cocotb.test(**WATCHDOG)
async def a_curve_over_the_serial_line(dut):
    dut.stop.value, dut.contacts.value = 0, 0x7F
    clock = Clock(dut.clk_25, 2 * CLOCK_NS, unit="ns", impl="gpi")
    clock.start()
    line, talk = SerialLine(dut.uart_rx, dut.uart_tx, DIVIDER), say.Conversation()
    await RisingEdge(dut.locked)
    await ClockCycles(dut.clk, 10)
    assert (dut.enable_n.value, dut.led_n.value) == (1, 1)
    pins = Pins(dut)

    async def ask(*request):
        return await line.converse(talk.ask(*request))

    with pytest.raises(RuntimeError, match="is refused"):
        await ask(0x40, 0)  # beyond the registers
    for address in (0x40, 0x80, 0xC0, 0x140, 0x1C0):
        with pytest.raises(RuntimeError, match="is refused"):
            await ask(address + (say.WATCH & 0x3F))

    # The host loads, runs and compares; the pins make the steps of the twin.
    assert await line.converse(talk.greet()) == 50_000_000
    await as_simulated(line)
    program, scales = small_program()
    made = await line.converse(ran(talk, program, scales))
    twin = run_exact(program)
    steps = count_steps(twin.points, scales)[-1]
    assert tuple(pins.steps) == made == steps
    assert pins.tools == [9, 0]
    assert max(map(abs, steps)) > 100
    assert dut.enable_n.value == 0

    async def load():
        *writes, go = register_writes(program)
        await line.converse(talk.write(writes))
        return go

    # Once more as it stands. A silent host: the tool slows down and rests, each time; told to, it goes on and
    # loses nothing.
    pins.steps = [0, 0, 0]
    await line.converse(started(talk, program, scales))
    for _ in range(2):
        at = list(pins.steps)
        await ClockCycles(dut.clk, SILENCE + 12 * PERIOD)
        assert await ask(say.BOARD_STATUS) & (ENABLED | SILENT | PLACED) == ENABLED | SILENT | PLACED
        assert await ask(STATUS) & (BUSY | RESTING) == BUSY | RESTING
        assert int(dut.tools.value) == 1  # no laser at rest
        assert await ask(say.BOARD_STATUS) & 0xF0 == 0x10
        rested = list(pins.steps)
        assert at != rested != list(steps)
        await ClockCycles(dut.clk, 2 * PERIOD)
        assert pins.steps == rested
        assert (dut.enable_n.value, dut.led_n.value) == (0, 0)
        await ask(say.OVERRIDE, 256)
    while await ask(STATUS) & BUSY or await ask(say.BOARD_STATUS) & MOVING:
        pass
    assert tuple(pins.steps) == steps
    await ask(say.BOARD_CONTROL, say.ORIGIN)
    assert not await ask(say.BOARD_STATUS) & SILENT  # of the runs before
    await ask(say.BOARD_CONTROL, say.DISABLE)

    # A line that pauses within a request, as USB does: the request is whole all the same.
    request = say.encode_block(0, [(say.OVERRIDE, 255), (say.OVERRIDE, 256)])
    await line.send(request[:6])
    await ClockCycles(dut.clk, 10_000)
    await line.send(request[6:])
    assert await line.take() == say.encode(say.ANSWER, 0, 0, 2)

    # Whatever the order, nothing moves before load, enable, origin and go.
    go = await load()
    for orders in ((), (say.ENABLE,), (say.ENABLE, say.DISABLE, say.ORIGIN)):
        for order in orders:
            if order != say.ORIGIN:
                await ask(say.BOARD_CONTROL, order)
            else:
                with pytest.raises(RuntimeError, match="is refused"):
                    await ask(say.BOARD_CONTROL, order)
        with pytest.raises(RuntimeError, match="is refused"):
            await ask(*go)

    # A probe, with bounce: the tool slows down and rests, the place of the edge is kept, no go before WATCH.
    await load()
    for order in (say.ENABLE, say.ORIGIN):
        await ask(say.BOARD_CONTROL, order)
    await ask(say.WATCH, 1 << 6)  # the probe, its contact closes
    await ask(*go)
    pins.steps = [0, 0, 0]
    await ClockCycles(dut.clk, 3 * PERIOD)
    touched = list(pins.steps)
    for level in (0x3F, 0x7F, 0x3F):
        dut.contacts.value = level
        await ClockCycles(dut.clk, 10)
    while await ask(STATUS) & BUSY or await ask(say.BOARD_STATUS) & MOVING:
        pass
    assert await ask(say.HIT) == 1 << 6
    assert await ask(STATUS) & (1 << 14)
    place = [(await ask(register) ^ 1 << 31) - (1 << 31) for register in say.PLACES]
    assert max(abs(a - b) for a, b in zip(place, touched, strict=True)) <= 1
    assert touched != pins.steps
    with pytest.raises(RuntimeError, match="is refused"):
        await ask(*go)
    await ask(say.BOARD_CONTROL, say.DISABLE)
    await ask(say.WATCH, 0)

    # The emergency stop cuts the enables and the steps while the clock stands still.
    await load()
    begun = list(pins.steps)
    for order in (say.ENABLE, say.ORIGIN):
        await ask(say.BOARD_CONTROL, order)
    await ask(*go)
    await RisingEdge(dut.clk)
    while int(dut.step.value) == 0:
        await RisingEdge(dut.clk)
    clock.stop()
    await Timer(10 * CLOCK_NS, "ns")
    edges = dut.clk.value
    assert dut.enable_n.value == 0
    assert int(dut.step.value) != 0
    assert int(dut.tools.value) == 9
    dut.stop.value = 1
    await Timer(1, "ns")
    assert dut.enable_n.value == 1
    assert (int(dut.step.value), int(dut.tools.value)) == (0, 0)
    assert dut.clk.value == edges  # not an edge has come
    dut.stop.value = 0
    await Timer(1, "ns")
    assert dut.enable_n.value == 1
    clock.start()
    dut.stop.value = 1
    await ClockCycles(dut.clk, 20)
    assert await ask(say.BOARD_STATUS) & (ENABLED | PRESSED | TRIPPED) == PRESSED | TRIPPED
    with pytest.raises(RuntimeError, match="is refused"):
        await ask(say.BOARD_CONTROL, say.ENABLE)
    dut.stop.value = 0
    stood = list(pins.steps)
    await ClockCycles(dut.clk, 4 * PERIOD)
    assert dut.enable_n.value == 1
    assert pins.steps == stood

    assert int(dut.tools.value) == 0

    # Enabled again, the tool stays where it is: path and origin are forgotten, but not the place.
    await ask(say.BOARD_CONTROL, say.ENABLE)
    made = await ask(say.STEPS_X)
    assert abs((made ^ 1 << 31) - (1 << 31) - stood[0] + begun[0]) <= 1
    await ClockCycles(dut.clk, 4 * PERIOD)
    assert not await ask(say.BOARD_STATUS) & (MOVING | PLACED)
    assert await ask(STATUS) & 0xFF == 0
    with pytest.raises(RuntimeError, match="is refused"):
        await ask(*go)
    await ask(say.BOARD_CONTROL, say.ORIGIN)
    await ask(*go)  # without a curve: told, and nothing moves
    assert await ask(STATUS) & 0xFFFF == 1 << 11 | say.ENDED
    await load()
    await ClockCycles(dut.clk, 4 * PERIOD)
    assert pins.steps == stood
