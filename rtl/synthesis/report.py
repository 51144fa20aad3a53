"""Measure every arrangement; write rtl/synthesis.json and the table in rtl/README.md; fail over budget."""

import json
import re
import sys
from pathlib import Path

import synthesis

RTL = Path(__file__).resolve().parents[1]

measured = synthesis.measure()
(RTL / "synthesis.json").write_text(json.dumps(measured, indent=2) + "\n")
readme = RTL / "README.md"
marked = re.compile(r"(<!-- synthesis -->\n).*?(<!-- end of synthesis -->)", re.DOTALL)
lines = synthesis.table(measured)
readme.write_text(marked.sub(lambda found: f"{found[1]}{lines}\n{found[2]}", readme.read_text()))
print(lines)
sys.exit("\n".join(synthesis.over_budget(measured, json.loads((RTL / "budget.json").read_text()))) or 0)
