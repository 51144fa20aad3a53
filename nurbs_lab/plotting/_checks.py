"""Checks of the arguments of pictures, in addition to those of `nurbs_lab.common.checks`."""

from collections.abc import Mapping

import pyvista

from nurbs_lab.common.checks import as_reals, shown

MOST_SAMPLES = 100_000  # of a curve
MOST_PIXELS = 10_000


def as_text(name, value):
    """A string that can be drawn, or None."""
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} must be a text, got {shown(value)}")
    try:
        (value or "").encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name} is no text that a picture can show: {shown(value)}") from None
    return value


def as_colour(name, value):
    """A colour of PyVista's, from its name, its hexadecimal text or three numbers."""
    try:
        return pyvista.Color(value)
    except Exception:  # PyVista raises errors of many kinds
        raise ValueError(f"{name} must be a colour such as 'red' or '#D5DEEA', got {shown(value)}") from None


def as_named(name, value):
    """A mapping from names as a dict; an empty one is refused."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} must be a mapping from names, got {shown(value)}")
    if not value:
        raise ValueError(f"{name} is empty; there is nothing to draw")
    return dict(value)


def as_line(name, value, count, others):
    """Numbers ``(count,)`` to be drawn, one for each of ``others``; NaN and infinity are gaps."""
    line = as_reals(name, value)
    if line.shape != (count,):
        raise ValueError(f"{name} must have shape ({count},) like {others}, got {line.shape}")
    return line


def as_list(name, value, kind):
    """A list of instances of ``kind``; an empty one is refused."""
    if not isinstance(value, (list, tuple)) or not all(isinstance(one, kind) for one in value):
        raise TypeError(f"{name} must be a list of {kind.__name__}, got {shown(value)}")
    if not value:
        raise ValueError(f"{name} is empty; there is nothing to draw")
    return list(value)


def as_axes(axes, dim):
    """Indices of two coordinates from their names, such as 'xz'."""
    known = "xyz"[:dim]
    if not isinstance(axes, str) or len(axes) != 2 or not set(axes) <= set(known):
        raise ValueError(f"axes must be two of {', '.join(known)}, such as 'xy'; got {shown(axes)}")
    return [known.index(axis) for axis in axes]
