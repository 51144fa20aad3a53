"""The readable page and its pictures, made from ``results.json``: ``python -m benchmarks.page``."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from benchmarks.limits import LEAST, share

HERE = Path(__file__).parent
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]


def time(seconds: float) -> str:
    """0.00017 as '170 µs'."""
    for unit, factor in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def table(rows, limits) -> list[str]:
    """One room's table: our time, the peers as multiples, the bars, the distance to the limit."""
    lines = ["| work | nurbs_lab | first call | peers, as multiples | asked | at best |", "| --- " * 6 + "|"]
    for row in rows:
        ours = row["seconds"]["nurbs_lab"]
        ratios = {name: value / ours for name, value in row["seconds"].items() if name != "nurbs_lab"}
        asked = [
            f"{bar['peer']} ≥ {bar['factor']:g} × {'✓' if ratios[bar['peer']] >= bar['factor'] else 'missed'}"
            for bar in row["bars"]
            if bar["peer"] in ratios
        ]
        others = [f"{name} {ratio:.3g} ×" for name, ratio in ratios.items()]
        others += [f"{name} {value:.3g}" for name, value in row["figures"].items() if name not in LEAST]
        part = share(row, limits)
        cells = [
            row["work"] + (f" *{row['notes']}*" if row["notes"] else ""),
            time(ours),
            time(row["first_call"]) if row["first_call"] else "–",
            ", ".join(others) or "–",
            ", ".join(asked) or "–",
            f"{part:.0%}" if part else "–",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def bars(room, rows) -> str:
    """How many times longer each peer takes, one group of bars a row."""
    rows = [row for row in rows if len(row["seconds"]) > 1 and not row["series"]]
    if not rows:
        return ""
    peers = list(dict.fromkeys(name for row in rows for name in row["seconds"] if name != "nurbs_lab"))
    figure, axes = plt.subplots(figsize=(8, 0.8 + 0.62 * len(rows)), layout="constrained")
    for k, row in enumerate(rows):
        inside = [name for name in row["seconds"] if name != "nurbs_lab"]
        for j, name in enumerate(inside):
            axes.barh(
                k + (j - (len(inside) - 1) / 2) * 0.8 / len(inside),
                row["seconds"][name] / row["seconds"]["nurbs_lab"],
                0.75 / len(inside),
                color=PALETTE[peers.index(name) % len(PALETTE)],
            )
    for k, name in enumerate(peers):
        axes.barh(0, 0, color=PALETTE[k % len(PALETTE)], label=name)
    axes.axvline(1, color="black", linewidth=1)
    axes.set(xscale="log", yticks=range(len(rows)), yticklabels=[row["work"] for row in rows])
    axes.set_xlabel("time of the peer / time of nurbs_lab")
    axes.invert_yaxis()
    axes.legend(loc="best", fontsize=9)
    return save(figure, f"{room}-ratios", f"How many times longer the peers take than nurbs_lab: {room}")


def growth(room, rows) -> str:
    """Time against size, log-log, one panel a series."""
    series = defaultdict(list)
    for row in rows:
        if row["series"]:
            series[row["series"]].append(row)
    if not series:
        return ""
    figure, panels = plt.subplots(
        1, len(series), figsize=(4.2 * len(series), 3.6), layout="constrained", squeeze=False
    )
    for axes, (name, points) in zip(panels[0], series.items(), strict=True):
        who = list(dict.fromkeys(peer for row in points for peer in row["seconds"]))
        for peer, color in zip(who, ["black", *PALETTE], strict=False):
            line = [(row["size"], row["seconds"][peer]) for row in points if peer in row["seconds"]]
            axes.loglog(*zip(*sorted(line), strict=True), "o-", color=color, label=peer)
        axes.set(xlabel=name, ylabel="time / s")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=9)
    return save(figure, f"{room}-growth", f"Time against size: {room}")


def save(figure, name, words) -> str:
    """Write the picture; return its line of Markdown."""
    (HERE / "pictures").mkdir(exist_ok=True)
    figure.savefig(HERE / "pictures" / f"{name}.png", dpi=110)
    plt.close(figure)
    return f"![{words}](pictures/{name}.png)"


def main() -> None:
    """Rewrite the page."""
    results = json.loads((HERE / "results.json").read_text())
    machine, versions, limits = results["machine"], results["versions"], results["limits"]
    page = [
        "# Benchmarks",
        "",
        "Made by `make bench`, all peers in one run on one machine: medians of interleaved repeats.",
        "*Multiples* say how many times longer the peer takes. *At best* is the least time that the bytes",
        "and operations of the work could take on this machine, as a share of the time taken.",
        "",
        f"{machine['processor']}, {machine['system']}, Python {machine['python']}; one core copies "
        f"{limits['bytes_per_s'] / 1e9:.1f} GB/s and does {limits['operations_per_s'] / 1e9:.1f} G flop/s. "
        + ", ".join(f"{name} {version}" for name, version in versions.items())
        + ".",
    ]
    for room in dict.fromkeys(row["room"] for row in results["rows"]):
        rows = [row for row in results["rows"] if row["room"] == room]
        page += ["", f"## {room}", "", *table(rows, limits), "", bars(room, rows), "", growth(room, rows)]
    (HERE / "README.md").write_text("\n".join(page).rstrip() + "\n")


if __name__ == "__main__":
    main()
