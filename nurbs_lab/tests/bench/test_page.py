"""The page says what was measured, and the project's README no other figures than the stored ones."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from benchmarks import first_calls, page, plots
from benchmarks.harness import Bar, Row

ROOT = Path(page.__file__).parents[1]


def row(**rest):
    return asdict(
        Row("room", "some work", {"nurbs_lab": 2e-3, "quick": 1e-3, "slow": 8.6814}, first_call=5e-3, **rest)
    )


def test_the_readme_shows_the_stored_results_to_two_digits():
    stored = json.loads((ROOT / "benchmarks" / "results.json").read_text())
    assert page.front_table(stored["rows"]) in (ROOT / "README.md").read_text()


@pytest.mark.parametrize(
    ("value", "shown"),
    [(4340.72, "4,340"), (1310720, "1,310,720"), (2.5918, "2.59"), (0.6012, "0.601"), (1.78e-15, "1.78e-15")],
)
def test_numbers(value, shown):
    assert page.number(value) == shown


@pytest.mark.parametrize(
    ("seconds", "shown"), [(62.0, "62 s"), (0.0438, "43.8 ms"), (1.7e-4, "170 µs"), (6.2e-7, "620 ns")]
)
def test_durations(seconds, shown):
    assert page.duration(seconds) == shown


def test_peers_beside_what_is_asked():
    bars = (Bar("quick", 1.0), Bar("slow", 1000.0), Bar("absent", 3.0))
    assert page.against(row(bars=bars)) == "quick 0.5 × (asked 1: **missed**), slow 4,340 × (asked 1,000 ✓)"


def test_what_is_missed_has_its_reason():
    rows = [row(bars=(Bar("quick", 2), Bar("slow", 2)), figures={"error": 3.0}, reason="so it is"), row()]
    assert page.missed(rows) == ["- some work: quick 0.5 × instead of 2 ×. so it is."]
    assert page.missed([row(figures={"error": 3.0}, most={"error": 2.0})])[0].startswith(
        "- some work: error 3 instead of at most 2."
    )
    assert page.missed([row(figures={"error": 3.0}, most={"error": 3.0})]) == ["- nothing."]


def test_answers_and_asked_figures():
    good = row(measure="gap mm", answers={"nurbs_lab": 0.0, "slow": 0.25})
    assert page.quality(good) == "gap mm: nurbs_lab 0, slow 0.25"
    assert page.quality(row()) == "–"
    asked = row(figures={"gap_mm": 0.25, "error": 2.0}, most={"error": 1.0, "gap_mm": 0.25, "seconds": 1.0})
    assert page.footnote(asked) == "gap mm 0.25 (asked at most 0.25 ✓), error 2 (asked at most 1: **missed**)"
    assert "| 2 ms (asked at most 1 s ✓) |" in page.table([asked])[2]


def test_equal_notes_are_printed_once():
    noted = row(notes="a word", figures={"gap_mm": 0.25})
    lines = page.table([noted, row(), noted])
    assert [line.count("<sup>1</sup>") for line in lines[2:5]] == [1, 0, 1]
    assert lines[6:] == ["1. a word. gap mm 0.25"]


def test_the_tour_is_timed_statement_by_statement():
    statements = list(first_calls._statements())
    assert "import nurbs_lab as nl" in statements
    assert sum("nl.slice_mesh(mesh," in statement for statement in statements) == 1


def test_the_page_holds_every_row(monkeypatch):
    drawn = {}
    monkeypatch.setattr(plots, "save", lambda figure, name: drawn.update({name: figure}))
    plots.bars("room", [row()])
    grown = [row(figures={"GB": size}) for size in (1.0, 2.0)]
    grown += [row(figures={"workers": 1}) | {"seconds": {"nurbs_lab": 1.0, "one process": 1.7}}]
    plots.growth(grown)
    assert [len(axes.lines[0].get_xdata()) for axes in drawn["growth"].axes] == [1, 2]
    text = page.text(
        {
            "machine": {"processor": "a core", "system": "an OS", "python": "3"},
            "versions": {"numpy": "2"},
            "minutes": {"room": 2.25, "shed": 1.0},
            "first_calls": [{"code": "import it", "first_s": 0.5, "again_s": 0.0, "compiling_s": 2.0}],
            "rows": [row(), row(), *grown],
        }
    )
    assert text.count("| some work | 2 ms | 5 ms | quick 0.5 ×, slow 4,340 × | – |") == 2
    assert "| `import it` | 500 ms | – | 2 s |" in text
    assert "Minutes each room took: room 2.2, shed 1.0." in text
    assert all(f"(pictures/{name}.png)" in text for name in drawn)
    assert len(drawn) == 2


def test_the_stored_mutants_are_killed_or_explained():
    stored = json.loads((ROOT / "benchmarks" / "mutants.json").read_text())
    for name, entry in stored.items():
        assert entry["tried"] == entry["killed"] + len(entry["survivors"]), name
        assert all(one["why"] for one in entry["survivors"]), name
    killed, tried = (sum(entry[key] for entry in stored.values()) for key in ("killed", "tried"))
    assert killed >= 0.85 * tried
    assert f"**{killed} of {tried}** changes" in page.mutant_section(stored)[0]
