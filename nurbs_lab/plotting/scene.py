"""Pictures in space: one light, one camera, live in JupyterLab and stored as a picture elsewhere."""

import io
import os
import sys

import pyvista as pv


def _static():
    """Whether pictures shall be stored: so asked, or no live notebook to turn them in."""
    return os.environ.get("PYVISTA_JUPYTER_BACKEND") == "static" or not _in_notebook()


def _in_notebook():
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell is not None and shell.has_trait("kernel")


BACKGROUND = "white"
INK = "#222222"
CLAY = "#B8C4D6"


def scene(*, columns=1, width=800, height=600):
    """An empty, well lit stage.

    Parameters
    ----------
    columns : int
        Views side by side.
    width, height : int
        Of the whole picture, in pixels.

    Returns
    -------
    pyvista.Plotter
        Draw with `add_*`, then hand it to `show`.
    """
    stage = pv.Plotter(shape=(1, columns), window_size=(width, height), border=False, off_screen=_static())
    stage.set_background(BACKGROUND)
    for column in range(columns):
        stage.subplot(0, column)
        stage.enable_anti_aliasing("ssaa")
    return stage


def show(stage, *, alt=""):
    """The picture of a scene, as the value of a cell.

    In a live JupyterLab it turns under the mouse. Where PYVISTA_JUPYTER_BACKEND is ``static``, as when the
    notebooks are built and tested, and outside notebooks, it is a PNG that needs no display.

    Parameters
    ----------
    stage : pyvista.Plotter
    alt : str
        The picture in words, for those who cannot see it.

    Returns
    -------
    IPython.display.Image or the live viewer
    """
    if not _static():
        return stage.show(return_viewer=True)
    from IPython.display import Image

    return Image(data=png(stage), format="png", alt=alt, width=stage.window_size[0])


def png(stage):
    """The picture of a scene as the bytes of a PNG file; the scene is closed."""
    from PIL import Image

    pixels = stage.screenshot(return_img=True)
    stage.close()
    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "png", optimize=True)
    return data.getvalue()
