"""Every picture: one style, one palette.

How to use it in a notebook: make the call the last line of its cell. Plane pictures are matplotlib Figures
that pyplot has already forgotten, so that they are shown exactly once::

    nl.plotting.curve(nl.paper.CURVE, comb=True)

Pictures in space are scenes; hand them to `show`, which turns them live in JupyterLab and stores a PNG where
PYVISTA_JUPYTER_BACKEND is ``static``::

    nl.plotting.show(nl.plotting.surface(organ), alt="the organ as a NURBS surface")

Never end such a line with a semicolon, and never call ``plt.show()``. To draw several things into one
picture, pass ``ax=`` (of `subplots`) or ``stage=`` (of `scene`) along; the calls before the last need no
``_ =``, because only the last value of a cell is shown. `explore` gives a picture with sliders.
"""

from nurbs_lab.plotting.animation import animation
from nurbs_lab.plotting.chips import agreement, area, times, waveform, word_length
from nurbs_lab.plotting.curves import basis, curvature, curve
from nurbs_lab.plotting.feeds import binding, bow_height
from nurbs_lab.plotting.general import explore, lines
from nurbs_lab.plotting.paths import (
    feed,
    figures_8_to_10,
    fluctuation,
    leaderboard,
    orders,
    parameter,
    parameter_step,
    path,
)
from nurbs_lab.plotting.slices import (
    browse_layers,
    layer,
    plane_and_triangle,
    repeating_node,
    weighted_graph,
)
from nurbs_lab.plotting.solids import (
    cloud,
    control_net,
    deviation,
    figure_7,
    layers,
    mesh,
    surface,
)
from nurbs_lab.plotting.stage import scene, show
from nurbs_lab.plotting.style import subplots

__all__ = [
    "agreement",
    "animation",
    "area",
    "basis",
    "binding",
    "bow_height",
    "browse_layers",
    "cloud",
    "control_net",
    "curvature",
    "curve",
    "deviation",
    "explore",
    "feed",
    "figure_7",
    "figures_8_to_10",
    "fluctuation",
    "layer",
    "layers",
    "leaderboard",
    "lines",
    "mesh",
    "orders",
    "parameter",
    "parameter_step",
    "path",
    "plane_and_triangle",
    "repeating_node",
    "scene",
    "show",
    "subplots",
    "surface",
    "times",
    "waveform",
    "weighted_graph",
    "word_length",
]
