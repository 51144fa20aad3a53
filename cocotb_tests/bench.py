"""Build a module with Icarus Verilog and run its cocotb tests."""

import os
import re
from functools import cache
from pathlib import Path

import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge
from cocotb.types import LogicArray
from cocotb.utils import get_sim_time
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner

from cocotb_tests.branches import VERILOG, probed

ROOT = Path(__file__).resolve().parents[1]
#: Models of what the vendor's chips have inside.
MODELS = sorted((ROOT / "rtl" / "boards" / "simulation").glob("*.v"))
SEED = int(os.environ.get("SEED", "1"))
CLOCK_NS = 20  # the paper's 50 MHz
#: Every cocotb test ends, whatever it waits for: ``@cocotb.test(**WATCHDOG)``.
WATCHDOG = {"timeout_time": 50, "timeout_unit": "ms"}


def source(file: Path) -> Path:
    """A file of Verilog, or the one that MUTANT has in its place: mutants.py."""
    mutant = Path(os.environ.get("MUTANT", file))
    return mutant if mutant.name == file.name else file


def simulate(module: str, test_file: str, **parameters) -> Path:
    """Run the cocotb tests of ``test_file`` on a module of rtl/; fail if none ran, return the folder."""
    name = "-".join([Path(test_file).stem, module, *(f"{key}{value}" for key, value in parameters.items())])
    folder = Path(os.environ.get("SIM_BUILD", ROOT / "sim_build")) / re.sub(r"\W", "-", name)
    counting = "BRANCHES" in os.environ
    runner = get_runner("icarus")
    runner.build(
        sources=[*(probed(folder / "probed") if counting else map(source, VERILOG)), *MODELS],
        hdl_toplevel=module,
        parameters=parameters,
        build_dir=folder,
        always=True,
        timescale=("1ns", "1ps"),
        waves="WAVES" in os.environ,
    )
    results = runner.test(
        test_module=f"cocotb_tests.{Path(test_file).stem}",
        hdl_toplevel=module,
        build_dir=folder,
        test_dir=folder,
        seed=SEED,
        log_file=folder / "branches.log" if counting else None,
        extra_env={
            "PYTHONPATH": str(ROOT),
            "SEED": str(SEED),
            "COCOTB_LOG_LEVEL": "WARNING",
            "GPI_LOG_LEVEL": "ERROR",
            # The assertions of benches tell their values; to look for some in every import takes 5 s a run.
            "COCOTB_REWRITE_ASSERTION_FILES": "test_*.py bench.py serial_line.py streamer_driver.py",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # a bench needs none, and they take seconds to import
            "PYTHONWARNINGS": "ignore::DeprecationWarning",  # cocotbext-axi still speaks cocotb 1
        },
    )
    ran, failed = get_results(results)
    print(f"\n{name}: {ran} tests, {failed} failed, SEED={SEED}, {folder}")
    assert ran > 0, "the simulation ran no test"
    assert failed == 0
    return folder


class Unit:
    """Drives a unit of start, busy and done; its operands are X while it does not read them.

    Parameters
    ----------
    operands : iterable of str
        Names of the inputs that belong to a start.
    held : bool
        Whether the caller has to hold them until done.
    """

    def __init__(self, dut, operands, held=False):
        self.dut, self.held = dut, held
        self.operands = [getattr(dut, name) for name in operands]
        self.rng = np.random.default_rng(SEED)

    async def reset(self):
        self.dut.start.value = 0
        if hasattr(self.dut, "load"):
            self.dut.load.value = 0
        self.forget()
        await reset(self.dut)

    def forget(self):
        for operand in self.operands:
            unknown(operand)

    async def begin(self, *values):
        for operand, value in zip(self.operands, values, strict=True):
            drive(operand, value)
        self.dut.start.value = 1
        await RisingEdge(self.dut.clk)
        self.dut.start.value = 0
        if not self.held:
            self.forget()

    async def cut_short(self, *values, after, held=1):
        """Start with these operands, and some cycles after hold the reset."""
        await self.begin(*values)
        await ClockCycles(self.dut.clk, after)
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, held)
        self.dut.rst.value = 0

    async def ask(self, *values):
        """Start with these operands, wait for done; return the cycles from start to done."""
        await self.begin(*values)
        began = get_sim_time("ns")
        if self.rng.random() < 0.2:  # a start while busy is ignored
            self.dut.start.value = 1
            await RisingEdge(self.dut.clk)
            self.dut.start.value = 0
        await RisingEdge(self.dut.done)
        cycles = 1 + round(get_sim_time("ns") - began) // CLOCK_NS
        await FallingEdge(self.dut.clk)
        assert self.dut.busy.value == 0
        self.forget()
        return cycles


async def reset(dut):
    """Start the clock, which the simulator drives by itself, and reset for one period."""
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    dut.rst.value = 1
    await RisingEdge(dut.clk)
    dut.rst.value = 0


async def met(dut, signal):
    """Wait for a cycle in which a signal is high, and to the end of it."""
    await FallingEdge(dut.clk)
    while signal.value != 1:
        await RisingEdge(signal)
        await FallingEdge(dut.clk)  # by which all has settled
    await RisingEdge(dut.clk)


async def load_bus(dut, writes) -> None:
    """Write ``(space, index, data)`` on the load bus, one a cycle; then it is X."""
    dut.load.value = 1
    for space, index, data in writes:
        dut.load_space.value, dut.load_index.value = space, index
        dut.load_data.value = data & (1 << len(dut.load_data)) - 1
        await RisingEdge(dut.clk)
    dut.load.value = 0
    for handle in (dut.load_space, dut.load_index, dut.load_data):
        unknown(handle)


def drive(handle, value) -> None:
    """Write a number of either sign; it must fit."""
    width = len(handle)
    assert -(1 << width) <= 2 * value < 2 << width, (handle._name, value)
    handle.value = value & (1 << width) - 1


@cache
def _unknown(width: int) -> LogicArray:
    return LogicArray("X" * width)


def unknown(handle) -> None:
    """Drive X, as an idle input may."""
    handle.value = _unknown(len(handle))


def packed(values, width: int) -> int:
    """Signed words as one vector, the first lowest."""
    return sum((value & (1 << width) - 1) << i * width for i, value in enumerate(values))


def words(value: int, width: int, count: int) -> tuple:
    """The signed words of a packed vector, the lowest first."""
    sign = 1 << width - 1
    return tuple(((value >> i * width & 2 * sign - 1) ^ sign) - sign for i in range(count))


def signed(handle) -> int:
    """The value of a signed port."""
    return handle.value.to_signed()


def extremes(rng, width: int, count: int, sign: bool = True) -> list[int]:
    """The numbers where arithmetic breaks, then random ones of every size."""
    top = (1 << (width - sign)) - 1
    edge = [0, 1, 2, 3, top, top - 1, (top + 1) // 2, *((-1, -2, -3, -top, -top - 1) if sign else ())]
    sizes = rng.integers(1, width - sign + 1, count)
    found = [int(rng.integers(0, 1 << min(size, 62))) & top for size in sizes]
    return [*edge, *(-value if sign and rng.random() < 0.5 else value for value in found)]
