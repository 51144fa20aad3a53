"""Hygiene of the stored notebooks; that they reproduce is nbval's task."""

import html
import json
import re
from pathlib import Path
from symtable import symtable

import numpy as np
import pytest
import trimesh
from nbconvert import HTMLExporter

import nurbs_lab as nl
from nurbs_lab.plotting.orbit import MIME

ROOT = Path(nl.__file__).parent.parent
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


@pytest.fixture(params=NOTEBOOKS, ids=lambda file: file.stem)
def notebook(request):
    return json.loads(request.param.read_text())


def source(cell):
    return "".join(cell["source"])


def code_cells(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def test_every_code_cell_ran_in_order(notebook):
    counts = [cell["execution_count"] for cell in code_cells(notebook)]
    assert counts == list(range(1, len(counts) + 1))


def test_one_picture_stands_for_the_notebook(notebook):
    cells = [cell for cell in code_cells(notebook) if "thumbnail" in cell["metadata"].get("tags", [])]
    assert sum("image/png" in output.get("data", {}) for cell in cells for output in cell["outputs"]) == 1


def test_no_later_cell_takes_a_name_that_a_slider_uses(notebook):
    """A reader moves a slider after the last cell has run; its functions then find the names of that time."""
    sources = [source(cell) for cell in code_cells(notebook)]
    tables = [symtable(text, "cell", "exec") for text in sources]
    taken = [{one.get_name() for one in table.get_symbols() if one.is_assigned()} for table in tables]
    for k, text in enumerate(sources):
        functions = {one.get_name(): one for table in tables[: k + 1] for one in table.get_children()}
        waiting, used = set(re.findall(r"plotting\.explore\((\w+)", text)), set()
        while waiting:
            used |= waiting
            inside = [functions[name] for name in waiting & set(functions)]
            inside += [table for function in inside for table in function.get_children()]
            symbols = [one for table in inside for one in table.get_symbols()]
            waiting = {one.get_name() for one in symbols if one.is_global()} - used
        assert used & set().union(*taken[k + 1 :]) == set(), text


def test_no_error_or_stderr_is_stored(notebook):
    for cell in code_cells(notebook):
        for output in cell["outputs"]:
            assert output.get("name") != "stderr"
            assert output["output_type"] != "error" or "raises-exception" in cell["metadata"].get("tags", [])


def test_code_is_short_and_defines_nothing_long(notebook):
    for cell in code_cells(notebook):
        if "your-own" in cell["metadata"].get("tags", []):  # where a reader writes
            continue
        functions = re.findall(r"^def .*(?:\n[ \t]+.*)*", source(cell), re.MULTILINE)
        assert all(function.count("\n") < 4 for function in functions), functions  # the name and three lines


def test_first_cell_is_the_title_and_pictures_have_alt_text(notebook):
    assert source(notebook["cells"][0]).startswith("# ")
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            assert "![](" not in source(cell)
            assert all('alt="' in tag for tag in re.findall(r"<img[^>]*>", source(cell)))


def test_every_stored_picture_is_told_in_words(notebook):
    for cell in code_cells(notebook):
        for output in cell["outputs"]:
            for kind in {"image/png", "image/svg+xml"} & set(output.get("data", {})):
                assert len(output["metadata"].get(kind, {}).get("alt", "")) > 10, source(cell)


def test_figures_are_numbered_in_order(notebook):
    prose = "\n".join(source(cell) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    numbers = [int(number) for number in re.findall(r"\*Figure (\d+)", prose)]
    assert numbers == list(range(1, len(numbers) + 1)) != []


def test_sections_are_numbered_in_order(notebook):
    prose = "\n".join(source(cell) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    numbers = [int(number) for number in re.findall(r"^## (\d+) · ", prose, re.MULTILINE)]
    assert numbers == list(range(1, len(numbers) + 1))
    sections = [int(number) for number in re.findall(r"\(Section (\d+)\)", prose)]
    assert set(sections) <= set(numbers)


def test_exercises_are_folded_run_and_asserted(notebook):
    cells = notebook["cells"]
    asked = [n for n, cell in enumerate(cells) if re.search(r"^\*\*\d\.", source(cell), re.MULTILINE)]
    assert 3 <= len(asked) <= 5
    for n in asked:
        assert source(cells[n]).count("<details><summary>Solution</summary>") == 1
        assert {"solution", "hide-cell"} <= set(cells[n + 1]["metadata"]["tags"])
        assert cells[n + 1]["metadata"]["jupyter"] == {"outputs_hidden": True, "source_hidden": True}
        assert "assert" in source(cells[n + 1])


def letters(formula):
    """The letters of a formula without words and the d of a derivative; Greek ones in Unicode."""
    formula = re.sub(r"\\(begin|end|mathrm|mathsf|text)\s*(\{[^}]*\}|\w)|_\{[A-Za-z]{2,}\}", " ", formula)
    formula = re.sub(r"(?<!\w)d(?=[stux])", " ", formula)
    formula = re.sub(r"\\(?:var)?([A-Za-z]+)", lambda name: html.unescape(f"&{name[1]};")[0], formula)
    return set(re.findall("[A-Za-zΑ-Ωα-ω]", formula)) - {"π"}


def test_appendix_a_holds_every_letter_of_a_formula(notebook, request):
    """In a row or a line that links to the notebook, or under a heading that does."""
    name, listed, heading = request.node.callspec.id, set(), ""
    link = f"]({name}.ipynb)" if name != "A-symbols" else ""  # its own formulas may have a letter of any row
    appendix = json.loads((ROOT / "notebooks" / "A-symbols.ipynb").read_text())
    for line in "\n".join(source(cell) for cell in appendix["cells"]).splitlines():
        heading = line if line.startswith("#") else heading
        if line.startswith(("| ", "- [")) and link in heading + line:
            named = re.sub(r"\[[^]]*\]\([^)]*\)", "", line).strip("| ").split(" | ")[0]
            listed |= letters(re.sub(r"(?<![\\A-Za-z])[A-Za-z]{2,}", " ", named))
    prose = "\n".join(source(cell) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    used = letters(" ".join(found[1] for found in re.findall(r"(\$\$?)([^$]+)\1", prose)))
    assert used <= listed, f"no row in appendix A: {sorted(used - listed)}"


BALL = trimesh.creation.icosphere(subdivisions=2, radius=10)
TURNED = np.where(np.arange(len(BALL.faces))[:, None] % 7, BALL.faces, BALL.faces[:, ::-1])


def run_own_part(mesh, unit, folder):
    """Sections 1 to 5 of notebook 10, which treat a file of the reader's own, with this mesh."""
    cells = json.loads((ROOT / "notebooks" / "10-your-own-part.ipynb").read_text())["cells"]
    end = next(n for n, cell in enumerate(cells) if "## 6 · " in source(cell))
    text = "\n".join(source(cell) for cell in code_cells({"cells": cells[:end]}))
    file = folder / "mine.stl"
    mesh.export(file)
    given = '"exports/bracket.stl", "inch", 0.1'
    assert text.count(given) == 1
    exec(text.replace(given, f"{str(file)!r}, {unit!r}, 0.5"), {})


@pytest.mark.parametrize(
    ("mesh", "unit", "said"),
    [
        (trimesh.creation.box((1, 2, 3)), "cm", "[10. 20. 30.] mm"),
        (trimesh.Trimesh(BALL.vertices, TURNED, process=False), None, "flipped triangles turned"),
        (BALL + BALL.copy().apply_translation((30, 0, 0)), None, "sound solids in the file: 2"),
        (trimesh.creation.torus(10, 3), None, "sound solids in the file: 1"),
    ],
)
def test_a_file_of_ones_own_goes_through_notebook_10(mesh, unit, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run_own_part(mesh, unit, tmp_path)
    assert said in capsys.readouterr().out


def test_a_file_that_is_no_solid_stops_notebook_10_with_the_reason(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    box = trimesh.creation.box((9, 9, 9)).subdivide().subdivide()
    sheet = box.submesh([box.face_normals[:, 2] > 0.5], append=True)
    with pytest.raises(ValueError, match="as around a hole or a sheet"):
        run_own_part(sheet, None, tmp_path)


TWO_WAVES = 3 * np.sin(np.arange(301) * np.pi / 100) * np.sign(np.arange(301) - 100)  # a corner at each end


@pytest.mark.parametrize(("height", "refused"), [(0, False), (1, True)])
def test_a_program_of_ones_own_goes_through_notebook_13(height, refused, tmp_path, capsys):
    """Its cells that read, smooth and export, for a program that becomes several curves."""
    cells = json.loads((ROOT / "notebooks" / "13-facets-and-dialects.ipynb").read_text())["cells"]
    asked = ("folder = Path", "nl.read(yours)", "in nl.interchange.DIALECTS", "interchange.Setup(")
    sources = [source(cell) for cell in code_cells({"cells": cells})]
    text = "\n".join(one for one in sources if any(words in one for words in asked))
    places = [f"G1 X{0.1 * k:.3f} Y{y:.3f} Z{height * y:.3f}" for k, y in enumerate(TWO_WAVES)]
    file = tmp_path / "mine.ngc"
    file.write_text("\n".join(["G21 G90 F600", "G0 X0 Y0 Z0", *places, "M2"]))
    names = {"yours": file}
    exec(text.replace('Path("exports")', f"Path({str(tmp_path)!r})"), names)
    assert len(names["smooth"].moves) > 1
    written = {one for one in nl.interchange.DIALECTS if (tmp_path / f"{one}.ngc").is_file()}
    assert written == set(nl.interchange.DIALECTS) - ({"linuxcnc"} if refused else set())
    assert ("leaves the plane XY" in capsys.readouterr().out) == refused


def test_every_scene_turns_in_the_book(notebook):
    for cell in code_cells(notebook):
        for output in cell["outputs"]:
            data = output.get("data", {})
            assert not "".join(data.get("text/plain", "")).startswith("<scene") or MIME in data, source(cell)


def test_the_tour_as_a_page_has_words_for_every_picture():
    exporter = HTMLExporter(template_file=str(ROOT / "notebooks" / "page.html.j2"))
    page, _ = exporter.from_filename(str(ROOT / "notebooks" / "00-tour.ipynb"))
    pictures = re.findall(r"<img\b[^>]*>", page)
    assert len(pictures) >= 5
    for picture in pictures:
        assert "No description has been provided" not in picture
        assert re.search(r'alt="[^"]{10,}"', picture)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_file_is_small_and_portable(file):
    assert file.stat().st_size < 1_000_000
    assert not re.search(r"/(?:work|root|home|tmp)/", file.read_text())


def test_the_front_page_lists_every_notebook():
    rows = re.findall(r"\]\(notebooks/([\w-]+)\.ipynb\)", (ROOT / "README.md").read_text())
    assert sorted(set(rows)) == [file.stem for file in NOTEBOOKS]
