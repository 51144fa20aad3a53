"""The audit of the paper: complete, quoted, its links open, its numbers computed in the cells it names."""

import json
import re
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
    assert {claim.verdict for claim in CLAIMS} == set(paper.VERDICTS)
    assert {claim.kind for claim in CLAIMS} == set(paper.KINDS)


@EVERY
def test_it_is_quoted_read_and_its_links_open(claim):
    assert len(claim.quote) > 10
    assert len(claim.reading) > 10
    assert (ROOT / claim.module).is_file()
    assert (ROOT / "notebooks" / f"{claim.notebook}.ipynb").is_file()
    assert bool(claim.number) == bool(claim.check)
    assert claim.reading.count("{number}") == bool(claim.number)
    assert "{number}" not in paper.audit(claim.section)


@EVERY
def test_its_reading_says_what_the_rule_for_verdicts_asks(claim):
    conditional = claim.verdict == "holds with a condition"
    kind = re.match("Condition, (an exception|a range|an assumption|our addition): ", claim.reading)
    assert bool(kind) == conditional
    assert conditional or "Condition" not in claim.reading
    otherwise = re.search(r"[.)] (Otherwise,|Where) ", claim.reading)  # a sentence that begins so
    assert bool(otherwise) == conditional
    assert claim.reading.startswith("What must be meant") == (claim.verdict == "slip in our copy")
    assert not conditional or f"{claim.verdict}</i>, {kind[1]}: " in paper.audit(claim.section)
    assert "Eq</summary>" not in paper.audit(claim.section)  # a condition ends with its sentence


@pytest.mark.parametrize("claim", [c for c in CLAIMS if c.check], ids=lambda claim: claim.item)
def test_its_number_is_printed_by_the_cell_that_it_names(claim):
    (cell,) = (c for c in cells("B-the-paper") if claim.check in c["metadata"].get("tags", []))
    assert claim.number in printed(cell)


@pytest.mark.parametrize("section", list(dict.fromkeys(claim.section for claim in CLAIMS)))
def test_an_equation_is_a_paragraph_of_its_own(section):
    lines = [line for line in paper.audit(section).splitlines() if "$$" in line]
    assert all(line.startswith("> $$") and line.endswith("$$") and line.count("$$") == 2 for line in lines)


def test_the_list_of_what_to_read_first_leads_to_the_entries():
    assert len({claim.place for claim in CLAIMS}) == len(CLAIMS)
    outputs = [output for cell in cells("B-the-paper") for output in cell.get("outputs", [])]
    page = "".join("".join(output.get("data", {}).get("text/markdown", "")) for output in outputs)
    led = set(re.findall(r'href="#([\w-]+)">', page))
    assert {claim.place for claim in CLAIMS if claim.verdict == "fails"} <= led
    text = "\n".join("".join(cell["source"]) for cell in cells("B-the-paper"))
    headings = set(re.findall(r"^### (\S+)$", text, re.MULTILINE))
    assert led <= set(re.findall(r'id="([\w-]+)"', page)) | headings
    assert {claim.check for claim in CLAIMS if claim.check} <= headings
