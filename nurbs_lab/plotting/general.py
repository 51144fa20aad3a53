"""Pictures of any data: lines over an axis, and moving pictures."""

import io

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from nurbs_lab.plotting.picture import Stored, opened, png_of
from nurbs_lab.plotting.stage import image
from nurbs_lab.plotting.style import canvas, plain_log_ticks, takes_axes

PALETTE = 48  # of an animation: fewer make a smaller file
HOLD_MS = 1000  # for which the last frame stands still before an animation starts again


@takes_axes
def lines(x, series, *, x_label, y_label, log="", markers=False, ax=None):
    """Lines over a common axis, in the style of the other pictures.

    Parameters
    ----------
    x : array_like, shape (n,)
    series : mapping from name to array_like, shape (n,), or one array_like
    x_label, y_label : str
        With their units.
    log : {'', 'x', 'y', 'xy'}
        Which axes are logarithmic.
    markers : bool
        Mark every value.
    """
    named = dict(series) if hasattr(series, "items") else {None: series}
    with canvas(7, 3.8, ax) as (figure, ax):
        for (name, values), marker in zip(named.items(), "osD^vPX*" * 9, strict=False):
            ax.plot(x, values, marker=marker if markers else None, label=name)
        ax.set(xlabel=x_label, ylabel=y_label)
        ax.set_xscale("log" if "x" in log else "linear")
        ax.set_yscale("log" if "y" in log else "linear")
        if markers and "x" in log:
            ax.set_xticks(x, [f"{value:,.6g}" for value in x])
            ax.xaxis.minorticks_off()
        elif "x" in log:
            plain_log_ticks(ax.xaxis)
        if "y" in log:
            plain_log_ticks(ax.yaxis)
        if None not in named:
            ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def animation(draw, values, *, alt, frame_s=0.1):
    """A picture that moves wherever a PNG can be shown: one frame for each value, then from the start.

    The file is stored in the notebook, so it plays in JupyterLab, on GitHub and on a static page, and needs
    no kernel. A viewer that does not know animated PNGs shows the last frame.

    Parameters
    ----------
    draw : callable
        Takes one value, returns a Figure or a scene; always of the same size.
    values : sequence
        One for each frame.
    alt : str
        Alternative text: what moves.
    frame_s : float
        Time of a frame, in s; browsers show none for less than 0.01 s.

    Returns
    -------
    Stored
        To be the last line of a cell.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> bell = nl.plotting.animation(lambda n: nl.plotting.lines([0, 1], [0, n], x_label="x", y_label="y"),
    ...                              range(1, 4), alt="a line that rises")
    >>> bell
    <animation of 3 frames: a line that rises>
    """
    frames = [_frame(draw, value) for value in values]
    milliseconds = np.full(len(frames), round(1000.0 * frame_s))  # a PNG holds fractions of small numbers
    milliseconds[-1] += HOLD_MS
    # One palette for all frames: the colours of the largest areas as they are, and more for all the others.
    strip = Image.fromarray(np.vstack([frames[k] for k in (0, len(frames) // 2, -1)]))
    counted = sorted(strip.getcolors(strip.width * strip.height), reverse=True)
    areas = np.array([colour for _, colour in counted[: PALETTE // 4]])
    others = strip.quantize(PALETTE - len(areas), Image.Quantize.MAXCOVERAGE, kmeans=2).getpalette()
    palette = np.vstack([areas, np.reshape(others, (-1, 3))])
    frames = [_coloured(frame, palette) for frame in frames]
    data = io.BytesIO()
    frames[-1].save(
        data, "png", save_all=True, default_image=True, append_images=frames,
        duration=milliseconds.tolist(), loop=0, optimize=True,
    )  # fmt: skip
    return Stored(data.getvalue(), alt, f"animation of {len(frames)} frames")


def _coloured(frame, palette):
    """A picture in the nearest colours of a palette; Pillow's own search errs by a few levels."""
    packed = np.asarray(frame, np.int64) @ (65536, 256, 1)
    found, which = np.unique(packed, return_inverse=True)
    given = np.column_stack([found >> 16, found >> 8 & 255, found & 255])
    nearest = ((given[:, None] - palette) ** 2).sum(axis=2).argmin(axis=1)
    picture = Image.fromarray(nearest.astype(np.uint8)[which.reshape(packed.shape)])
    picture.putpalette(palette.ravel().tolist())
    return picture


def _frame(draw, value):
    drawn = draw(value)
    if isinstance(drawn, Figure):
        return opened(png_of(drawn, tight=False))
    return image(drawn)
