"""The pictures of the page: bars of ratios, and how the time grows with the work."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from textwrap import fill

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from nurbs_lab.plotting.style import COLOURS, plain_log_ticks

PICTURES = Path(__file__).parent / "pictures"


def bars_line(room) -> str:
    """The picture of `bars` on the page."""
    return f"![How many times longer the peers take than nurbs_lab: {room}](pictures/{room}-ratios.png)"


def clear() -> None:
    """Forget the pictures of earlier pages."""
    for file in PICTURES.glob("*.png"):
        file.unlink()


def bars(room, rows) -> None:
    """How many times longer each peer takes, one group of bars a row; a tick at what is asked for."""
    rows = [row for row in rows if len(row["seconds"]) > 1]
    peers = list(dict.fromkeys(name for row in rows for name in row["seconds"] if name != "nurbs_lab"))
    colors = {name: COLOURS[k % 6] for k, name in enumerate(peers)}
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
    if any(row["bars"] for row in rows):
        axes.plot([], [], color="black", linewidth=2, label="asked for (red: missed)")
    axes.axvline(1, color="black", linewidth=1)
    axes.set(xscale="log", yticks=middles, yticklabels=[fill(row["work"], 40) for row in rows])
    axes.set_xlabel("time of the peer / time of nurbs_lab")
    axes.invert_yaxis()
    axes.set_xlim(left=min(0.7, axes.get_xlim()[0]))
    plain_log_ticks(axes.xaxis)
    figure.legend(loc="outside upper center", ncols=3, fontsize=9, frameon=False)
    save(figure, f"{room}-ratios")


GROWTH_LINE = "![Time against workers, periods and gigabytes](pictures/growth.png)"
#: What grows, by the name of its figure: the axis, and what is drawn over it.
GROWTH = {
    "workers": ("workers on Dask", "times faster than one process"),
    "periods": ("periods of the program", "time in s"),
    "GB": ("size of the file in GB", "time in s"),
}


def growth(rows) -> None:
    """One panel for each quantity of `GROWTH` that rows have."""
    grown = {name: [row for row in rows if name in row["figures"]] for name in GROWTH}
    grown = {name: rows for name, rows in grown.items() if rows}
    if not grown:
        return
    figure, panels = plt.subplots(1, len(grown), figsize=(9, 3.2), layout="constrained", squeeze=False)
    for axes, (name, rows) in zip(panels[0], grown.items(), strict=True):
        lines = defaultdict(list)
        for row in rows:
            value, label = row["seconds"]["nurbs_lab"], ""
            if name == "workers":
                value, label = row["seconds"]["one process"] / value, row["work"].split(" on ")[0]
            lines[label].append((row["figures"][name], value))
        for color, (label, points) in zip(COLOURS, lines.items(), strict=False):
            axes.plot(*zip(*points, strict=True), "o-", color=color, label=fill(label, 22) or None)
        axes.set(xlabel=GROWTH[name][0], ylabel=GROWTH[name][1])
        if name == "workers":
            axes.set(xticks=sorted({row["figures"][name] for row in rows}), ylim=(0, None))
            axes.legend(fontsize=8, frameon=False)
        else:
            axes.set(xscale="log", yscale="log")
            plain_log_ticks(axes.xaxis)
            plain_log_ticks(axes.yaxis)
    save(figure, "growth")


def save(figure, name) -> None:
    """Write a picture of the page."""
    PICTURES.mkdir(exist_ok=True)
    figure.savefig(PICTURES / f"{name}.png", dpi=110)
    plt.close(figure)
