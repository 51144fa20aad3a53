"""The readable page, made from ``results.json``: ``python -m benchmarks.page``."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from pathlib import Path

from benchmarks import plots
from benchmarks.harness import Bar, Row
from benchmarks.limits import LEAST, least_times

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

Made by `make bench`: all contestants in one run on one machine. Every time is the median of repeats
that take turns (ours, a peer, the next peer, ours, ...); calls shorter than 5 ms are repeated
within one timing. *First call* is our first one of that row: it loads compiled kernels from the cache,
if no row above did so, and meets cold memory; [fresh processes](#first-calls) have their own table.
*2.5 ×* beside a peer says that it takes 2.5 times as long as
nurbs_lab; *asked* is what the project set itself. *Answers* says how good each contestant's own
answer is."""

MISSED = """## What is missed

Of all that is asked for below, this run did not reach:"""

GROWTH = """## Growth

How time grows with the work, nurbs_lab and peers; a peer that would need too long is timed at the
smaller sizes only. *n^k* is fitted through the three largest sizes of each; the grey lines in the
pictures have the slopes of n and of its square root. Slicing has its graph at hand, 200 planes where
triangles grow and 327,680 triangles where planes do."""

LIMITS = """## The distance to the limit

The least time that a row's work could take on one core, by what was measured of that core in the
same run: copying {bytes_per_s:.1f} GB/s (read and written), {operations_per_s:.1f} G operations/s
side by side, {chained_ns:.2f} ns for an addition or multiplication and {roots_ns:.1f} ns for a
division or square root that waits for the one before. Each row states what it cannot avoid
(`benchmarks/counts.py` says how that is counted), and the largest of the least times is the limit
that applies:

- *copying* and *arithmetic* bind evaluation: every point is independent of its neighbours;
- *chain* binds a stepper: each u needs the one before, so only latencies count, and no wider
  arithmetic could help. It is that of the formulas as they are written, each operation as early as
  its operands are there, none fused: another form of the same rule could have a shorter one;
- *walk* binds slicing: the next triangle is known only when the last one has been read. The walk is
  measured: the same triangles in the same order, one bare read after another. What slicing does on
  top of it (which of three edges comes next, a coin toss that the processor guesses wrong every
  other time; the points; areas and nesting) has no simple bound, so this limit is an optimistic
  one, and the bytes alone are a still more optimistic one. Where the graph is built each time, the
  walk holds the bare sort too: the same half-edges written to the same places, their triangles read
  in the sorted order. Finding equal vertices and pairing equal edges come on top of that."""

FIRST = """## First calls

Every statement of the [tour](../notebooks/00-tour.ipynb) that takes longer than 20 ms, in a fresh
process with the kernels that set-up has compiled: its first run and its second, medians of three
processes, so the disk's cache is warm. *Not set up* is the first run in one process that finds no
compiled kernels: what `make` saves. `import nurbs_lab` loads no room of the house: each comes with its
first use, here with the line after it, which brings numba, SciPy, Matplotlib and PyVista. Asked: the
import of nurbs_lab within 1 s, the first slice within 2 s."""


def missed(rows, limits) -> list[str]:
    """The bars that are not reached, and how far the limits below would let anyone go."""
    lines = []
    for stored in rows:
        row = Row(**stored | {"bars": [Bar(**bar) for bar in stored["bars"]]})
        for bar in row.missed():
            lines.append(f"- {row.work}: {bar}." + f" {row.reason}." * bool(row.reason))
            times = least_times(row.figures, limits)
            if times:
                binding, taken = max(times, key=times.get), row.seconds["nurbs_lab"]
                what = (
                    f"{binding} its {row.figures['bytes'] / 1e6:.0f} MB" if binding == "copying" else binding
                )
                lines[-1] += (
                    f" Of these {duration(taken)}, {what} takes {duration(times[binding])}: no more than "
                    f"{number(taken / times[binding])} times as fast is possible on this core."
                )
    return lines or ["- nothing."]


MUTANTS = """## What the tests notice

`make mutants` breaks the core in one place at a time, drawn by lot, and runs the quick tests of that
file: they notice **{killed} of {tried}** changes. The reasons why each of the others changes nothing
a caller can see are in `benchmarks/mutants.json`."""


def duration(seconds: float) -> str:
    """0.00017 as '170 µs'."""
    for unit, factor in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= factor:
            return f"{number(seconds / factor)} {unit}"
    return f"{number(seconds / 1e-9)} ns"


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
        if name not in LEAST:
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


def limit_table(rows, limits) -> list[str]:
    """How far from the limits the rows stay that state their least."""
    lines = [
        "| work | bytes | operations | least time | taken | at best |",
        "| --- | --: | --: | --: | --: | --: |",
    ]
    for row in rows:
        times = least_times(row["figures"], limits)
        if not times:
            continue
        binding = max(times, key=times.get)
        taken = row["seconds"]["nurbs_lab"]
        all_times = ", ".join(f"{name} {duration(value)}" for name, value in times.items())
        cells = [
            row["work"],
            *(f"{number(row['figures'][name] / 1e6)} M" for name in ("bytes", "operations")),
            all_times,
            duration(taken),
            f"**{times[binding] / taken:.0%}** ({binding})",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def growth_tables(series) -> list[str]:
    """One table a series: times by size, what else was measured, and the fitted exponents."""
    page = []
    for name, rows in series.items():
        curves, also = plots.lines(rows), rows[0]["figures"]
        heads = [name, *curves, *(figure.replace("_", " ") for figure in also)]
        page += ["", f"| {' | '.join(heads)} |", "| --: " * len(heads) + "|"]
        for row in rows:
            times = [duration(row["seconds"][who]) if who in row["seconds"] else "–" for who in curves]
            figures = [number(row["figures"][figure]) for figure in also]
            page.append(f"| {' | '.join([number(row['size']), *times, *figures])} |")
        powers = [f"**n^{plots.exponent(c):.2f}**" if len(c) > 2 else "" for c in curves.values()]
        page.append(f"| {' | '.join(['time ~', *powers, *('' for _ in also)])} |")
    return page


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
    machine, versions, limits = results["machine"], results["versions"], results["limits"]
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    page = [
        OPENING,
        "",
        f"{machine['processor']}, {machine['system']}, Python {machine['python']}; {listed}.",
    ]
    single, series = parted(results["rows"])
    page += ["", MISSED, "", *missed(results["rows"], limits)]
    for room, rows in single.items():
        page += ["", f"## {room.capitalize()}", "", *table(rows), "", plots.bars_line(room)]
    page += ["", GROWTH, "", plots.growth_line(), *growth_tables(series)]
    rates = {name: limits[name] / 1e9 for name in ("bytes_per_s", "operations_per_s")}
    chain = {f"{name}_ns": 1e9 / limits[f"{name}_per_s"] for name in ("chained", "roots")}
    rows = [row for rows in single.values() for row in rows]
    page += ["", LIMITS.format(**rates, **chain), "", *limit_table(rows, limits)]
    page += ["", FIRST, "", *first_table(results["first_calls"])]
    return "\n".join(page) + "\n"


def parted(rows) -> tuple[dict, dict]:
    """Rows that stand alone, by room, and those of the growth series, by name, sizes rising."""
    single, series = defaultdict(list), defaultdict(list)
    for row in sorted(rows, key=lambda row: row["size"]):
        (series[row["series"]] if row["series"] else single[row["room"]]).append(row)
    return dict(single), dict(sorted(series.items()))


def main() -> None:
    """Rewrite the page, its pictures and the table of the project's README."""
    results = json.loads((HERE / "results.json").read_text())
    single, series = parted(results["rows"])
    plots.clear()
    for room, rows in single.items():
        plots.bars(room, rows)
    plots.growth(series)
    mutants = mutant_section(json.loads((HERE / "mutants.json").read_text()))
    (HERE / "README.md").write_text("\n".join([text(results), *mutants, ""]))
    readme = HERE.parent / "README.md"
    marked = re.compile(r"(<!-- benchmarks -->\n).*?(<!-- end of benchmarks -->)", re.DOTALL)
    lines = front_table(results["rows"])
    readme.write_text(marked.sub(lambda found: f"{found[1]}{lines}\n{found[2]}", readme.read_text()))


if __name__ == "__main__":
    main()
