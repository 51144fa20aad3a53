"""Pictures with sliders, and the line of text below controls that tells of errors."""

import html
import re
import signal
import threading
import warnings

import ipywidgets
import numpy as np
from IPython import get_ipython
from matplotlib.figure import Figure

from nurbs_lab.common.checks import as_sequence, shown
from nurbs_lab.plotting.general import animation
from nurbs_lab.plotting.picture import bundle, opened, png_of, stored_png, words
from nurbs_lab.plotting.stage import FONT, INK, live, png

FRAMES, FRAME_S = 8, 1.5  # of a stored explorer


class Status(ipywidgets.HTML):
    """A line of text below controls, with the errors and warnings of their work, which no cell can show."""

    def __init__(self):
        super().__init__()
        self._waiting = []

    def run(self, work):
        """Do what a control asks for, so that an interrupt of the kernel stops it.

        What ``work`` returns is the new text. JupyterLab lets a kernel answer widgets in a thread of
        their own, which no interrupt reaches. The work is then handed to the main thread. The same work is
        not handed over twice while it waits there, so that of many quick moves the last one counts.
        """
        kernel = getattr(get_ipython(), "kernel", None)
        if kernel is None or threading.current_thread() is threading.main_thread():
            self._run(work)
        elif work not in self._waiting:
            self._waiting.append(work)
            kernel.io_loop.add_callback(self._run_later, work)

    def _run_later(self, work):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored between two cells
        try:
            self._waiting.remove(work)
            self._run(work)
        finally:
            signal.signal(signal.SIGINT, before)

    def _run(self, work):
        """Errors, interrupts and warnings become the text; what was shown before an error stays."""
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", UserWarning)
            try:
                said = work() or ""
            except (Exception, KeyboardInterrupt) as problem:
                stopped = isinstance(problem, KeyboardInterrupt)
                said = "stopped" if stopped else html.escape(str(problem) or type(problem).__name__)
                said = f"<b>{said}; what is shown is the last result</b>"
        lines = dict.fromkeys([said, *(html.escape(str(one.message)) for one in warned)])
        self.value = "<br>".join(filter(None, lines))


class Explorer(ipywidgets.VBox):
    """A picture with sliders, the last line of a cell: ``explore(lambda degree: ..., degree=(1, 5))``.

    The picture follows a slider while it moves; positions that it passes while a picture is being drawn are
    left out. If drawing fails or is interrupted, a line below the picture says so. Where no kernel runs (on a
    web page, in a stored notebook) a picture moves through eight positions of the first control.

    Parameters
    ----------
    draw : callable
        Takes the controls' values by name, returns a Figure or a scene.
    **controls : (first, last), (first, last, step), or list of choices
        Whole numbers make an integer slider.
    """

    def __init__(self, draw, **controls):
        self.draw = draw
        self.controls = {name: _control(name, value) for name, value in controls.items()}
        self.picture = ipywidgets.Image(format="png", layout={"align_self": "flex-start"})
        self.status = Status()
        super().__init__([*self.controls.values(), self.picture, self.status])
        for control in self.controls.values():
            control.observe(lambda _: self.status.run(self.redraw), names="value")
        self.redraw()

    def values(self):
        """What the controls are set to, by their names."""
        return {name: control.value for name, control in self.controls.items()}

    def redraw(self):
        """Draw with the values that the controls have now."""
        drawn = self.draw(**self.values())
        self.picture.value = png_of(drawn, tight=False) if isinstance(drawn, Figure) else png(drawn)
        self.words = words(drawn) if isinstance(drawn, Figure) else "a view in space"

    def _repr_mimebundle_(self, **options):
        name, control = next(iter(self.controls.items()), (None, None))
        said = ", ".join(f"{name} = {value}" for name, value in self.values().items())
        if name is None or live():
            still = stored_png(opened(self.picture.value))
        else:
            places = _positions(control)
            said = f"{name} from {_shown(places[0])} to {_shown(places[-1])}"
            still = animation(self._frame, places, alt=said, frame_s=FRAME_S).data
        data, told = bundle(still, f"Explorer: {said}", f"{said}: {self.words}")
        return super()._repr_mimebundle_(**options) | data, told

    def _frame(self, value):
        """The picture at one position of the first control, with the position written into it."""
        name = next(iter(self.controls))
        drawn = self.draw(**self.values() | {name: value})
        said = f"{label(name)} = {_shown(value)}"
        if isinstance(drawn, Figure):
            self.words = words(drawn)
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


def label(name):
    """The words of a name, and in brackets the unit in which it may end."""
    words = re.sub(" (mm s|mm|um|ms)$", r" [\1]", name.replace("_", " "))
    return words.replace("[um", "[µm").replace("[mm s", "[mm/s")


def _shown(value):
    return f"{value:.4g}".replace("-", "−") if isinstance(value, float) else str(value)


def _control(name, value):
    look = {"description": label(name), "layout": {"width": "32em"}}
    look["style"] = {"description_width": "initial"}
    if not isinstance(value, tuple) and as_sequence(name, value):
        # A menu would do, but JupyterLab takes the arrow keys away from it.
        return ipywidgets.SelectionSlider(options=list(value), **look)
    rising = len(value) in (2, 3) and all(isinstance(v, (int, float, np.number)) for v in value)
    if not (rising and -np.inf < value[0] <= value[1] < np.inf and min(value[2:], default=1) > 0):
        said = "(first, last) or (first, last, step), rising, or a list"
        raise ValueError(f"{name} must be {said}; got {shown(value)}")
    first, last, *step = value
    whole = all(isinstance(v, (int, np.integer)) for v in value)
    step = step[0] if step else 1 if whole else (last - first) / 100 or 1.0
    middle = np.round(first + (last - first) / step // 2 * step, 12)  # where the slider can stand
    kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
    return kind(value=middle, min=first, max=last, step=step, **look)


explore = Explorer
