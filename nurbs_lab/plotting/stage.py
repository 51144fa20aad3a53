"""Pictures in space: one light, one camera, live in JupyterLab and stored as a picture elsewhere."""

import os
import re
import sys
from contextlib import contextmanager
from functools import wraps
from inspect import cleandoc

import numpy as np
import pyvista as pv
from matplotlib.figure import Figure
from PIL import Image

from nurbs_lab.common.checks import as_kind
from nurbs_lab.plotting.orbit import MIME, packed
from nurbs_lab.plotting.picture import FONT, Stored, stored_png

CLAY = "#D5DEEA"
INK = "#202020"
TITLE_AT = (60, 32)  # pixels from the left and the top of a view; beside the button of the live viewer
FILL = 1.04  # height of a view over the height of its contents
FILL_TITLED = 1.2  # the same with room for a title


def scene(*, columns=1, width=760, height=560):
    """An empty scene with lights and a white background.

    Parameters
    ----------
    columns : int
        Views side by side.
    width, height : int
        Of the whole picture, in pixels.

    Returns
    -------
    pyvista.Plotter
    """
    with pv.vtk_verbosity("error"):  # VTK warns where there is no X server before it renders without one
        stage = pv.Plotter(
            shape=(1, columns), window_size=(width, height), border=False, off_screen=not live()
        )
    for column in range(columns):
        stage.subplot(0, column)
        stage.set_background("white")
        stage.enable_anti_aliasing("ssaa")
    stage.subplot(0, 0)
    return stage


_STAGE = """
stage : pyvista.Plotter, optional
    Draw into this scene instead of a new one.
title : str, optional

Returns
-------
pyvista.Plotter
"""


def takes_stage(function):
    """Decorate a function that draws into a scene, a new one if none is given; its docstring says so."""

    @wraps(function)
    def draw(*args, stage=None, **options):
        return function(*args, stage=scene() if stage is None else stage, **options)

    draw.__doc__ = cleandoc(function.__doc__) + _STAGE
    return draw


def frame(stage, *, title=None, direction=(1.0, -1.6, 0.7), left=0.0, right=0.0):
    """Turn the camera of the current view so that its contents fill it, and add the title.

    ``left`` and ``right`` are the shares of its width that are kept free at either side.
    """
    if title:
        corner = TITLE_AT[0] * stage.shape[1] / stage.window_size[0], 1 - TITLE_AT[1] / stage.window_size[1]
        stage.add_text(title, position=corner, viewport=True, font_size=11, color=INK, font_file=FONT)
    camera = stage.camera
    stage.view_vector(direction, viewup=(0, 0, 1))
    stage.enable_parallel_projection()
    towards = np.array(direction)
    across = np.cross((0, 0, 1), towards)
    axes = [v / np.linalg.norm(v) for v in (across, np.cross(towards, across))]
    shown = [one for one in stage.renderer.actors.values() if isinstance(one, pv.Actor)]
    places = np.concatenate([one.mapper.dataset.points @ np.transpose(axes) for one in shown] or [np.eye(2)])
    low, high = places.min(axis=0), places.max(axis=0)
    aspect = stage.window_size[0] / stage.shape[1] / stage.window_size[1]
    wide, tall = high - low
    height = (FILL_TITLED if title else FILL) * max(tall, wide / aspect / (1.0 - left - right))
    middle = (low + high) / 2 + ((right - left) / 2 * height * aspect, 0.0)
    shift = np.subtract(middle, np.dot(axes, camera.focal_point)) @ axes
    camera.position, camera.focal_point = camera.position + shift, camera.focal_point + shift
    camera.parallel_scale = 0.5 * height
    return stage


def show(picture, *, alt=""):
    """Show a scene, or a figure with an alternative text of your own, as the value of a cell.

    In a live JupyterLab a scene turns under the mouse. Where PYVISTA_JUPYTER_BACKEND is ``static``, as when
    the notebooks are built and tested, and outside notebooks, it is a PNG that needs no display.

    Parameters
    ----------
    picture : pyvista.Plotter or matplotlib Figure
        A scene is shown once: it is closed afterwards.
    alt : str
        Alternative text, for readers who cannot see the picture. A figure without one is described by its
        titles, labels and legends.

    Returns
    -------
    Stored, the live viewer, or the Figure
    """
    if isinstance(picture, Figure):
        picture.set_label(alt)
        return picture
    if live():
        return _viewer(picture)
    look, turned = {"width": picture.window_size[0]}, packed(picture)
    return Stored(png(picture), alt, "scene", look, {MIME: turned} if turned else {})


def _viewer(stage):
    """The scene, turned by the mouse and drawn by the kernel.

    PyVista's own choice also sends the geometry, which fails with a message if the
    browser asks for it late, and its WebAssembly part would fetch a program from the network.
    """
    backend = os.environ.get("PYVISTA_JUPYTER_BACKEND", "server")
    with _without_module("trame.widgets.vtklocal"):
        look = {"collapse_menu": True, "width": f"min({stage.window_size[0]}px, 100%)"}  # pages may be narrow
        viewer = stage.show(jupyter_backend=backend, jupyter_kwargs=look, return_viewer=True)
    # Told the socket, the page does not first ask for a launcher that is not there (405 in the console).
    if isinstance(page := getattr(viewer, "value", None), str):
        viewer.value = re.sub(r'src="http(://[^/"]+)/index\.html\?', r"\g<0>sessionURL=ws\1/ws&", page)
    return viewer


@contextmanager
def _without_module(name):
    """Let an import of a module fail for a while, unless it has been imported already."""
    blocked = sys.modules.setdefault(name, None) is None
    try:
        yield
    finally:
        if blocked:
            del sys.modules[name]


def png(stage):
    """The picture of a scene as the bytes of a PNG file; the scene is closed."""
    return stored_png(image(stage))


def image(stage):
    """The picture of a scene as a Pillow image in full colour; the scene is closed."""
    as_kind("what is drawn, if no Figure,", stage, pv.Plotter)
    stage.off_screen = True  # in a live JupyterLab it was made to be shown
    stage.render_window.SetOffScreenRendering(True)
    picture = Image.fromarray(stage.screenshot(return_img=True))
    stage.close()
    return picture


def live():
    """Whether a notebook runs that does not ask for stored pictures."""
    if os.environ.get("PYVISTA_JUPYTER_BACKEND") == "static":
        return False
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell is not None and hasattr(shell, "kernel")


def lay(stage, pieces, **options):
    """Draw polylines that lie on bodies."""
    lift(stage.add_mesh(polylines(pieces), **options))


def lift(lines):
    """Move lines a little towards the eye, so that the body on which they lie does not break them."""
    lines.mapper.SetResolveCoincidentTopologyToPolygonOffset()
    lines.mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-2.0, -8.0)


def name_points(stage, points, names, color):
    """Write a name beside each point, in front of everything."""
    stage.add_point_labels(
        points, names, text_color=color, font_size=18, font_file=FONT, shape=None, show_points=False,
        always_visible=True,
    )  # fmt: skip


def polylines(pieces):
    """One PyVista object of many polylines, each ``(n, 3)``."""
    counts = [len(piece) for piece in pieces]
    first = np.cumsum([0, *counts[:-1]])
    cells = [np.r_[n, a : a + n] for n, a in zip(counts, first, strict=True)]
    return pv.PolyData(np.concatenate(pieces), lines=np.concatenate(cells))
