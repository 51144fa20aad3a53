"""Build a module with Icarus Verilog and run its cocotb tests."""

import os
import re
from pathlib import Path

from cocotb.types import LogicArray
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner

ROOT = Path(__file__).resolve().parents[1]
SEED = int(os.environ.get("SEED", "1"))
CLOCK_NS = 20  # the paper's 50 MHz


def simulate(module: str, test_file: str, sources=(), **parameters) -> None:
    """Run the cocotb tests of ``test_file`` on a module of rtl/ with these parameters; fail if none ran."""
    name = "-".join([Path(test_file).stem, module, *(f"{key}{value}" for key, value in parameters.items())])
    folder = ROOT / "sim_build" / re.sub(r"\W", "-", name)
    runner = get_runner("icarus")
    runner.build(
        sources=[*sorted((ROOT / "rtl").glob("*.v")), *sources],
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
        extra_env={"PYTHONPATH": str(ROOT), "COCOTB_LOG_LEVEL": "WARNING", "GPI_LOG_LEVEL": "ERROR"},
    )
    ran, failed = get_results(results)
    print(f"\n{name}: {ran} tests, {failed} failed, SEED={SEED}, {folder}")
    assert ran > 0, "the simulation ran no test"
    assert failed == 0


def unknown(handle) -> None:
    """Drive X, as an idle input may."""
    handle.value = LogicArray("X" * len(handle))


def words(value: int, width: int, count: int) -> tuple:
    """The signed words of a packed vector, the lowest first."""
    sign = 1 << (width - 1)
    return tuple(((value >> i * width & 2 * sign - 1) ^ sign) - sign for i in range(count))
