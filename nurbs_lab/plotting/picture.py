"""Figures of matplotlib as PNG files, with an alternative text for readers who cannot see them."""

import base64
import io

from matplotlib.figure import Figure
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
    """Alternative text of a figure: its label if it has one, otherwise the labels of its axes and legends."""
    if figure.get_label():
        return figure.get_label()
    return "; ".join(filter(None, map(_panel, figure.axes)))


def _panel(ax):
    """'title: y label over x label, showing the names of the lines'."""
    axes = " over ".join(filter(None, [ax.get_ylabel(), ax.get_xlabel()]))
    legend = ax.get_legend()
    texts = legend.texts if legend else [text for text in ax.texts if text.get_gid() == "name"]
    names = [text.get_text() for text in texts]
    named = ": ".join(filter(None, [ax.get_title(), axes]))
    return named + (f", showing {', '.join(names)}" if named and names else "")
