"""The picture of the page: how the time grows with the work."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from textwrap import fill

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from nurbs_lab.plotting.style import COLOURS, plain_log_ticks

PICTURES = Path(__file__).parent / "pictures"


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
