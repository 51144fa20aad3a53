"""Every figure in the notebooks' prose is one that their code shows, to half a unit of its last digit."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import nurbs_lab as nl
from nurbs_lab.mesh import samples
from nurbs_lab.motion import benchmark_curves

ROOT = Path(nl.__file__).parent.parent
NOTEBOOKS = sorted(ROOT.glob("notebooks/*.ipynb"))
NUMBER = r"(?<![\w.])\d[\d,]*(?:\.\d+)?(?:e-?\d+)?"
#: Links, formulas, code, tags; names of equations, sections, notebooks and years; and the list of sources.
NO_FIGURE = (
    r"\]\([^)]*\)|\$[^$]*\$|`[^`]*`|<[^>]*>|\d+\(\d+\), \d+–\d+, \d{4}|\bdoi [\d./a-z]+"
    r"|\b(?:Eq|Fig|Figure|Table|[Ss]ection)s?\.? \(?\d[\d.]*(?: and [\d.]+)?"
    r"|\d\d · |(?<=[(, ])(?:19|20)\d\d\.?\)|(?:\*\*Sources|- The paper|- Section)(?:.|\n)*"
)
#: The same figure in another unit, or in percent.
UNITS = (1.0, 1e2, 1e3, 1e6, 1e-2, 1e-3, 1e-6)


def bell_overshoot():
    """Top of the polynomial through eleven points of a bell."""
    x = np.linspace(-1, 1, 11)
    return Polynomial.fit(x, 1 / (1 + 25 * x**2), 10)(np.linspace(-1, 1, 801)).max()


def frog_boxes():
    """Boxes of the scan along each axis."""
    import pyvista

    return pyvista.read(pyvista.examples.frogtissuesfile).dimensions


#: Figures of the paper and of our word, which every notebook may name ...
COMMON = (nl.paper.CU_TIME_S, nl.paper.CU_TIME_S * nl.paper.CLOCK_HZ, 35, 18)
#: ... and what else no cell shows.
ELSEWHERE = {
    "00-tour": frog_boxes,
    "01-point-cloud-to-mesh": lambda: [len(samples.frog_organ("eye_white").vertices)],
    "02-slicing": lambda: [20 * 4**7],
    "03-curves": lambda: [bell_overshoot()],
    "04-surfaces": lambda: [(200 * 200) ** 2 / 1e9],
    "05-feedrate": lambda: [len(benchmark_curves()["butterfly"].curve.control_points)],
    "07-beyond-the-paper": lambda: [benchmark_curves()["butterfly"].curve.length()],
    "08-fixed-point-and-verilog": lambda: [19 / 64, 2.6e-3 * nl.paper.CLOCK_HZ],
}


def numbers(text):
    """Values of a text, and half a unit of the last digit of each; zeros at its end may be rounded."""
    for found in re.findall(NUMBER, text):
        digits = found.replace(",", "")
        whole, _, decimals = digits.partition(".")
        zeros = 0 if decimals else len(whole) - len(whole.rstrip("0"))
        yield found, float(digits), 0.5001 * 10.0 ** (zeros - len(decimals))


def strays(prose, known):
    """Figures of the prose that are none of the known ones; small whole numbers are words."""
    known = np.abs(np.multiply.outer(UNITS, list(known))).ravel()
    return [
        found
        for found, value, half in numbers(re.sub(NO_FIGURE, " ", prose))
        if (value > 12 or "." in found) and not np.any(np.abs(known - value) <= half)
    ]


def shown(cell):
    """The code of a cell and the text that it gave."""
    outputs = [part for output in cell["outputs"] for part in (output, output.get("data", {}))]
    texts = [part[kind] for part in outputs for kind in ("text", "text/plain") if kind in part]
    return "\n".join("".join(lines) for lines in [cell["source"], *texts]).replace("_", "")


def test_a_figure_out_of_nowhere_is_found():
    assert strays("a gap of 1.24 mm, 8,956 triangles and 50 %", [1.236, 8956, 0.5]) == []
    assert strays("a gap of 1.24 mm, 8,965 triangles and 50 %", [1.23, 8956, 0.4]) == ["1.24", "8,965", "50"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_prose_gives_figures_of_the_code(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    code = "\n".join(shown(cell) for cell in cells if cell["cell_type"] == "code")
    known = [value for _, value, _ in numbers(code)]
    known += [*COMMON, *ELSEWHERE.get(notebook.stem, list)()]
    for cell in cells:
        if cell["cell_type"] == "markdown":
            assert strays("".join(cell["source"]), known) == []
