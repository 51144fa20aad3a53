"""Measure every arrangement; write the results and the table of rtl/README.md; fail over budget."""

import json
import re
import sys
from pathlib import Path

import synthesis

RTL = Path(__file__).resolve().parents[1]
measured, readme = synthesis.measure(), RTL / "README.md"
stored = measured | {
    "kout_in_one_cycle_mhz": synthesis.kout_in_one_cycle_mhz(),
    "division_in_one_cycle_mhz": synthesis.division_in_one_cycle_mhz(),
}
(RTL / "synthesis.json").write_text(json.dumps(stored, indent=2) + "\n")
text = synthesis.table(measured)
marked = re.compile(r"(<!-- synthesis -->\n).*?(<!-- end of synthesis -->)", re.DOTALL)
readme.write_text(marked.sub(lambda place: f"{place[1]}{text}\n{place[2]}", readme.read_text()))
print(text)
budget = json.loads((RTL / "budget.json").read_text())
sys.exit("\n".join(synthesis.over_budget(measured, budget)) or 0)
