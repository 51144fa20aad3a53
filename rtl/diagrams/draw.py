"""Draw the block diagrams of rtl/README.md: ``python rtl/diagrams/draw.py``."""

from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt

mpl.rcParams.update({"svg.hashsalt": "nurbs_lab", "svg.fonttype": "none", "font.family": "sans-serif"})
HERE = Path(__file__).parent
INK, PAPER_BOX, OUR_BOX = "#22313f", "#dbe9f4", "#f1eee4"


def box(axes, x, y, width, height, text, paper=True):
    """A module: blue if the paper has it, sand if it is ours."""
    face = PAPER_BOX if paper else OUR_BOX
    axes.add_patch(plt.Rectangle((x, y), width, height, facecolor=face, edgecolor=INK, linewidth=1.2))
    axes.text(x + width / 2, y + height / 2, text, ha="center", va="center", fontsize=9, color=INK)


def arrow(axes, start, end, text="", above=0.12):
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.1})
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2 + above)
    axes.text(*middle, text, ha="center", va="bottom", fontsize=7.5, color=INK)


def sheet(width, height):
    figure, axes = plt.subplots(figsize=(width * 0.8, height * 0.8))
    axes.set(xlim=(0, width), ylim=(0, height), aspect="equal")
    axes.axis("off")
    return figure, axes


def save(figure, name):
    figure.savefig(HERE / f"{name}.svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def interpolator():
    figure, axes = sheet(14.6, 6.2)
    box(axes, 1.6, 0.3, 9.9, 5.6, "", paper=False)
    axes.text(1.8, 5.6, "nurbs_interpolator", fontsize=9, va="center", color=INK)
    box(axes, 2.0, 3.9, 1.9, 1.2, "registers", paper=False)
    box(axes, 2.0, 1.0, 1.9, 1.2, "load_guard", paper=False)
    box(axes, 4.9, 0.6, 6.2, 4.7, "", paper=False)
    axes.text(5.1, 5.05, "stepper", fontsize=9, va="center", color=INK)
    box(axes, 5.3, 3.6, 1.3, 0.9, "vt")
    box(axes, 7.3, 3.8, 1.9, 0.8, "runge_kutta")
    box(axes, 7.3, 2.6, 1.9, 0.8, "adams")
    box(axes, 9.6, 3.2, 1.3, 0.8, "corrector", paper=False)
    box(axes, 7.3, 1.0, 1.9, 0.8, "slope\n1 or 4 rows")
    arrow(axes, (0.2, 4.5), (2.0, 4.5), "AXI4-Lite")
    arrow(axes, (3.9, 4.5), (4.9, 4.5), "go, load")
    arrow(axes, (2.95, 3.9), (2.95, 2.2))
    arrow(axes, (3.9, 1.6), (4.9, 1.6), "complete")
    arrow(axes, (6.6, 4.2), (7.3, 4.2), "v")
    arrow(axes, (6.6, 3.8), (7.3, 3.0))
    arrow(axes, (9.2, 4.2), (9.6, 3.8))
    arrow(axes, (9.2, 3.0), (9.6, 3.4))
    arrow(axes, (8.05, 2.6), (8.05, 1.8), "")
    axes.text(7.95, 2.2, "u, du, s", ha="right", va="center", fontsize=7.5, color=INK)
    arrow(axes, (8.45, 1.8), (8.45, 2.6), "")
    axes.text(8.55, 2.2, "C, K", ha="left", va="center", fontsize=7.5, color=INK)
    axes.plot([10.9, 11.5], [3.6, 3.6], color=INK, linewidth=1.1)
    arrow(axes, (11.5, 3.6), (14.4, 3.6), "AXI4-Stream: u, C(u)")
    save(figure, "interpolator")


def row():
    figure, axes = sheet(14.8, 3.6)
    box(axes, 1.2, 0.3, 11.1, 3.0, "", paper=False)
    axes.text(1.4, 3.0, "slope: one row of Figs. 5 and 6", fontsize=9, va="center", color=INK)
    box(axes, 1.6, 1.1, 1.2, 1.2, "u + shift\ncuk")
    box(axes, 3.4, 1.1, 1.6, 1.2, "cu\nC(u)")
    box(axes, 5.7, 1.1, 1.3, 1.2, "chord\nA - B")
    box(axes, 7.6, 0.6, 4.4, 2.2, "")
    axes.text(7.8, 2.55, "kout", fontsize=9, va="center", color=INK)
    box(axes, 7.8, 1.2, 1.1, 0.9, "multiply", paper=False)
    box(axes, 9.2, 1.2, 1.2, 0.9, "square_\nroot", paper=False)
    box(axes, 10.7, 1.2, 1.1, 0.9, "divide", paper=False)
    arrow(axes, (0.2, 1.7), (1.6, 1.7), "u, K")
    arrow(axes, (2.8, 1.7), (3.4, 1.7))
    arrow(axes, (5.0, 1.7), (5.7, 1.7), "points")
    arrow(axes, (7.0, 1.7), (7.8, 1.7))
    arrow(axes, (8.9, 1.7), (9.2, 1.7))
    arrow(axes, (10.4, 1.7), (10.7, 1.7))
    axes.plot([11.8, 12.3], [1.7, 1.7], color=INK, linewidth=1.1)
    arrow(axes, (12.3, 1.7), (14.6, 1.7), "K = s du / |chord|")
    save(figure, "row")


def arrangements():
    figure, axes = sheet(13.5, 5.6)
    for column, (name, rows, note) in enumerate(
        [
            ("serial", ["row: 2 points\n4 times"], "8 points, one after the other"),
            ("parallel", ["row: 2 points"] * 4, "8 points at once: 8 modules cu"),
            ("cached", ["row: 1 point"], "1 point; the others are kept"),
        ]
    ):
        left = 0.3 + 4.5 * column
        axes.text(left + 2.0, 5.3, name, ha="center", fontsize=10, weight="bold", color=INK)
        for i, text in enumerate(rows):
            height = 3.1 if len(rows) == 1 else 4.2 - 1.05 * i
            box(axes, left, height, 1.9, 0.85, text)
            arrow(axes, (left + 1.9, height + 0.42), (left + 2.7, 3.0))
        if name == "cached":
            box(axes, left, 1.6, 1.9, 0.85, "3 older K,\nC before", paper=False)
            arrow(axes, (left + 1.9, 2.02), (left + 2.7, 2.7))
        box(axes, left + 2.7, 2.4, 1.2, 0.95, "ui_out")
        axes.text(left + 2.0, 0.5, note, ha="center", fontsize=8.5, color=INK)
    save(figure, "arrangements")


interpolator()
row()
arrangements()
