"""Compile every kernel once, so that nobody waits for the compiler later: ``python -m nurbs_lab.warm``."""

import numpy as np
import trimesh

import nurbs_lab as nl


def warm() -> None:
    """Call each kernel on a tiny input of the types that the faces pass."""
    curve = nl.paper.CURVE
    curve(np.linspace(0.0, 1.0, 3))
    box = trimesh.creation.box()
    for axis in "xyz":
        nl.slice_mesh(box, [0.0], axis=axis)
    nl.reconstruct(box, layers=4, tolerance=0.1, adaptive=False)
    limits = {"speed": 4.0, "acceleration": 40.0, "chord_error": 1e-3, "axis_acceleration": 40.0}
    feed = nl.plan_feed(curve, period_s=1e-2, **limits)
    for name in nl.STEPPERS:
        if name != "rtl":  # has no kernel, and Icarus Verilog may come later
            nl.trace(curve, feed, stepper=name)


if __name__ == "__main__":
    warm()
