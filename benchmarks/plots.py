"""The pictures of the page: bars of ratios, and growth curves."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from textwrap import fill

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PICTURES = Path(__file__).parent / "pictures"
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]


def exponent(line) -> float:
    """The power k of time ~ size^k, fitted through the last three of ``[(size, time), ...]``."""
    size, time = np.log(line[-3:]).T
    return float(np.polyfit(size, time, 1)[0])


def lines(rows) -> dict[str, list]:
    """The growth curves of a series: ``{contestant: [(size, time), ...]}``."""
    found = {}
    for row in rows:
        for name, seconds in row["seconds"].items():
            found.setdefault(name, []).append((row["size"], seconds))
    return found


def bars_line(room) -> str:
    """The picture of `bars` on the page."""
    return f"![How many times longer the peers take than nurbs_lab: {room}](pictures/{room}-ratios.png)"


def growth_line() -> str:
    """The picture of `growth` on the page."""
    return "![Time against size, a panel for each way to ask for more](pictures/growth.png)"


def clear() -> None:
    """Forget the pictures of earlier pages."""
    for file in PICTURES.glob("*.png"):
        file.unlink()


def bars(room, rows) -> None:
    """How many times longer each peer takes, one group of bars a row; a tick at what is asked for."""
    rows = [row for row in rows if len(row["seconds"]) > 1]
    peers = list(dict.fromkeys(name for row in rows for name in row["seconds"] if name != "nurbs_lab"))
    colors = {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(peers)}
    height = sum(0.3 + 0.2 * len(row["seconds"]) for row in rows)
    figure, axes = plt.subplots(figsize=(8, 1 + height), layout="constrained")
    y, middles = 0.0, []
    for row in rows:
        asked = {bar["peer"]: bar["factor"] for bar in row["bars"]}
        inside = [name for name in row["seconds"] if name != "nurbs_lab"]
        for j, name in enumerate(inside):
            ratio = row["seconds"][name] / row["seconds"]["nurbs_lab"]
            axes.barh(y + j, ratio - 1, 0.85, left=1, color=colors[name])
            if name in asked:
                color = "black" if ratio >= asked[name] else "red"
                axes.plot([asked[name]] * 2, [y + j - 0.43, y + j + 0.43], color=color, linewidth=2)
        middles.append(y + (len(inside) - 1) / 2)
        y += len(inside) + 0.8
    for name in peers:
        axes.barh(0, 0, left=1, color=colors[name], label=name)
    axes.plot([], [], color="black", linewidth=2, label="asked for (red: missed)")
    axes.axvline(1, color="black", linewidth=1)
    axes.set(xscale="log", yticks=middles, yticklabels=[fill(row["work"], 40) for row in rows])
    axes.set_xlabel("time of the peer / time of nurbs_lab")
    axes.invert_yaxis()
    axes.set_xlim(left=min(0.7, axes.get_xlim()[0]))
    figure.legend(loc="outside upper center", ncols=4, fontsize=9, frameon=False)
    save(figure, f"{room}-ratios")


def growth(series) -> None:
    """Time against size, log-log, a panel for each series ``{name: rows}``."""
    columns = 4
    figure, panels = plt.subplots(
        ceil(len(series) / columns),
        columns,
        figsize=(16, 3.6 * ceil(len(series) / columns)),
        layout="constrained",
        squeeze=False,
    )
    for axes in panels.flat[len(series) :]:
        axes.remove()
    for axes, (name, rows) in zip(panels.flat, series.items(), strict=False):
        for (peer, line), color in zip(lines(rows).items(), ["black", *PALETTE], strict=False):
            label = f"{peer} ~ n$^{{{exponent(line):.2f}}}$" if len(line) > 2 else peer
            axes.loglog(*zip(*line, strict=True), "o-", color=color, label=label, markersize=4)
        _slope_guides(axes, lines(rows)["nurbs_lab"])
        axes.set(title=name, xlabel=name.split(" in ")[1], ylabel="time / s")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=9)
    save(figure, "growth")


def _slope_guides(axes, line):
    """Grey lines of time proportional to the size and to its root, below our own last point."""
    size, time = np.array(line[-3:]).T
    for power, name in ((1.0, "n"), (0.5, "√n")):
        guide = 0.6 * time[-1] * (size / size[-1]) ** power
        axes.plot(size, guide, ":", color="grey", zorder=0)
        axes.annotate(name, (size[0], guide[0]), color="grey", ha="right", va="center")
    axes.margins(0.08)


def save(figure, name) -> None:
    """Write a picture of the page."""
    PICTURES.mkdir(exist_ok=True)
    figure.savefig(PICTURES / f"{name}.png", dpi=110)
    plt.close(figure)
