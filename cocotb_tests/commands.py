"""Curves under random overrides, Verilog beside twin: ``make commands``, COMMANDS=100000 (minutes; g++).

Job after job of 1,000 curves of degree 2 and 3 streams through the two banks of streamer.v, as the board has
it, compiled by Verilator. In every second period on average the override is another one. Each position, each
point and all outputs have to be those of the twin, to the bit, and no fault may come.
"""

import subprocess
import sys
import tempfile

import numpy as np

from cocotb_tests.bench import words
from cocotb_tests.test_streamer import job
from cocotb_tests.walk import verilate
from nurbs_lab.hardware import Format, run_exact

CURVES, DIM = 1000, 3


def driven(program, plan, seed):
    """What came out of the Verilog: the rates that were sampled, and the columns of the beats."""
    batches = [
        f"{space:x} {index:x} {data & (1 << 64) - 1:x}"
        for part in plan.batches()
        for space, index, data in [*part, (8, 0, 0)]
    ]
    (program.parent / "load").write_text("\n".join(batches) + "\n")
    command = [program, program.parent / "load", str(seed)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")[:-1]
    rates = [int(line[2:]) for line in lines if line[0] == "r"]
    beats = [[int(field, 16) for field in line.split()[1:]] for line in lines if line[0] == "p"]
    u, points, outputs = zip(*beats, strict=True)
    return rates, [*u], [words(point, Format().word, DIM) for point in points], [*outputs], lines[-1]


def main(commands):
    rng, done, seed, beats = np.random.default_rng(1), 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        program = verilate(folder, "commands.cpp", "streamer", {"DIM": DIM, "AHEAD": 1})
        while done < commands:
            seed += 1
            cubic = {n for n in range(CURVES) if n // 100 % 2 and rng.random() < 0.5}  # banks of both kinds
            plan = job(DIM, CURVES, Format(), cubic)
            rates, u, points, outputs, end = driven(program, plan, seed)
            twin = run_exact(plan, [*rates, 256])
            assert (end, twin.flags) == ("end 0 0", ()), (end, twin.flags)
            assert (u, points, outputs) == (twin.u, twin.points, twin.outputs), (
                f"job {seed} is not the twin's"
            )
            done, beats = done + int(np.count_nonzero(np.diff(rates))), beats + len(u)
            print(f"{seed * CURVES} curves, {beats} points, {done} commands: all bits are equal", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]))
