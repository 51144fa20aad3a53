"""The readable page, made from ``results.json``: ``python -m benchmarks.page``."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from pathlib import Path

from benchmarks import plots
from benchmarks.harness import Bar, Row

HERE = Path(__file__).parent
#: How the rows begin that the project's README shows.
FRONT = (
    "wavy sphere, 1,310,720 triangles, 200 planes, graph at hand",
    "closed cubic through 100,000 points",
    "1000 x 1000 grid of a rational bicubic surface",
    "stepper chord-corrected",
    "one C(u)",
)

OPENING = """# Benchmarks

Made by `make bench`, room by room: all contestants of a room in one run on one machine. Every time is
the median of repeats that take turns (ours, a peer, the next peer, ours, ...); calls shorter than 5 ms
are repeated within one timing, calls of up to a second are made for half a second before each timing,
and a call of more than ten seconds is its own warm-up. *First call* is our first one of that row: it
loads compiled kernels from the cache, if no row above did so, and meets cold memory;
[fresh processes](#first-calls) have their own table. *2.5 ×* beside a peer says that it takes 2.5 times
as long as nurbs_lab; *asked* is what the project set itself. *Answers* says how good each contestant's
own answer is."""

MISSED = """## What is missed

Of all that is asked for below, this run did not reach what follows. Whole finishing programs are
not in it."""

FIRST = """## First calls

Every statement of the [tour](../notebooks/00-tour.ipynb) that takes longer than 20 ms, in a fresh
process with the kernels that set-up has compiled: its first run and its second, medians of three
processes, so the disk's cache is warm. *Not set up* is the first run in one process that finds no
compiled kernels: what `make` saves. `import nurbs_lab` loads no room of the house: each comes with its
first use, here with the line after it, which brings numba, SciPy, Matplotlib and PyVista. Asked: the
import of nurbs_lab within 1 s, the first slice within 2 s."""


GROWTH = """## Growth

Time against the work: workers, the length of a program planned in windows, and the size of a file that two
workers slice. On the logarithmic axes a slope of one is a time in proportion to the work."""


def duration(value):
    """Format a time with its unit, such as '205 µs' for 205e-6."""
    for scale, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")):
        if value >= scale:
            return f"{value / scale:.3g} {unit}"
    return f"{value:.2g} s"


def missed(rows) -> list[str]:
    """The bars that are not reached, and the reasons."""
    lines = []
    for stored in rows:
        row = Row(**stored | {"bars": [Bar(**bar) for bar in stored["bars"]]})
        lines += [f"- {row.work}: {bar}." + f" {row.reason}." * bool(row.reason) for bar in row.missed()]
    return lines or ["- nothing."]


MUTANTS = """## What the tests notice

`make mutants` breaks the core in one place at a time, drawn by lot, and runs the quick tests of that
file: they notice **{killed} of {tried}** changes. The reasons why each of the others changes nothing
a caller can see are in `benchmarks/mutants.json`."""


def number(value: float) -> str:
    """Three significant digits, or all of a whole number; thousands apart: 4340 as '4,340'."""
    if value == 0 or not 1e-3 <= abs(value) < 1e12:
        return f"{value:.3g}"
    if value >= 100:
        return f"{value:,.0f}" if float(value).is_integer() else f"{float(f'{value:.3g}'):,.0f}"
    return f"{value:.3g}"


def verdict(asked, reached) -> str:
    """What is asked, and whether it is reached."""
    return f" (asked {asked}{' ✓' if reached else ': **missed**'})"


def against(row) -> str:
    """The peers of a row as multiples, each with what is asked."""
    asked = {bar["peer"]: bar["factor"] for bar in row["bars"]}
    parts = []
    for name, seconds in row["seconds"].items():
        if name == "nurbs_lab":
            continue
        ratio = seconds / row["seconds"]["nurbs_lab"]
        part = f"{name} {number(ratio)} ×"
        parts.append(part + (verdict(number(asked[name]), ratio >= asked[name]) if name in asked else ""))
    return ", ".join(parts) or "–"


def quality(row) -> str:
    """How good the answers are."""
    answers = ", ".join(f"{name} {number(value)}" for name, value in row["answers"].items())
    return f"{row['measure']}: {answers}" if answers else "–"


def footnote(row) -> str:
    """What a fair reader must know, and the other figures that were measured."""
    most, figures = row["most"], []
    for name, value in row["figures"].items():
        asked = verdict(f"at most {number(most[name])}", value <= most[name]) if name in most else ""
        figures.append(f"{name.replace('_', ' ')} {number(value)}{asked}")
    return ". ".join(filter(None, [row["notes"], row["reason"], ", ".join(figures)]))


def table(rows) -> list[str]:
    """One room: our time, the peers as multiples; notes below."""
    lines = ["| work | nurbs_lab | first call | peers take | answers |", "| --- | --: | --: | --- | --- |"]
    notes = list(dict.fromkeys(filter(None, map(footnote, rows))))
    for row in rows:
        note = footnote(row)
        mark = f" <sup>{notes.index(note) + 1}</sup>" if note else ""
        seconds = row["seconds"]["nurbs_lab"]
        ours, most = duration(seconds), row["most"].get("seconds")
        ours += verdict(f"at most {duration(most)}", seconds <= most) if most else ""
        first = duration(row["first_call"]) if row["first_call"] else "–"
        lines.append(f"| {row['work']}{mark} | {ours} | {first} | {against(row)} | {quality(row)} |")
    return [*lines, "", *(f"{k}. {note}" for k, note in enumerate(notes, 1))]


def first_table(calls) -> list[str]:
    """The tour's statements, first and second run."""
    lines = ["| statement | first | again | not set up |", "| --- | --: | --: | --: |"]
    for call in calls:
        code = call["code"].splitlines()[0]
        code = code if len(code) <= 90 else code[:87] + "..."
        again = duration(call["again_s"]) if call["again_s"] >= 1e-3 else "–"
        times = f"{duration(call['first_s'])} | {again} | {duration(call['compiling_s'])}"
        lines.append(f"| `{code.replace('|', '&#124;')}` | {times} |")
    return lines


def mutant_section(stored) -> list[str]:
    """How many of the mutants in each core file the tests kill."""
    lines = ["| file | changed in | noticed |", "| --- | --: | --: |"]
    lines += [f"| `{name}` | {entry['tried']} | {entry['killed']} |" for name, entry in stored.items()]
    killed, tried = (sum(entry[key] for entry in stored.values()) for key in ("killed", "tried"))
    return [MUTANTS.format(killed=killed, tried=tried), "", *lines]


def front_table(rows) -> str:
    """What the README of the project shows: a few rows, two significant digits."""
    lines = ["| work | time | beside it |", "| --- | --: | --- |"]
    for work in FRONT:
        row = next(row for row in rows if row["work"].startswith(work))
        ours = row["seconds"]["nurbs_lab"]
        ratios = {name: value / ours for name, value in row["seconds"].items() if name != "nurbs_lab"}
        beside = [f"{name} {number(float(f'{ratio:.2g}'))} ×" for name, ratio in ratios.items()]
        lines.append(f"| {row['work']} | {duration(float(f'{ours:.2g}'))} | {', '.join(beside)} |")
    return "\n".join(lines)


def text(results) -> str:
    """The whole page."""
    machine, versions = results["machine"], results["versions"]
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    page = [
        OPENING,
        "",
        f"{machine['processor']}, {machine['system']}, Python {machine['python']}; {listed}.",
    ]
    listed = ", ".join(f"{name} {minutes:.1f}" for name, minutes in results["minutes"].items())
    page += ["", f"Minutes each room took: {listed}."]
    page += ["", MISSED, "", *missed(results["rows"])]
    for room, rows in by_room(results["rows"]).items():
        page += ["", f"## {room.capitalize()}", "", *table(rows), "", plots.bars_line(room)]
    if any(row["figures"].keys() & plots.GROWTH for row in results["rows"]):
        page += ["", GROWTH, "", plots.GROWTH_LINE]
    page += ["", FIRST, "", *first_table(results["first_calls"])]
    return "\n".join(page) + "\n"


def by_room(rows) -> dict:
    """Room -> its rows."""
    rooms = defaultdict(list)
    for row in rows:
        rooms[row["room"]].append(row)
    return dict(rooms)


def main() -> None:
    """Rewrite the page, its pictures and the table of the project's README."""
    results = json.loads((HERE / "results.json").read_text())
    plots.clear()
    for room, rows in by_room(results["rows"]).items():
        plots.bars(room, rows)
    plots.growth(results["rows"])
    mutants = mutant_section(json.loads((HERE / "mutants.json").read_text()))
    (HERE / "README.md").write_text("\n".join([text(results), *mutants, ""]))
    readme = HERE.parent / "README.md"
    marked = re.compile(r"(<!-- benchmarks -->\n).*?(<!-- end of benchmarks -->)", re.DOTALL)
    lines = front_table(results["rows"])
    readme.write_text(marked.sub(lambda found: f"{found[1]}{lines}\n{found[2]}", readme.read_text()))


if __name__ == "__main__":
    main()
