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

from importlib import import_module

#: Module -> the functions in it; each module is loaded when one of its functions is first used.
_MODULES = {
    "chips": "area waveform",
    "crossings": "plane_and_triangle repeating_node",
    "curves": "basis curve",
    "dragging": "drag",
    "general": "animation lines",
    "machining": "milled milling program reached remaining",
    "paths": "binding chord_error feed figures_8_to_10 fluctuation leaderboard orders path",
    "slices": "layer weighted_graph",
    "sliders": "explore",
    "solids": "cloud deviation faces figure_7 layers mesh surface",
    "stage": "scene show",
    "style": "subplots",
}
_HOME = {name: module for module, names in _MODULES.items() for name in names.split()}

__all__ = sorted(_HOME)


def __getattr__(name):
    if name not in _HOME:
        raise AttributeError(f"nurbs_lab.plotting has no {name!r}; it has {', '.join(__all__)}")
    value = getattr(import_module(f"nurbs_lab.plotting.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__():
    return __all__
