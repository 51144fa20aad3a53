"""The paper's own curve and constants (section 4).

H. Zhu, M. Wang, K. Liu, W. Xu, 'NURBS modeling and curve interpolation optimization of 3D graphics',
Computers, Materials & Continua 66(2), 1799-1811, 2021, doi 10.32604/cmc.2020.012706, CC BY 4.0.
"""

import json
import re
from importlib.resources import files
from typing import NamedTuple

from nurbs_lab.common.checks import as_choice
from nurbs_lab.nurbs import NurbsCurve

#: Quadratic test curve of section 4, control points in mm.
CURVE = NurbsCurve(
    degree=2,
    knots=[0, 0, 0, 1 / 5, 2 / 5, 3 / 5, 4 / 5, 1, 1, 1],
    control_points=[(1, 2), (1.5, 1), (3, 3), (4, 3.5), (5, 3), (6.5, 1), (7, 2)],
)
#: Interpolation period T, in s.
PERIOD_S = 1e-3
#: Maximum feed speed v_m, in mm/s.
SPEED = 4.0
#: Initial speed v_s, in mm/s.
START_SPEED = 0.0
#: Maximum chord error, in mm.
CHORD_ERROR = 1e-3
#: Clock of the paper's FPGA, an Altera Cyclone II EP2C8Q208, in Hz.
CLOCK_HZ = 50e6
#: Time the paper's module cu takes for one C(u), in s.
CU_TIME_S = 205e-6


class Claim(NamedTuple):
    """One equation, figure, table, module, parameter or statement of the paper, and its verdict.

    Attributes
    ----------
    item, kind, section, verdict : str
        Its name, one of ``KINDS``, the section of the paper in which it appears, and one of ``VERDICTS``.
    quote, reading : str
        The paper's words as our copy has them, and how we read them and why, with {number}; Markdown.
    number, check, notebook, module : str or None
        One number that supports the verdict, the tag of the cell of notebook B that prints it, the notebook
        that does what the item says, and the file that implements it.
    """

    item: str
    kind: str
    section: str
    quote: str
    reading: str
    verdict: str
    number: str
    check: str | None
    notebook: str
    module: str

    @property
    def place(self):
        """Name of its entry in notebook B, for links: 'Eq-17'."""
        return re.sub(r"\W+", "-", self.item).strip("-")

    @property
    def condition(self):
        """The kind and the words of its condition: ('a range', 'i is 1 or 2'); both empty without one."""
        return _parts(self.reading)[:2]


KINDS = ("equation", "figure", "table", "module", "parameter", "claim")
#: What can be said of an item; notebook B defines each.
VERDICTS = ("holds", "holds with a condition", "slip in our copy", "lost in our copy")
VERDICTS += ("silent", "not reproduced", "fails")


def claims(kind=None):
    """The audit of the paper: its equations, figures, table, modules, parameters and claims, with verdicts.

    Parameters
    ----------
    kind : str, optional
        One of ``KINDS``; all by default.

    Returns
    -------
    list of Claim
        In the order of the paper.

    Examples
    --------
    >>> from nurbs_lab import paper
    >>> [claim.verdict for claim in paper.claims("equation") if claim.item == "Eq. (17)"]
    ['holds with a condition']
    """
    if kind is not None:
        as_choice("kind", kind, KINDS)
    rows = json.loads(files("nurbs_lab").joinpath("paper_claims.json").read_text(encoding="utf-8"))
    return [Claim(**row) for row in rows if kind in (None, row["kind"])]


def audit(section):
    """The items of one section of the paper as Markdown, each folded under its name and verdict.

    Parameters
    ----------
    section : str
        'Abstract', '1', '2.1', '2.2', '2.3', '3.1', '3.2', '4' or '5'.

    Returns
    -------
    str
    """
    return "\n\n".join(map(_entry, (claim for claim in claims() if claim.section == section)))


def _parts(reading):
    """Kind of the condition, its words, and what follows."""
    return re.match(r"(?:Condition, (.+?): (.+?)(?<!Eq)\. )?(.*)", reading).groups("")


def _entry(claim):
    kind, words, reading = _parts(claim.reading)
    # The links are HTML, as Sphinx follows no others here.
    number = f'**{claim.number}** (cell <a href="#{claim.check}">{claim.check}</a>)'
    told = reading.replace("{number}", number)
    file = f'Notebook <a href="{claim.notebook}.ipynb">{claim.notebook[:2]}</a>, `{claim.module}`.'
    # An equation is a paragraph of its own: Sphinx takes words in brackets behind it for its label.
    quote = "\n>\n> ".join(filter(None, re.split(r"\s*(\$\$.+?\$\$)\s*", claim.quote)))
    said = f"<summary><b>{claim.item}</b> · <i>{claim.verdict}</i>{kind and f', {kind}: {words}'}</summary>"
    return f'<details id="{claim.place}">{said}\n\n> {quote}\n\n{told}\n\n{file}\n\n</details>'
