"""Bench of rtl/axil_slave.v: the owner lets the even registers be written and the first 12 be read."""

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge, Timer
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiResp

from cocotb_tests.bench import SEED, WATCHDOG, reset, simulate


def test_axil_slave():
    simulate("axil_slave", __file__)


@cocotb.test(**WATCHDOG)
async def what_is_allowed_is_done_once(dut):
    """With stalls on every channel; parts of words and what is not allowed are refused, and do nothing."""
    rng = np.random.default_rng(SEED)
    stored, done = [0] * 16, []

    async def own():
        while True:
            await FallingEdge(dut.clk)
            if dut.write_at.value.is_resolvable:
                dut.write_allowed.value = int(dut.write_at.value) % 2 == 0
            if dut.read_at.value.is_resolvable:
                dut.read_allowed.value = int(dut.read_at.value) < 12
                dut.read_data.value = stored[int(dut.read_at.value)]
            await Timer(1, "ns")
            if dut.write.value == 1:
                stored[int(dut.write_at.value)] = int(dut.write_data.value)
                done.append(int(dut.write_at.value))

    def pauses():
        while True:
            yield bool(rng.random() < 0.4)

    dut.write_allowed.value = dut.read_allowed.value = 0
    bus = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    write, read = bus.write_if, bus.read_if
    for channel in (write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel):
        channel.set_pause_generator(pauses())
    await reset(dut)
    await ClockCycles(dut.clk, 2)
    cocotb.start_soon(own())
    expected, orders = [0] * 16, []
    for _ in range(300):
        at, value = int(rng.integers(16)), int(rng.integers(1 << 32))
        part = rng.random() < 0.2  # of a word
        answer = await bus.write(4 * at + part, value.to_bytes(4, "little")[part:])
        assert (answer.resp == AxiResp.OKAY) == (at % 2 == 0 and not part)
        if answer.resp == AxiResp.OKAY:
            expected[at] = value
            orders.append(at)
        at = int(rng.integers(16))
        answer = await bus.read(4 * at, 4)
        assert (answer.resp == AxiResp.OKAY) == (at < 12)
        assert int.from_bytes(answer.data, "little") == expected[at]
    assert (stored, done) == (expected, orders)
