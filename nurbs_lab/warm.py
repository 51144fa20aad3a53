"""Compile every kernel once, so that nobody waits for the compiler later: ``python -m nurbs_lab.warm``."""

import numpy as np

import nurbs_lab as nl


def warm() -> None:
    """Call each kernel on a tiny input of the types that the faces pass."""
    curve = nl.paper.CURVE
    curve(np.linspace(0.0, 1.0, 3))


if __name__ == "__main__":
    warm()
