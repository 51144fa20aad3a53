"""Figures of matplotlib as PNG files, with an alternative text for readers who cannot see them."""

import base64
import io

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator
from PIL import Image


class Picture(Figure):
    """A figure that a notebook stores together with its alternative text."""

    def _ipython_display_(self):
        from IPython.display import display

        stored = stored_png(Image.open(io.BytesIO(png_of(self))).convert("RGB"))
        data = {"image/png": base64.b64encode(stored).decode(), "text/plain": repr(self)}
        display(data, raw=True, metadata={"image/png": {"alt": words(self)}})


def png_of(figure, *, tight=True):
    """A figure as the bytes of a PNG file, cut to its content unless the size has to stay the same."""
    data = io.BytesIO()
    figure.savefig(data, format="png", bbox_inches="tight" if tight else None)
    return data.getvalue()


def sheet(files, width=700):
    """Several PNG files one below the other, as the bytes of one."""
    pictures = [Image.open(io.BytesIO(file)).convert("RGB") for file in files]
    pictures = [one.resize((width, one.height * width // one.width)) for one in pictures]
    whole = Image.new("RGB", (width, sum(one.height for one in pictures)), "white")
    top = 0
    for one in pictures:
        whole.paste(one, (0, top))
        top += one.height
    return stored_png(whole)


def stored_png(image):
    """A Pillow image as a PNG file of 256 colours, a third as large; rare ones, such as red spots, stay."""
    return png_file(image.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2))


def png_file(image):
    """A Pillow image as the bytes of a PNG file, as small as it gets."""
    data = io.BytesIO()
    image.save(data, "png", optimize=True)
    return data.getvalue()


def words(figure):
    """Alternative text of a figure: its label if it has one, otherwise its axes, titles and legends.

    Parameters
    ----------
    figure : matplotlib Figure

    Returns
    -------
    str
    """
    if figure.get_label():
        return figure.get_label()
    plots = [ax for ax in figure.axes if not hasattr(ax, "_colorbar")]
    bars = [ax for ax in figure.axes if hasattr(ax, "_colorbar")]
    parts = [
        _over(figure.get_supylabel(), figure.get_supxlabel()),
        *map(_panel, plots),
        *(f"colour for {ax.get_ylabel()}" for ax in bars),
        *map(_entries, figure.legends),
    ]
    return "; ".join(filter(None, parts))


def _panel(ax):
    """'title: y label from least to greatest over x label and its range, showing the names of the legend'."""
    if not ax.axison:
        return ax.get_title()
    bounds = ax.dataLim
    axes = _over(
        _axis(ax.yaxis, bounds.intervaly, bounds.minposy), _axis(ax.xaxis, bounds.intervalx, bounds.minposx)
    )
    named = ": ".join(filter(None, [ax.get_title(), axes]))
    names = [text.get_text() for text in ax.texts if text.get_gid() == "name"]
    return ", ".join(
        filter(None, [named, f"showing {', '.join(names)}" if names else _entries(ax.get_legend())])
    )


def _axis(axis, interval, least_positive):
    """The label with the range of its data, or the names along an axis that has no label."""
    if not axis.get_label_text():
        names = axis.get_ticklabels() if isinstance(axis.get_major_locator(), FixedLocator) else []
        return ", ".join(name.get_text().replace("\n", " ") for name in names)
    logarithmic = axis.get_scale() == "log"
    low, high = max(interval[0], least_positive) if logarithmic else interval[0], interval[1]
    least, most = (f"{value + 0.0:.3g}" for value in (low, high))
    span = f" from {least} to {most}" if low < high else f" at {least}" if low == high else ""
    return axis.get_label_text() + span + (" (logarithmic)" if logarithmic else "")


def _over(upright, along):
    return " over ".join(filter(None, [upright, along]))


def _entries(legend):
    if not legend:
        return ""
    return (
        f"{legend.get_title().get_text() or 'showing'} {', '.join(text.get_text() for text in legend.texts)}"
    )
