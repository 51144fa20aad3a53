"""Hardware in pictures: bars of area, waveforms."""

import numpy as np

from nurbs_lab.plotting.style import BLACK, BLUE, COLOURS, PALE, canvas, takes_axes

_HATCHES = ("", "//", "..", "xx", "\\\\", "++")


@takes_axes
def area(groups, *, limits, ax=None):
    """The resources of a chip that a design needs, as bars in per cent of what the chip has.

    Parameters
    ----------
    groups : mapping from resource to (mapping from arrangement to count)
    limits : mapping from resource to count
        What the chip has.
    """
    series = list(dict.fromkeys(name for inner in groups.values() for name in inner))
    width = 0.8 / len(series)
    plain = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}  # hides a line behind it
    with canvas(8, 4.2, ax) as (figure, ax):
        for i, name in enumerate(series):
            shift = (i - (len(series) - 1) / 2) * width
            bars = {
                k + shift: 100 * inner[name] / limits[resource]
                for k, (resource, inner) in enumerate(groups.items())
                if name in inner
            }
            look = {"color": COLOURS[i], "hatch": _HATCHES[i], "edgecolor": "white"}
            drawn = ax.bar(bars.keys(), bars.values(), width, label=name, **look)
            if len(groups) * len(series) <= 14:
                labels = [f"{value:.0f} %" for value in bars.values()]
                ax.bar_label(drawn, labels, padding=2, fontsize=9, bbox=plain)
        ax.set_xticks(range(len(groups)), [f"{name}\n(of {limits[name]:,})" for name in groups])
        ax.grid(visible=False, axis="x")
        # above the bars, below their labels
        ax.axhline(100, color=BLACK, linestyle="--", linewidth=1.2, zorder=2.5)
        ax.set_ylabel("fraction of the chip [%]")
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


@takes_axes
def waveform(signals, *, clock_hz=None, ax=None):
    """Digital signals over clock cycles: bits as steps, buses as boxes with their values.

    Parameters
    ----------
    signals : mapping from name to sequence of numbers, str or None, one a cycle
        A signal of nothing but 0 and 1 is a bit; anything else is a bus. None is an undefined value.
    clock_hz : float, optional
        Adds an axis in µs.
    """
    signals = {str(name): list(row) for name, row in signals.items()}
    count = max(len(values) for values in signals.values())
    words = f"waveforms of {', '.join(signals)} over {count} clock cycles"
    size = max(6, min(14, 0.32 * count + 2)), 0.5 * len(signals) + 1.1
    with canvas(*size, ax, words=words) as (figure, ax):
        for row, values in enumerate(reversed(signals.values())):
            draw = _bit if set(values) <= {0, 1} else _bus
            draw(ax, row, list(values))
        ax.set_yticks(np.arange(len(signals)) + 0.3, list(reversed(signals)))
        ax.tick_params(axis="y", length=0)
        ax.set(xlabel="clock cycle", xlim=(0, count), ylim=(-0.3, len(signals)))
        ax.grid(visible=True, axis="x")
        ax.grid(visible=False, axis="y")
        ax.spines["left"].set_visible(False)
        if clock_hz is not None:
            top = ax.secondary_xaxis("top", (lambda c: 1e6 * c / clock_hz, lambda t: t * clock_hz / 1e6))
            top.set_xlabel("time [µs]")
    return figure


def _bit(ax, row, values):
    edges = np.arange(len(values) + 1)
    ax.stairs(row + 0.6 * np.array(values), edges, baseline=None, color=BLUE, linewidth=1.6)


def _bus(ax, row, values):
    """Equal neighbours stand in one box; slanted ends show the change."""
    slant, begin = 0.15, 0
    for cycle in range(1, len(values) + 1):
        if cycle < len(values) and values[cycle] == values[begin]:
            continue
        a, b, value = begin, cycle, values[begin]
        x = [a, a + slant, b - slant, b, b - slant, a + slant, a]
        y = row + np.array([0.3, 0.6, 0.6, 0.3, 0, 0, 0.3])
        known = value is not None
        ax.fill(x, y, facecolor=PALE if known else "#dddddd", edgecolor=BLUE, linestyle="-", linewidth=1)
        text = str(value) if known else "x"
        if 0.11 * len(text) <= (b - a) * 0.32 + 0.1:
            ax.text((a + b) / 2, row + 0.28, text, ha="center", va="center", fontsize=8)
        begin = cycle
