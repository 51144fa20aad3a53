"""Tool paths: Figs. 8, 9 and 10, fluctuation, feed and its limits, chord error, the leaderboard."""

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.ticker import NullLocator

from nurbs_lab.common.checks import as_kind
from nurbs_lab.motion import ToolPath
from nurbs_lab.plotting.general import lines
from nurbs_lab.plotting.style import (
    BLACK,
    BLUE,
    GREY,
    LIMITS,
    MAGNITUDE,
    ORANGE,
    OTHER_LIMIT,
    RED,
    canvas,
    equal_mm,
    plain_log_ticks,
    takes_axes,
)

_ROUNDING = 1e-9  # of a fluctuation in per cent: less is not drawn
_PIECES = 300  # of a path, along the axis of a picture
_FLOOR = 1e-14  # of a fluctuation: less is rounding, and zero has no place on a logarithmic axis


@takes_axes
def path(path, *, ax=None):
    """The tool path, coloured by the speed of each period (the paper's Fig. 8).

    Parameters
    ----------
    path : ToolPath
        Drawn are x and y. That of a program is made by `motion.FeedProfile.join`.
    """
    as_kind("path", path, ToolPath)
    with canvas(7, 4.2, ax) as (figure, ax):
        points = path.points[:, :2]
        speed = path.chord / path.period_s
        ax.plot(*path.curve.control_points[:, :2].T, "o--", color=GREY, linewidth=0.8, markersize=4)
        ax.plot(*points.T, color=GREY, linestyle="-", linewidth=0.5)
        dots = ax.scatter(*points[1:].T, c=speed, cmap=MAGNITUDE, s=7, zorder=3, vmin=0)
        figure.colorbar(dots, ax=ax, label="speed [mm/s]")
        ax.plot(*points[0], "o", color=BLACK, zorder=4)
        ax.annotate("start", points[0], (8, 4), textcoords="offset points")
        equal_mm(ax)
    return figure


def figures_8_to_10(tool_path):
    """The path, u and its step in every period in one picture, as the paper's Figs. 8, 9 and 10.

    Parameters
    ----------
    tool_path : ToolPath

    Returns
    -------
    matplotlib Figure
    """
    with canvas(9, 7) as (figure, unused):
        unused.remove()
        grid = figure.add_gridspec(2, 2, height_ratios=(1.2, 1))
        path(tool_path, ax=figure.add_subplot(grid[0, :]))
        u, step = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
        u.plot(tool_path.t, tool_path.u, color=BLUE, linestyle="-", label="u")
        u.plot(tool_path.t[[0, -1]], tool_path.u[[0, -1]], color=GREY, linestyle=":", label="straight line")
        u.set(xlabel="time [s]", ylabel="parameter u")
        u.legend()
        knots = np.unique(tool_path.curve.knots)
        knots = knots[(knots > tool_path.u[0]) & (knots < tool_path.u[-1])]
        for moment in np.interp(knots, tool_path.u, tool_path.t):
            step.axvline(moment, color=GREY, linestyle=":", linewidth=1)
        step.plot(tool_path.t[1:], np.diff(tool_path.u), color=BLUE, linestyle="-")
        step.set(xlabel="time [s]", ylabel="step of u in a period", ylim=(0, None))
        step.ticklabel_format(axis="y", scilimits=(0, 0), useMathText=True)
    return figure


@takes_axes
def fluctuation(path, *, ax=None):
    """Feed fluctuation of a tool path by chord, in percent on a logarithmic scale.

    A path of many steps is cut into 300 pieces, and the largest error of each piece is drawn. The last step
    is left out: it is commanded what was left to go, so it has no error of its own. What is below 1e-9 % is
    rounding, and drawn there.

    Parameters
    ----------
    path : ToolPath
    """
    as_kind("path", path, ToolPath)
    values, at = 100 * np.abs(path.chord_fluctuation)[:-1], path.u[1:]
    largest = _percent(values.max(initial=0.0))
    words = f"chord fluctuation over parameter u: {path.stepper} up to {largest}"
    with canvas(8, 3.4, ax, words=words) as (figure, ax):
        first = np.unique(np.linspace(0, len(values), min(len(values), _PIECES), False).astype(int))
        if len(first):
            pieces = np.maximum.reduceat(np.maximum(values, _ROUNDING), first), [*at[first], at[-2]]
            ax.stairs(*pieces, baseline=None, color=BLUE)
        ax.set(yscale="log", xlabel="parameter u", ylabel="chord fluctuation [%]")
        rms = _percent(np.sqrt((values**2).sum() / max(len(values), 1)))
        said = f"{path.stepper}\nlargest {largest}\nrms {rms}"
        ax.annotate(said, (1.02, 0.5), xycoords="axes fraction", va="center", annotation_clip=False)
        plain_log_ticks(ax.yaxis)
    return figure


def _percent(value):
    if value < _ROUNDING:
        return f"below {_ROUNDING:.0e} %"
    return f"{value:.1e} %" if value < 1e-2 else f"{value:.2g} %"


@takes_axes
def orders(periods_s, errors, *, y_label="largest chord fluctuation [%]", ax=None):
    """Error against the period on two logarithmic axes, with the fitted order of each line in the legend.

    Parameters
    ----------
    periods_s : array_like, shape (n,)
    errors : mapping from name to array_like, shape (n,)
        In the unit that ``y_label`` names.
    y_label : str
    """
    named = {}
    for name, values in errors.items():
        order = np.polyfit(np.log(periods_s), np.log(values), 1)[0]
        named[f"{name}: order {order:.2f}"] = values
    x = 1e3 * np.asarray(periods_s)
    return lines(x, named, x_label="period [ms]", y_label=y_label, log="xy", markers=True, ax=ax)


def feed(profile, *, limits=None, curve=None):
    """Speed, acceleration and jerk of a feed profile; the background says what limits the speed.

    The jerk of a plan without a limit of jerk is not drawn: it is zero, but for corners where it is infinite.

    Parameters
    ----------
    profile : FeedProfile
    limits : Limits or mapping, optional
        'speed', 'acceleration', 'jerk' to the greatest value allowed, drawn dashed.
    curve : NurbsCurve, optional
        Adds a second row of labels: the parameter reached.

    Returns
    -------
    matplotlib Figure
    """
    limits = limits if isinstance(limits, Mapping) else getattr(limits, "__dict__", {})
    t = np.unique(np.concatenate([np.linspace(0, profile.duration, 2000), profile.times]))
    rows = [("speed", "mm/s"), ("acceleration", "mm/s²"), ("jerk", "mm/s³")]
    rows = rows[: 3 if profile.jerk(t).any() else 2]
    with canvas(8, 2 * len(rows), rows=len(rows), sharex=True) as (figure, axes):
        for ax, (name, unit) in zip(axes, rows, strict=True):
            ax.plot(t, getattr(profile, name)(t), color=BLUE, linestyle="-")
            ax.set_ylabel(f"{name} [{unit}]")
            for sign in (1, -1) if name != "speed" else (1,):
                if limits.get(name) is not None:
                    ax.axhline(sign * limits[name], color=RED, linestyle="--", linewidth=1)
        _shade(axes[0], profile)
        axes[-1].set_xlabel("time [s]")
        if curve is not None:
            top = axes[0].secondary_xaxis("top")
            marks = np.linspace(*curve.domain, 6)
            lengths = [curve.length(curve.domain[0], u) for u in marks[1:]]
            moments = np.interp([0.0, *lengths], profile.displacement(t), t)
            top.set_xticks(moments, [f"{u:.2g}" for u in marks])
            top.set_xlabel("parameter u")
    return figure


def _shade(ax, profile):
    """A coloured strip for each limit, over the times at which it is active."""
    seen = set()
    for start, stop, limit in profile.stretches():
        label = None if limit in seen else limit.replace("_", " ")
        seen.add(limit)
        colour, hatch = LIMITS.get(limit, OTHER_LIMIT)
        tint = 0.75 + 0.25 * np.array(to_rgb(colour))
        ax.axvspan(
            start, stop, facecolor=tint, edgecolor="white", hatch=hatch, linewidth=0, label=label, zorder=0
        )
    ax.set_ylim(0, None)
    if seen:
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title="limited by")


def leaderboard(rows, *, metric="chord"):
    """Error of each stepper on each curve, a row for each stepper, and its cost beside it.

    A full dot is the largest error, a ring the root mean square. The most accurate on the first curve
    stands on top; a stepper that broke down on a curve has no dot there. Beside the bars of time stand the
    evaluations of a step.

    Parameters
    ----------
    rows : sequence of Score
        As `nurbs_lab.motion.leaderboard` gives them.
    metric : {'chord', 'arc'}

    Returns
    -------
    matplotlib Figure
    """
    curves = list(dict.fromkeys(row.curve for row in rows))
    steppers = {row.stepper: np.inf for row in rows}
    steppers |= {row.stepper: getattr(row, f"{metric}_max") for row in rows if row.curve == curves[0]}
    steppers = sorted(steppers, key=lambda name: np.nan_to_num(steppers[name], nan=np.inf))
    panels = len(curves) + 1
    columns, down = min(panels, 3), -(-panels // 3)
    size = 2.6 * columns + 1.1, (0.27 * len(steppers) + 1.1) * down + 0.2
    with canvas(*size, rows=down, columns=columns, sharey=True, squeeze=False) as (figure, axes):
        axes, beyond = axes.flat[:panels], axes.flat[panels:]
        for ax in beyond:
            ax.remove()
        for ax, name in zip(axes, curves, strict=False):
            mine = [row for row in rows if row.curve == name]
            y = [steppers.index(row.stepper) for row in mine]
            for kind, inside in (("max", BLUE), ("rms", "white")):
                values = 100 * np.maximum([getattr(row, f"{metric}_{kind}") for row in mine], _FLOOR)
                ax.semilogx(values, y, "o", label=kind, color=BLUE, markerfacecolor=inside)
            ax.set(title=name, xlabel=f"{metric} fluctuation [%]")
            ax.xaxis.set_minor_locator(NullLocator())
        costs, counts = (
            [np.mean([getattr(row, kind) for row in rows if row.stepper == name]) for name in steppers]
            for kind in ("ns_per_step", "evaluations_per_step")
        )
        bars = axes[-1].barh(range(len(steppers)), costs, color=ORANGE, height=0.6)
        axes[-1].bar_label(bars, [f"{count:.3g}" for count in counts], padding=3, fontsize=8)
        axes[-1].set(xlabel="time per step [ns]", title="cost")
        axes[-1].margins(x=0.25)
        axes[-1].locator_params(axis="x", nbins=4)
        axes[0].set_yticks(range(len(steppers)), steppers)
        axes[0].invert_yaxis()
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return figure


@takes_axes
def chord_error(*, ax=None):
    """A chord, its arc and the chord error between them, with the right triangle that relates the three.

    Parameters
    ----------
    """
    radius, half = 1.0, 0.55
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
        ax.axis("off")  # not to scale
        ax.legend(loc="lower left")
    return figure


@takes_axes
def binding(path, *, ax=None):
    """The tool path, in the colour and width of the active limit; the legend has the shares of the time.

    Parameters
    ----------
    path : ToolPath
        Of a planned feed; drawn are x and y.
    """
    points = path.points[:, :2]
    chords = np.stack([points[:-1], points[1:], np.full_like(points[1:], np.nan)], axis=1)
    limits = path.feed.limiting(path.t[1:])
    given = [name for name in LIMITS if getattr(path.feed.limits, name, None) is not None]
    broad, high = np.ptp(points, axis=0)
    with canvas(7.5, np.clip(5.0 * high / max(broad, 1e-9) + 0.9, 2.4, 5.0), ax) as (figure, ax):
        for name in dict.fromkeys([*given, *np.unique(limits).tolist()]):
            width = 2 + [*LIMITS, name].index(name)  # always the same one for a limit
            label = f"{name.replace('_', ' ')}, {100 * np.mean(limits == name):.0f} %"
            mine, (colour, _) = chords[limits == name].reshape(-1, 2), LIMITS.get(name, OTHER_LIMIT)
            look = {"linewidth": width, "zorder": 20 - width, "solid_capstyle": "butt"}  # a thin one on top
            ax.plot(*mine.T, "-", color=colour, label=label, **look)
        equal_mm(ax)
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title="limited by")
    return figure
