"""Pictures of any data: lines over an axis, and a picture with sliders."""

import io

import ipywidgets
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from nurbs_lab.plotting.animations import animation
from nurbs_lab.plotting.picture import bundle, png_of, stored_png, words
from nurbs_lab.plotting.stage import FONT, INK, live, png
from nurbs_lab.plotting.status import Status
from nurbs_lab.plotting.style import canvas, name_lines, plain_log_ticks, takes_axes

FRAMES, FRAME_S = 8, 0.8  # of a stored explorer


@takes_axes
def lines(x, series, *, x_label, y_label, log="", markers=False, title=None, ax=None):
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
    title : str, optional
    """
    named = dict(series) if hasattr(series, "items") else {None: series}
    with canvas(7, 3.8, ax) as (figure, ax):
        for (name, values), marker in zip(named.items(), "osD^vPX*" * 9, strict=False):
            ax.plot(x, values, marker=marker if markers else None, label=name)
        ax.set(xlabel=x_label, ylabel=y_label, title=title)
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
            name_lines(ax)
    return figure


class Explorer(ipywidgets.VBox):
    """What `explore` gives."""

    def __init__(self, draw, **controls):
        self.draw = draw
        self.controls = {name: _control(name, value) for name, value in controls.items()}
        self.picture = ipywidgets.Image(format="png", layout={"align_self": "flex-start"})
        self.status = Status()
        super().__init__([*self.controls.values(), self.picture, self.status])
        for control in self.controls.values():
            control.observe(lambda _: self.status.run(self.redraw), names="value")
        self.redraw()

    def redraw(self):
        """Draw with the values that the controls have now."""
        drawn = self.draw(**{name: control.value for name, control in self.controls.items()})
        self.picture.value = png_of(drawn, tight=False) if isinstance(drawn, Figure) else png(drawn)
        self.words = words(drawn) if isinstance(drawn, Figure) else "a view in space"

    def _repr_mimebundle_(self, **options):
        name, control = next(iter(self.controls.items()), (None, None))
        chosen = ", ".join(f"{name} = {control.value}" for name, control in self.controls.items())
        if name is None or live():
            still = stored_png(Image.open(io.BytesIO(self.picture.value)).convert("RGB"))
        else:
            moving = animation(self._frame, _positions(control), alt=chosen, frame_s=FRAME_S, colours=32)
            still = moving.data
        data, told = bundle(still, f"Explorer: {chosen}", f"{chosen}: {self.words}")
        return super()._repr_mimebundle_(**options) | data, told

    def _frame(self, value):
        """The picture at one position of the first control, with the position written into it."""
        values = {name: control.value for name, control in self.controls.items()}
        name = next(iter(values))
        drawn, said = self.draw(**values | {name: value}), f"{name.replace('_', ' ')} = {_shown(value)}"
        if isinstance(drawn, Figure):
            drawn.suptitle(said, x=0.01, ha="left", fontsize=10)
        else:
            drawn.add_text(said, position="lower_left", font_size=9, color=INK, font_file=FONT)
        return drawn


def _positions(control):
    """Some values that a control can take, from its first to its last."""
    if hasattr(control, "options"):
        values = [value for _, value in control._options_full]
    else:
        count = int((control.max - control.min) / control.step + 1e-9)
        ends = control.min, control.min + count * control.step
        values = np.linspace(*ends, count + 1, dtype=type(control.value)).round(12).tolist()
    chosen = np.linspace(0, len(values) - 1, min(len(values), FRAMES)).round().astype(int)
    return [values[k] for k in chosen]


def _shown(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def explore(draw, **controls):
    """A picture with sliders: ``explore(lambda degree: ..., degree=(1, 5))``.

    The picture follows a slider while it moves; positions that it passes while a picture is being drawn are
    left out. If drawing fails or is interrupted, a line below the picture says so. Where no kernel runs (on a
    web page, in a stored notebook) a picture moves through eight positions of the first control.

    Parameters
    ----------
    draw : callable
        Takes the controls' values by name, returns a Figure or a scene.
    **controls : (first, last), (first, last, step), or list of choices
        Whole numbers make an integer slider.

    Returns
    -------
    Explorer
        To be the last line of a cell.
    """
    return Explorer(draw, **controls)


def _control(name, value):
    look = {"description": name.replace("_", " "), "layout": {"width": "32em"}}
    look["style"] = {"description_width": "initial"}
    if isinstance(value, tuple):
        first, last, *step = value
        if all(isinstance(v, (int, np.integer)) for v in value):
            kind, step, middle = ipywidgets.IntSlider, step or [1], (first + last) // 2
        else:
            kind, step, middle = ipywidgets.FloatSlider, step or [(last - first) / 100], (first + last) / 2
        return kind(value=middle, min=first, max=last, step=step[0], **look)
    # A menu would do, but JupyterLab takes the arrow keys away from it.
    return ipywidgets.SelectionSlider(options=list(value), **look)
