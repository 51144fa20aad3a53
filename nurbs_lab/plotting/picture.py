"""PNG files that a notebook stores, with an alternative text for readers who cannot see them."""

import base64
import io
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib import get_data_path
from matplotlib.figure import Figure
from PIL import Image, ImageDraw, ImageFont

FONT = str(Path(get_data_path(), "fonts/ttf/DejaVuSans.ttf"))  # that of plane pictures, for all others
HEAD = 30  # pixels of a name over a picture


class Picture(Figure):
    """A figure that a notebook stores together with its alternative text."""

    def _ipython_display_(self):
        from IPython.display import display

        data, told = bundle(stored_png(opened(png_of(self))), repr(self), words(self))
        display(data, raw=True, metadata=told)

    def stored(self):
        """The picture of this moment, which can take the place of an earlier one."""
        return Stored(stored_png(opened(png_of(self))), words(self), "picture")


@dataclass(frozen=True, repr=False)
class Stored:
    """A PNG file with its alternative text; ``kind`` stands before it where only text can be shown."""

    data: bytes
    alt: str
    kind: str
    look: dict = field(default_factory=dict)  # its width
    more: dict = field(default_factory=dict)  # by type of data: a scene that a page can turn

    def __repr__(self):
        return f"<{self.kind}: {self.alt}>"

    def _repr_mimebundle_(self, **options):
        data, told = bundle(self.data, repr(self), self.alt, **self.look)
        return data | self.more, told


def bundle(png, text, alt, **look):
    """What a notebook stores of a PNG file, and its metadata."""
    data = {"image/png": base64.b64encode(png).decode(), "text/plain": text}
    return data, {"image/png": {"alt": alt, **look}}


def png_of(figure, *, tight=True):
    """A figure as the bytes of a PNG file, cut to its content unless the size has to stay the same."""
    data = io.BytesIO()
    figure.savefig(data, format="png", bbox_inches="tight" if tight else None)
    return data.getvalue()


def opened(file):
    """The bytes of a PNG file as a Pillow image."""
    return Image.open(io.BytesIO(file)).convert("RGB")


def sheet(files, width=700, columns=1):
    """Several PNG files by name as the bytes of one; each goes under its name into the shortest column."""
    placed, tops = [], [0] * columns
    for name, file in files.items():
        one, column = opened(file), tops.index(min(tops))
        one = one.resize((width, one.height * width // one.width))
        placed.append((name, one, column * width, tops[column]))
        tops[column] += HEAD + one.height
    whole = Image.new("RGB", (columns * width, max(tops)), "white")
    pen = ImageDraw.Draw(whole)
    for name, one, left, top in placed:
        pen.text((left + HEAD, top + HEAD // 3), name, fill="black", font=ImageFont.truetype(FONT, HEAD // 2))
        whole.paste(one, (left, top + HEAD))
    return stored_png(whole)


def stored_png(image):
    """A Pillow image as a PNG file of 256 colours, a third as large; rare ones, such as red spots, stay."""
    data = io.BytesIO()
    image.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2).save(data, "png", optimize=True)
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
    names = [text.get_text() for text in legend.texts] if legend else []
    named = ": ".join(filter(None, [ax.get_title(), axes]))
    return named + (f", showing {', '.join(names)}" if named and names else "")
