"""Pictures of feed planning: the chord error, and which limit is active where on the path."""

import numpy as np

from nurbs_lab.plotting.style import (
    BLACK,
    BLUE,
    GREY,
    LIMITS,
    OTHER_LIMIT,
    RED,
    canvas,
    equal_mm,
    picked,
    takes_axes,
)


@takes_axes
def chord_error(*, radius=1.0, step=1.1, ax=None):
    """A chord, its arc and the chord error between them, with the right triangle that relates the three.

    Parameters
    ----------
    radius : float
        Radius of curvature, in mm.
    step : float
        Length of the chord, v T, in mm; at most twice the radius.
    """
    half = 0.5 * step
    foot = np.sqrt(radius**2 - half**2)
    reach = np.arcsin(half / radius) + 0.35
    angle = np.linspace(-reach, reach, 200)
    words = "an arc over its chord; the chord error is the gap between them in the middle"
    with canvas(6, 4.4, ax, words=words) as (figure, ax):
        ax.plot(radius * np.sin(angle), radius * np.cos(angle), color=BLUE, linestyle="-", label="curve")
        ax.plot([-half, half], [foot, foot], "o-", color=RED, label="chord of one period")
        ax.plot([0, half, 0, 0], [0, foot, foot, 0], color=GREY, linestyle="--", linewidth=1)
        ax.plot([0, 0], [foot, radius], color=BLACK, linestyle="-", linewidth=2.5, label="chord error ε")
        for at, name, side in (
            ((half / 2, foot / 2), "ρ", (8, -8)),
            ((half / 2, foot), "vT / 2", (-8, -14)),
            ((0, foot / 2), "ρ − ε", (-38, 0)),
            ((0, (foot + radius) / 2), "ε", (6, -4)),
        ):
            ax.annotate(name, at, side, textcoords="offset points")
        equal_mm(ax)
        ax.legend(loc="lower left")
    return figure


@takes_axes
def binding(path, *, axes="xy", ax=None):
    """The tool path, in the colour and width of the limit that is active.

    Parameters
    ----------
    path : ToolPath
        Of a planned feed.
    axes : str
        The two coordinates to draw.
    """
    points = path.points[:, picked(axes)]
    chords = np.stack([points[:-1], points[1:], np.full_like(points[1:], np.nan)], axis=1)
    limits = path.feed.limiting(path.t[1:])
    with canvas(7.5, 5, ax) as (figure, ax):
        for k, name in enumerate(sorted(set(limits))):
            mine, (colour, _) = chords[limits == name].reshape(-1, 2), LIMITS.get(name, OTHER_LIMIT)
            ax.plot(*mine.T, "-", color=colour, linewidth=2 + k, label=name.replace("_", " "))
        equal_mm(ax, axes)
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title="limited by")
    return figure
