"""A plane curve whose control points, weights and knots are dragged, in JupyterLab and in the book."""

import json
import uuid
from pathlib import Path

from nurbs_lab.common.checks import as_kind
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.plotting.curves import basis
from nurbs_lab.plotting.curves import curve as plot
from nurbs_lab.plotting.picture import Stored, png_of, sheet
from nurbs_lab.plotting.stage import live

#: The type under which a notebook stores the curve beside its picture; the book lets it be dragged.
MIME = "application/x-nurbs-lab-curve.1+json"
SCRIPT = Path(__file__).with_name("dragging.js")


def drag(curve):
    """A curve in the plane that a reader drags: its control points, their weights, its inner knots.

    The browser draws it, so it moves without a kernel. A line below it is the call that makes the curve as
    it is now. A notebook stores a picture, and the book draws the curve again.

    Parameters
    ----------
    curve : NurbsCurve
        In the plane, with clamped ends.

    Returns
    -------
    Stored
        To be the last line of a cell.

    Raises
    ------
    ValueError
        If the curve is not in the plane or its ends are not clamped.
    """
    as_kind("curve", curve, NurbsCurve)
    p, knots = curve.degree, curve.knots
    if curve.control_points.shape[1] != 2 or knots[0] != knots[p] or knots[-1] != knots[-p - 1]:
        raise ValueError(f"curve must be a clamped curve in the plane, got {curve!r}")
    shape = {
        "degree": p,
        "knots": knots.tolist(),
        "points": curve.control_points.tolist(),
        "weights": curve.weights.tolist(),
    }
    alt = f"a curve of degree {p} with {len(curve.control_points)} control points, which can be dragged"
    more = {"text/html": page(shape, uuid.uuid4(), SCRIPT.read_text())} if live() else {MIME: shape}
    pictures = {"curve": png_of(plot(curve)), "basis functions": png_of(basis(curve))}
    return Stored(sheet(pictures), alt, "curve", more=more)


def page(shape, name, script="", picture="") -> str:
    """HTML of a curve, over its picture; ``script`` is `SCRIPT`, unless the page has loaded it."""
    call = f'nurbsLabDrag(document.getElementById("curve-{name}"), {json.dumps(shape)});'
    return f'<figure id="curve-{name}" class="stored">{picture}</figure><script>{script}{call}</script>'
