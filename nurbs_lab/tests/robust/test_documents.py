"""What the documents say is so: examples run, links lead somewhere."""

import doctest
import importlib.util
import json
import pkgutil
import re
from pathlib import Path

import pytest

import nurbs_lab as nl

ROOT = Path(nl.__file__).parent.parent
MODULES = [m.name for m in pkgutil.walk_packages(nl.__path__, "nurbs_lab.") if ".tests" not in m.name]
EXAMPLES = [m for m in MODULES if ">>>" in Path(importlib.util.find_spec(m).origin).read_text()]
PAGES = [*ROOT.glob("*.md"), *ROOT.glob("*/*.md"), *ROOT.glob("notebooks/*.ipynb")]


@pytest.mark.parametrize("name", [name for name in nl._HOME if name != "STEPPERS"])
def test_every_public_function_has_an_example(name):
    function = getattr(nl, name)
    assert ">>> " in function.__doc__
    assert function.__module__ in EXAMPLES


@pytest.mark.parametrize("module", EXAMPLES)
def test_examples_in_docstrings(module):
    result = doctest.testmod(importlib.import_module(module))
    assert result.attempted > 0
    assert result.failed == 0


def test_the_code_of_the_front_page_runs(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    exec(block, {})
    solid, numbers = capsys.readouterr().out.splitlines()
    length, duration, fluctuation = map(float, numbers.split())
    assert "1 solid" in solid
    assert len(nl.read(tmp_path / "spleen.step")) > 1
    assert 60 < length < 120
    assert duration > length / 20
    assert fluctuation < 1e-3


def prose(page):
    """The text of a page; of a notebook, that of its markdown cells."""
    if page.suffix == ".md":
        return page.read_text()
    cells = json.loads(page.read_text())["cells"]
    return "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")


def headings(page):
    """The anchors that a page's headings have on the web."""
    titles = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    text = prose(page)
    links = re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'(?:src|href)="([^"]+)"', text)
    for link in links:
        target, _, anchor = link.partition("#")
        if re.match(r"\w+:", link):  # on the web, or an attachment
            continue
        file = (page.parent / target) if target else page
        assert file.exists(), link
        assert not anchor or file.suffix != ".md" or anchor in headings(file), link
