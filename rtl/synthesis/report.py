"""Measure every arrangement; write the results and the tables of rtl/README.md; fail over budget."""

import json
import re
import sys
from pathlib import Path

import synthesis

RTL = Path(__file__).resolve().parents[1]


def store(name, found, text):
    """Write results into a file, and their table between its marks in rtl/README.md."""
    (RTL / f"{name}.json").write_text(json.dumps(found, indent=2) + "\n")
    readme = RTL / "README.md"
    marked = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
    readme.write_text(marked.sub(lambda place: f"{place[1]}{text}\n{place[2]}", readme.read_text()))
    print(text)


weighted = synthesis.place_weighted()
store("weights", weighted, synthesis.weighted_table(weighted))
measured = synthesis.measure()
store("synthesis", measured, synthesis.table(measured))
budget = json.loads((RTL / "budget.json").read_text())
sys.exit("\n".join(synthesis.over_budget({**measured, **weighted}, budget)) or 0)
