"""How nbval runs and compares the notebooks, whoever starts pytest."""

import os

# Pictures that can be stored, no live viewers, no progress bars: the kernels inherit it.
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
os.environ.setdefault("PYVISTA_JUPYTER_BACKEND", "static")
os.environ.setdefault("NURBS_LAB_PROGRESS", "0")


def pytest_collectstart(collector):
    """Do not compare stderr, where VTK reports a missing display, and stored scenes, which are pictures."""
    if hasattr(collector, "skip_compare"):
        collector.skip_compare += ("stderr", "application/x-nurbs-lab-scene.2+json")
