"""Compile the Verilog and run it from Python, under Icarus Verilog."""

import atexit
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nurbs_lab.common.checks import as_parameters
from nurbs_lab.hardware.arithmetic import SHIPPED, Format
from nurbs_lab.hardware.cu import load_curve

_HERE = Path(__file__).parent
#: States of rtl/cu.v.
_STATES = ("IDLE", "CHECK", "READ", "COMPARE", "RATIO", "LEVEL", "SUM", "DIVIDE")


class CuRun(NamedTuple):
    """What the simulated module ``cu`` answered."""

    #: ``(..., dim)`` for u of shape ``(...)``; exact, as a word has fewer bits than a float.
    points: np.ndarray
    #: Clock cycles of each point, from start to done.
    cycles: np.ndarray


def rtl_folder() -> Path:
    """The folder of the Verilog: inside an installed package, or beside the package in a checkout."""
    for folder in (_HERE.parent / "rtl", _HERE.parents[1] / "rtl"):
        if (folder / "cu.v").is_file():
            return folder
    raise FileNotFoundError("the Verilog is missing: no rtl/cu.v inside or beside the package nurbs_lab")


def simulate_cu(curve, u, format: Format = SHIPPED) -> CuRun:
    """Evaluate a curve in the simulated module ``cu``.

    Parameters
    ----------
    curve : NurbsCurve
        See :func:`nurbs_lab.hardware.load_curve` for what the hardware takes.
    u : float or array_like
        Parameters; rounded to the format.
    format : Format, optional
    """
    loaded, lines = _run_cu(curve, u, format)
    fields = [line.split() for line in lines]
    points = np.array([split_words(int(field[4], 16), format.word, loaded.dim) for field in fields])
    cycles = np.array([int(field[0]) for field in fields])
    shape = np.shape(u)
    return CuRun(loaded.from_points(points.reshape(*shape, loaded.dim)), cycles.reshape(shape))


def watch_cu(curve, u) -> dict[str, list]:
    """Look into the simulated module ``cu`` while it works, cycle by cycle until three after done.

    Parameters
    ----------
    curve : NurbsCurve
    u : float or array_like
        Parameters, evaluated one after the other.

    Returns
    -------
    dict
        Signal -> its value in every cycle, None where it is not yet defined. ``state`` is named as in
        rtl/cu.v, ``product`` is 1 where a product enters the multiplier, the others are the wires' integers.
    """
    _, lines = _run_cu(curve, u, SHIPPED, watch=[])
    cycles = [dict(pair.split("=") for pair in line.split()) for line in lines]
    # Letters x stand for bits that are not yet defined.
    signals = {
        name: [None if "x" in cycle[name].lower() else int(cycle[name], 16) for cycle in cycles]
        for name in cycles[0]
    }
    signals["state"] = [None if state is None else _STATES[state] for state in signals["state"]]
    for axis in "xy":
        signals[axis] = [None if x is None else split_words(x, SHIPPED.word, 1)[0] for x in signals[axis]]
    return signals


def _run_cu(curve, u, format, **switches):
    loaded = load_curve(curve, format)
    u = as_parameters("u", u, curve.domain)
    if not u.size:
        raise ValueError("u is empty; give at least one parameter")
    words = np.clip(loaded.to_u(u.ravel()), loaded.first_u, loaded.last_u)
    return loaded, simulate(
        "cu_run",
        {"WORD": format.word, "DIM": loaded.dim},
        load=[f"{space:x} {index:x} {data & (1 << 64) - 1:x}" for space, index, data in loaded.writes()],
        u=[f"{word:x}" for word in words.tolist()],
        **switches,
    )


def split_words(value: int, word: int, count: int) -> list[int]:
    """The signed words of a packed vector, the lowest first."""
    sign = 1 << (word - 1)
    return [((value >> i * word & 2 * sign - 1) ^ sign) - sign for i in range(count)]


def simulate(bench: str, parameters: dict, **inputs: list[str]) -> list[str]:
    """Run a test bench of ``hardware/benches`` on input files; return the lines of its result."""
    binary = Path(_compile(bench, tuple(sorted(parameters.items()))).name) / "run.vvp"
    with tempfile.TemporaryDirectory(prefix="nurbs_lab-") as folder:
        for name, lines in inputs.items():
            (Path(folder) / name).write_text("\n".join(lines) + "\n")
        _call(["vvp", "-n", str(binary), *(f"+{name}={name}" for name in (*inputs, "result"))], folder)
        return (Path(folder) / "result").read_text().splitlines()


@cache
def _compile(bench: str, parameters: tuple) -> tempfile.TemporaryDirectory:
    """A folder with ``run.vvp`` for each bench and its parameters, removed at the end of the process."""
    folder = tempfile.TemporaryDirectory(prefix="nurbs_lab-")
    atexit.register(folder.cleanup)
    benches, sources = _HERE / "benches", sorted(rtl_folder().glob("*.v"))
    overrides = [f"-P{bench}.{name}={value}" for name, value in parameters]
    options = ["-g2005", "-y", str(benches), "-s", bench, *overrides, "-o", "run.vvp"]
    _call(["iverilog", *options, *map(str, [benches / f"{bench}.v", *sources])], folder.name)
    return folder


def _call(command: list[str], folder=None) -> None:
    if shutil.which(command[0]) is None:
        raise RuntimeError(
            f"{command[0]} is missing; install Icarus Verilog: sudo apt install iverilog, "
            "brew install icarus-verilog, or conda install -c conda-forge iverilog"
        )
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
