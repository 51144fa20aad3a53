"""The map of the paper: complete, its links open, and every figure is computed in the cell that it names."""

import json
from pathlib import Path

import pytest

import nurbs_lab as nl
from nurbs_lab import paper

ROOT = Path(nl.__file__).parent.parent
CLAIMS = paper.claims()
EVERY = pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.item)


def cells(name):
    return json.loads((ROOT / "notebooks" / f"{name}.ipynb").read_text())["cells"]


def printed(cell):
    return "".join("".join(output.get("text", "")) for output in cell["outputs"])


def test_nothing_of_the_paper_is_left_out():
    items = [claim.item for claim in CLAIMS]
    assert len(set(items)) == len(items)
    wanted = [f"Eq. ({n})" for n in range(1, 21)] + [f"Fig. {n}" for n in range(1, 12)] + ["Table 1"]
    wanted += ["cu", "cuk", "vt", "Kout", "ui_out"]
    assert set(wanted) <= set(items)
    assert len(paper.claims("claim")) >= 15
    assert {claim.verdict for claim in CLAIMS} <= set(paper.VERDICTS)


@EVERY
def test_its_links_open(claim):
    assert (ROOT / claim.module).is_file()
    code = ["".join(cell["source"]) for cell in cells(claim.notebook) if cell["cell_type"] == "code"]
    assert any(claim.cell in source for source in code), f"no cell of {claim.notebook} holds {claim.cell!r}"


@pytest.mark.parametrize("claim", [c for c in CLAIMS if c.check], ids=lambda claim: claim.item)
def test_its_figures_are_computed_in_the_cell_that_it_names(claim):
    (cell,) = (c for c in cells("B-the-paper") if claim.check in c["metadata"].get("tags", []))
    assert all(figure in printed(cell) for figure in claim.figures), claim.figures


def test_a_claim_with_figures_names_its_cell_and_reasons_hold_none():
    for claim in CLAIMS:
        assert claim.check or not claim.figures
        assert "|" not in claim.says + claim.because  # which would end a cell of the table


def test_the_sentence_of_equal_truncation_error_is_charged_to_eq_15_alone():
    (said,) = (claim for claim in CLAIMS if claim.item == "Same truncation error")
    assert said.verdict == "holds"
    assert "Eq. 15" in said.says


def test_citation_names_the_paper():
    text = (ROOT / "CITATION.cff").read_text()
    for words in (
        "Zhu",
        "Wang",
        "Liu",
        "Xu",
        "10.32604/cmc.2020.012706",
        "Computers, Materials & Continua",
        "CC-BY",
    ):
        assert words in text
