"""Checks of the arguments of pictures, in addition to those of `nurbs_lab.common.checks`."""

import pyvista

from nurbs_lab.common.checks import as_reals, shown


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
