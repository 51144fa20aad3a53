"""One look for all pictures: colours, fonts, sizes.

The colours are those of Okabe and Ito, which people with any of the common colour-vision deficiencies can
tell apart; line styles and markers differ as well wherever two lines share a picture. Magnitudes are drawn in
viridis, deviations in maps that are pale at zero.
"""

from contextlib import contextmanager
from inspect import cleandoc

import matplotlib.pyplot as plt
import numpy as np
from cycler import cycler
from matplotlib.ticker import Formatter, LogLocator, NullFormatter

from nurbs_lab.plotting.picture import Picture

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PINK = "#0072B2", "#D55E00", "#CC79A7"
GREY, PALE = "#808080", "#e8eef7"  # the latter fills areas
COLOURS = (BLUE, RED, GREEN, PINK, ORANGE, SKY, BLACK)
#: Colour and hatch of a limit of motion, the same in every picture.
LIMITS = {
    "speed": (BLUE, ""),
    "acceleration": (ORANGE, "//"),
    "jerk": (GREEN, ".."),
    "chord_error": (PINK, "\\\\"),
    "centripetal_acceleration": (RED, "xx"),
    "axis_speed": (SKY, "--"),
    "axis_acceleration": (BLACK, "||"),
    "axis_jerk": ("#8C6D31", "++"),
}
OTHER_LIMIT = GREY, "oo"
MAGNITUDE = "viridis"
SIGNED, DISTANCE = "RdBu_r", "YlGnBu"  # of deviations with and without a sign: both are pale at zero

STYLE = {
    "figure.dpi": 100,
    "savefig.dpi": 100,
    "figure.constrained_layout.use": True,
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.labelsize": 11,
    "legend.fontsize": 10,
    "legend.frameon": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "lines.markersize": 5,
    "axes.prop_cycle": cycler(color=COLOURS) + cycler(linestyle=["-", "--", "-.", ":", "-", "--", "-."]),
    "image.cmap": MAGNITUDE,
}


@contextmanager
def canvas(width=7.0, height=4.0, ax=None, rows=1, columns=1, words="", **options):
    """A styled figure that closes itself: ``with canvas() as (figure, axes): ...``.

    pyplot forgets the figure at the end, so that a notebook shows it once, as the value of its cell. If
    ``ax`` is given, it is drawn into and no figure is made. ``words`` are the alternative text, where the
    labels do not suffice.
    """
    with plt.rc_context(STYLE):
        if ax is not None:
            yield ax.figure, ax
            return
        figure, axes = plt.subplots(rows, columns, figsize=(width, height), FigureClass=Picture, **options)
        figure.set_label(words)
        try:
            yield figure, axes
        finally:
            plt.close(figure)


_AX = """
ax : matplotlib Axes, optional
    Draw into these axes instead of a new figure.

Returns
-------
matplotlib Figure
"""


def takes_axes(function):
    """Decorate a function that draws a figure: its docstring is completed by the argument ``ax``."""
    function.__doc__ = cleandoc(function.__doc__) + _AX
    return function


def subplots(rows=1, columns=1, width=7.0, height=4.0, **options):
    """An empty styled figure and its axes, to hand to the drawing functions as ``ax=``."""
    with canvas(width, height, rows=rows, columns=columns, **options) as (figure, axes):
        return figure, axes


def plain_log_ticks(axis):
    """Plain numbers on a logarithmic axis: 1, 2, 5, 10 on a short one, 0.1, 1, 10 or powers on a long one.

    Matplotlib's own are set by its TeX parser, which takes longer than the rest of a picture.
    """
    axis.set_major_locator(_LogTicks())
    axis.set_major_formatter(_LogNumbers())
    axis.set_minor_formatter(NullFormatter())


class _LogNumbers(Formatter):
    """Numbers without an exponent, or powers of ten throughout where one of them would need it."""

    _RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

    def __call__(self, value, position=None):
        """The label of one tick."""
        low, high = self.axis.get_view_interval()
        power = np.log10(value)
        if (low > 9e-5 and high < 9e5) or abs(power - round(power)) > 1e-6:
            return f"{value:g}"
        return "10" + f"{power:.0f}".translate(self._RAISED)


class _LogTicks(LogLocator):
    """Ticks at 1, 2 and 5 of each decade where fewer than two decades are seen, else at decades."""

    def tick_values(self, vmin, vmax):
        """The ticks of a view, which may have changed since the axis was made."""
        self.set_params(subs=(1.0, 2.0, 5.0) if vmax < 100 * vmin else (1.0,))
        return super().tick_values(vmin, vmax)


def equal_mm(ax, names="xy"):
    """Same scale on both axes, in mm."""
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(f"{names[0]} [mm]")
    ax.set_ylabel(f"{names[1]} [mm]")
