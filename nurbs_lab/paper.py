"""The paper's own curve and constants (section 4).

H. Zhu, M. Wang, K. Liu, W. Xu, 'NURBS modeling and curve interpolation optimization of 3D graphics',
Computers, Materials & Continua 66(2), 1799-1811, 2021, doi 10.32604/cmc.2020.012706, CC BY 4.0.
"""

import json
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
#: Maximum chord error (the paper's bow height), in mm.
CHORD_ERROR = 1e-3
#: Clock of the paper's FPGA, an Altera Cyclone II EP2C8Q208, in Hz.
CLOCK_HZ = 50e6
#: Time the paper's module cu takes for one C(u), in s.
CU_TIME_S = 205e-6


class Claim(NamedTuple):
    """One equation, figure, table, module or statement of the paper, and its verdict.

    Attributes
    ----------
    item, kind, says : str
        Its name; 'equation', 'figure', 'table', 'module' or 'claim'; what the paper says.
    verdict, because : str
        One of ``VERDICTS``, and the reason.
    notebook, cell : str
        The notebook where it is done, and a piece of the source of the cell that does it.
    module : str
        The file of the repository that implements it.
    check : str or None
        Tag of the cell of notebook B that computes its figures.
    figures : list of str
        The figures, as that cell prints them.
    """

    item: str
    kind: str
    says: str
    verdict: str
    because: str
    notebook: str
    cell: str
    module: str
    check: str | None
    figures: list


#: What can be said of a claim.
VERDICTS = ("holds", "holds with a condition", "misprint", "fails", "inferred")


def claims(kind=None):
    """The map of the paper: every equation, figure, table, module and claim with its verdict.

    Parameters
    ----------
    kind : {'equation', 'figure', 'table', 'module', 'claim'}, optional
        All by default.

    Returns
    -------
    list of Claim

    Examples
    --------
    >>> from nurbs_lab import paper
    >>> [claim.verdict for claim in paper.claims("equation") if claim.item == "Eq. (17)"]
    ['holds with a condition']
    """
    if kind is not None:
        as_choice("kind", kind, ("equation", "figure", "table", "module", "claim"))
    rows = json.loads(files("nurbs_lab").joinpath("paper_claims.json").read_text(encoding="utf-8"))
    return [Claim(**row) for row in rows if kind in (None, row["kind"])]
