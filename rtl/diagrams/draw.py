"""Draw the block diagrams of rtl/README.md and of notebooks 08 and 09: ``python rtl/diagrams/draw.py``."""

from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt

mpl.rcParams.update({"svg.hashsalt": "nurbs_lab", "svg.fonttype": "none", "font.family": "sans-serif"})
HERE = Path(__file__).parent
BACK = ("ⱼ", "ⱼ₋₁", "ⱼ₋₂", "ⱼ₋₃", "ⱼ₋₄")
INK, PAPER_BOX, OUR_BOX = "#22313f", "#dbe9f4", "#f1eee4"


def box(axes, x, y, width, height, text, paper=True, inferred=False, color=None):
    """A module: blue if the paper has it, sand if it is ours; dashed if one more of it is inferred."""
    look = {"facecolor": color or (PAPER_BOX if paper else OUR_BOX), "linestyle": "--" if inferred else "-"}
    axes.add_patch(plt.Rectangle((x, y), width, height, edgecolor=INK, linewidth=1.2, **look))
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


def save(figure, name, title):
    """Write the file; the title is what a screen reader says."""
    figure.savefig(HERE / f"{name}.svg", bbox_inches="tight", metadata={"Date": None, "Title": title})
    plt.close(figure)


def interpolator():
    figure, axes = sheet(14.6, 6.2)
    box(axes, 1.6, 0.3, 9.9, 5.6, "", paper=False)
    note(axes, 1.8, 5.6, "nurbs_interpolator")
    box(axes, 2.0, 3.9, 1.9, 1.2, "registers", paper=False)
    box(axes, 2.0, 1.0, 1.9, 1.2, "load_guard", paper=False)
    box(axes, 4.9, 0.6, 6.2, 4.7, "", paper=False)
    note(axes, 5.1, 5.05, "stepper")
    box(axes, 5.1, 2.4, 0.8, 1.0, "vt")
    box(axes, 6.5, 3.6, 1.6, 0.9, "runge_kutta\nwith ui_out")
    box(axes, 6.5, 1.3, 1.6, 0.9, "adams\nwith ui_out")
    box(axes, 9.5, 2.3, 1.4, 1.2, "slope\n1 or 4 rows", paper=False)
    arrow(axes, (0.2, 4.5), (2.0, 4.5), "AXI4-Lite")
    arrow(axes, (3.9, 4.5), (4.9, 4.5), "go, load")
    arrow(axes, (2.95, 3.9), (2.95, 2.2))
    arrow(axes, (3.9, 1.6), (4.9, 1.6), "complete")
    arrow(axes, (5.9, 3.2), (6.5, 3.8), "v")
    arrow(axes, (5.9, 2.6), (6.5, 2.0), "v")
    arrow(axes, (8.1, 4.3), (10.5, 3.5), "u, du, s")
    arrow(axes, (9.8, 3.5), (8.1, 3.8), "C, K", -0.4)
    arrow(axes, (8.1, 1.5), (10.5, 2.3), "u, du, s", -0.45)
    arrow(axes, (9.8, 2.3), (8.1, 2.0), "C, K")
    axes.plot([11.1, 11.5], [3.6, 3.6], color=INK, linewidth=1.1)
    arrow(axes, (11.5, 3.6), (14.4, 3.6), "AXI4-Stream: u, C(u)")
    save(figure, "interpolator", "The modules of nurbs_interpolator and the wires between them")


def machine():
    """What ships: exact slopes on the board."""
    figure, axes = sheet(12.4, 9.4)
    machine_boxes(axes)
    machine_wires(axes)
    save(figure, "machine", "The machine that ships: from the serial line to the pins of three axes")


def machine_boxes(axes):
    box(axes, 2.8, 3.3, 9.5, 6.0, "", paper=False)
    note(axes, 3.0, 9.0, "nurbs_interpolator")
    box(axes, 0.1, 7.0, 1.7, 0.9, "uart_bridge", paper=False)
    box(axes, 0.1, 4.6, 1.7, 0.9, "watchdog", paper=False)
    box(axes, 3.1, 7.0, 1.6, 0.9, "registers", paper=False)
    box(axes, 3.1, 4.6, 1.6, 0.9, "load_guard", paper=False)
    box(axes, 5.4, 3.9, 6.6, 4.8, "", paper=False)
    note(axes, 5.6, 8.4, "streamer")
    box(axes, 5.7, 7.0, 1.5, 0.9, "banks", paper=False)
    box(axes, 8.0, 7.0, 1.6, 0.9, "exact_step", paper=False)
    box(axes, 10.3, 7.0, 1.4, 0.9, "horner", paper=False)
    box(axes, 5.7, 4.6, 1.5, 0.9, "feed_table", paper=False)
    box(axes, 7.9, 4.6, 1.8, 0.9, "feed_override", paper=False)
    box(axes, 10.2, 4.6, 1.6, 0.9, "soft_limits", paper=False)
    box(axes, 0.1, 0.6, 1.7, 1.1, "inputs:\nedges and\ntheir position", paper=False)
    box(axes, 2.7, 0.7, 2.0, 0.9, "board_registers", paper=False)
    box(axes, 6.2, 0.6, 2.1, 1.1, "axes:\n3 x step_dir", paper=False)
    box(axes, 9.1, 0.6, 1.9, 1.1, "emergency_\nstop", paper=False)


def machine_wires(axes):
    arrow(axes, (0.95, 9.2), (0.95, 7.9))
    note(axes, 1.05, 8.6, "serial line")
    arrow(axes, (0.95, 5.5), (0.95, 7.0))
    note(axes, 1.05, 6.2, "silence:\nstop")
    arrow(axes, (1.8, 7.45), (3.1, 7.45))
    note(axes, 1.82, 7.7, "AXI4-Lite")
    axes.plot([2.35, 2.35], [7.45, 1.15], color=INK, linewidth=1.1)
    arrow(axes, (2.35, 1.15), (2.7, 1.15))
    arrow(axes, (2.35, 1.15), (1.8, 1.15))
    arrow(axes, (0.95, 0.0), (0.95, 0.6))
    note(axes, 1.05, 0.2, "limit, home, probe")
    axes.plot([0.95, 0.95, 3.5], [1.7, 2.5, 2.5], color=INK, linewidth=1.1)
    arrow(axes, (3.5, 2.5), (3.5, 3.3))
    note(axes, 3.6, 2.85, "halt")
    arrow(axes, (3.9, 7.0), (3.9, 5.5))
    note(axes, 4.0, 6.2, "load")
    arrow(axes, (4.7, 7.45), (5.7, 7.45))
    note(axes, 4.9, 7.7, "load")
    arrow(axes, (4.7, 5.05), (5.4, 5.05))
    arrow(axes, (6.45, 7.0), (6.45, 5.5))
    arrow(axes, (7.2, 5.05), (7.9, 5.05))
    arrow(axes, (8.8, 5.5), (8.8, 7.0))
    note(axes, 8.9, 6.2, "distance")
    arrow(axes, (7.2, 7.45), (8.0, 7.45))
    note(axes, 7.25, 7.7, "|C'|²")
    arrow(axes, (9.6, 7.45), (10.3, 7.45))
    note(axes, 9.9, 7.7, "t")
    arrow(axes, (11.0, 7.0), (11.0, 5.5))
    note(axes, 11.1, 6.2, "C(t)")
    axes.plot([11.0, 11.0, 7.6], [4.6, 2.5, 2.5], color=INK, linewidth=1.1)
    arrow(axes, (7.6, 2.5), (7.6, 1.7))
    note(axes, 7.75, 2.85, "a point per period, and outputs")
    arrow(axes, (6.6, 1.7), (6.6, 3.3))
    note(axes, 5.7, 2.5, "permit")
    arrow(axes, (4.7, 1.15), (6.2, 1.15))
    note(axes, 4.8, 1.4, "origin, scale")
    arrow(axes, (8.3, 1.15), (9.1, 1.15))
    arrow(axes, (11.0, 1.35), (12.3, 1.35))
    note(axes, 11.1, 1.65, "motors")
    note(axes, 11.1, 0.4, "stop\ncontact")
    arrow(axes, (12.3, 0.85), (11.0, 0.85))


def note(axes, x, y, text):
    axes.text(x, y, text, ha="left", va="center", fontsize=9, color=INK)


def row():
    figure, axes = sheet(14.8, 3.6)
    box(axes, 1.2, 0.3, 11.1, 3.0, "", paper=False)
    note(axes, 1.4, 3.0, "slope: one row of Figs. 5 and 6")
    box(axes, 1.6, 1.1, 1.2, 1.2, "u + shift\ncuk")
    box(axes, 3.4, 1.1, 1.6, 1.2, "cu\nC(u)")
    box(axes, 5.7, 1.1, 1.3, 1.2, "chord\nA - B", paper=False)
    box(axes, 7.6, 0.6, 4.4, 2.2, "")
    note(axes, 7.8, 2.55, "kout")
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
    save(figure, "row", "One row: from a parameter to a slope")


def arrangements():
    figure, axes = sheet(13.5, 5.6)
    for column, (name, units, rows, said) in enumerate(
        [
            ("serial", 1, ["2 points\n4 times"], "8 points, one after the other: 1 module cu"),
            ("parallel", 2, ["2 points"] * 4, "8 points at once: 8 modules cu"),
            ("cached", 1, ["1 point"], "1 point; the others are kept: 1 module cu"),
        ]
    ):
        left = 0.3 + 4.5 * column
        axes.text(left + 2.0, 5.3, name, ha="center", fontsize=10, weight="bold", color=INK)
        for i, text in enumerate(rows):
            height = 3.1 if len(rows) == 1 else 4.2 - 1.05 * i
            box(axes, left, height, 1.9, 0.85, "")
            for k in range(units):
                box(axes, left + 0.08 + 0.44 * k, height + 0.12, 0.4, 0.6, "cu", color="#8fbbdc")
            axes.text(left + 1.43, height + 0.42, text, ha="center", va="center", fontsize=8, color=INK)
            arrow(axes, (left + 1.9, height + 0.42), (left + 2.7, 3.0))
        if name == "cached":
            box(axes, left, 1.6, 1.9, 0.85, "3 older K,\nC before", paper=False)
            arrow(axes, (left + 1.9, 2.02), (left + 2.7, 2.7))
        box(axes, left + 2.7, 2.4, 1.2, 0.95, "ui_out")
        axes.text(left + 2.0, 0.5, said, ha="center", fontsize=8.5, color=INK)
    save(figure, "arrangements", "The Adams step: serial, parallel and cached")


def wire(axes, x, y, end):
    """Straight to x, then an arrow."""
    axes.plot([1.4, x], [y, y], color=INK, linewidth=1.1)
    arrow(axes, (x, y), end)


def figure_5():
    """The paper's Fig. 5, inferred from its text: each slope of Runge-Kutta needs the one before."""
    figure, axes = sheet(14.4, 6.2)
    box(axes, 0.2, 0.2, 1.2, 5.8, "vt\n\nv at t,\nt + T/2,\nt + T")
    for i, shift in enumerate(("", " + T/2 K₁", " + T/2 K₂", " + T K₃")):
        y = 4.9 - 1.5 * i
        name = "cuk" if shift else "cu"
        box(axes, 2.9, y + 0.42, 3.2, 0.42, f"{name}: C(uⱼ{shift})", inferred=i > 0)
        box(axes, 2.9, y - 0.05, 3.2, 0.42, f"{name}: C(uⱼ₋₁{shift})", inferred=i != 1)
        box(axes, 7.5, y, 1.5, 0.8, "Kout", inferred=i > 0)
        wire(axes, 6.9, y + 0.97, (7.5, y + 0.7))
        arrow(axes, (6.1, y + 0.4), (7.5, y + 0.4))
        arrow(axes, (9.0, y + 0.4), (11.4, 3.0 + 0.4 * (1.5 - i)), "K" + "₁₂₃₄"[i])
        if i < 3:
            axes.plot([8.25, 8.25, 2.3, 2.3], [y, y - 0.28, y - 0.28, y - 1.1], color=INK, linewidth=1.1)
            arrow(axes, (2.3, y - 1.1), (2.9, y - 1.1))
    box(axes, 11.4, 2.3, 1.4, 1.4, "ui_out")
    arrow(axes, (12.8, 3.0), (14.3, 3.0), "uⱼ₊₁")
    save(figure, "figure_5", "The paper's Fig. 5, inferred: four slopes one after the other, then ui_out")


def figure_6():
    """The paper's Fig. 6, inferred from its text: four quotients of Adams side by side."""
    figure, axes = sheet(13.4, 5.6)
    box(axes, 0.2, 0.4, 1.2, 5.1, "vt\n\nv(tⱼ)\nto\nv(tⱼ₋₃)")
    for i in range(4):
        y = 4.4 - 1.3 * i
        for k in (0, 1):
            box(axes, 2.6, y + 0.42 - 0.47 * k, 2.2, 0.42, f"cu: C(u{BACK[i + k]})", inferred=i + k > 0)
        box(axes, 6.2, y, 1.5, 0.8, "Kout", inferred=i > 0)
        arrow(axes, (4.8, y + 0.4), (6.2, y + 0.4))
        wire(axes, 5.6, y + 0.95, (6.2, y + 0.7))
        weight = ("55", "−59", "37", "−9")[i]
        arrow(axes, (7.7, y + 0.4), (10.4, 2.8 + 0.4 * (1.5 - i)), f"{weight} / 24", 0.2)
    box(axes, 10.4, 2.1, 1.4, 1.4, "ui_out")
    arrow(axes, (11.8, 2.8), (13.3, 2.8), "uⱼ₊₁")
    save(figure, "figure_6", "The paper's Fig. 6, inferred: four quotients side by side, then ui_out")


machine()
interpolator()
row()
arrangements()
figure_5()
figure_6()
