"""Bench of rtl/boards/board_registers.v: what may be written when, and what comes back."""

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp

from cocotb_tests.bench import WATCHDOG, reset, simulate
from nurbs_lab.hardware import load_host

board = load_host().say


def test_board_registers():
    simulate("board_registers", __file__, CLOCK_HZ=12345)


@cocotb.test(**WATCHDOG)
async def every_register(dut):
    flags = ("enabled", "moving", "placed", "pressed", "tripped", "too_fast", "late", "lost", "silent")
    flags += ("elsewhere", "cut")
    for name in flags:
        getattr(dut, name).value = 0
    dut.points_taken.value, dut.checksum.value = 77, 0xDEADBEEF
    dut.positions.value = 3 << 64 | (1 << 32) - 2 << 32 | 1
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    orders = []

    async def watch():
        while True:
            await RisingEdge(dut.clk)
            orders.extend(name for name in ("on", "off", "origin") if getattr(dut, name).value == 1)

    async def write(register, value):
        return (await bus.write(register & 0x3F, value.to_bytes(4, "little"))).resp == AxiResp.OKAY

    async def read(register):
        found = await bus.read(register & 0x3F, 4)
        assert found.resp == AxiResp.OKAY
        return int.from_bytes(found.data, "little")

    dut.outputs.value = 0
    await reset(dut)
    await ClockCycles(dut.clk, 2)
    cocotb.start_soon(watch())
    assert await read(board.IDENTITY) == board.VERSION
    assert await read(board.CLOCK) == 12345
    assert [await read(r) for r in (board.POINTS, board.CHECKSUM)] == [77, 0xDEADBEEF]
    for _ in range(2):  # y and z are of the moment of x
        assert await read(board.STEPS_X) == 1
        dut.positions.value = 6 << 64 | 5 << 32 | 4
        assert [await read(r) for r in (board.STEPS_Y, board.STEPS_Z)] == [(1 << 32) - 2, 3]
        dut.positions.value = 3 << 64 | (1 << 32) - 2 << 32 | 1
        await ClockCycles(dut.clk, 1)
    dut.positions.value = 6 << 64 | 5 << 32 | 4
    assert [await read(r) for r in (board.STEPS_Z, board.STEPS_X, board.STEPS_Y)] == [3, 4, 5]
    for bit, name in zip((0, 1, 2, *range(8, 16)), flags, strict=True):
        await ClockCycles(dut.clk, 1)
        for other in flags:
            getattr(dut, other).value = other == name or other == "placed"
        assert await read(board.BOARD_STATUS) == 1 << bit | 1 << 2
    dut.outputs.value = 9
    await ClockCycles(dut.clk, 1)
    assert await read(board.BOARD_STATUS) & 0xF0 == 0x90
    # The period is written while no origin is set, one of the allowed length only; sizes while nothing moves.
    for placed in (1, 0):
        dut.placed.value = placed
        for period, allowed in ((1499, False), (1500, True), (1 << 20, False), ((1 << 20) - 1, True)):
            assert await write(board.PERIOD, period) == (allowed and not placed)
    assert await read(board.PERIOD) == (1 << 20) - 1
    sizes = (board.SCALE_X, board.SCALE_Y, board.SCALE_Z, board.LARGEST_X, board.LARGEST_Y, board.LARGEST_Z)
    for register in sizes:
        assert await read(register) == 0
        for moving in (1, 0, 1):
            dut.moving.value = moving
            assert await write(register, 1 << 31 | register | moving) == (not moving)
    assert [await read(register) for register in sizes] == [1 << 31 | register for register in sizes]
    dut.enabled.value, dut.moving.value = 0, 0
    assert not await write(board.BOARD_CONTROL, board.ORIGIN)
    dut.enabled.value = 1
    # Orders: one at a time, and those that are refused do nothing.
    orders.clear()
    for order, refused_by in ((board.ENABLE, "pressed"), (board.DISABLE, None), (board.ORIGIN, "moving")):
        for level in (1, 0):
            dut.pressed.value = dut.moving.value = level
            assert await write(board.BOARD_CONTROL, order) == (not level or refused_by is None)
    for order in (0, 3, 5, 8, 1 << 31):
        assert not await write(board.BOARD_CONTROL, order)
    assert orders == ["on", "off", "off", "origin"]
    for register in (board.IDENTITY, board.CLOCK, board.BOARD_STATUS, board.POINTS, board.STEPS_Z):
        assert not await write(register, 1)
    assert (await bus.read(0x35, 4)).resp == AxiResp.SLVERR
    assert (await bus.write(board.PERIOD & 0x3F, b"\x40\x00")).resp == AxiResp.SLVERR
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    dut.rst.value = 0
    await ClockCycles(dut.clk, 2)
    assert await read(board.PERIOD) == 50_000
    assert [await read(register) for register in sizes] == [0] * 6
