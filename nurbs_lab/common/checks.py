"""Checks of arguments; every message names the argument, its value and the cure."""

import operator
import os
from contextlib import contextmanager
from functools import reduce
from pathlib import Path

import numpy as np

LARGEST = 1e100  # beyond it squares overflow and results would turn into NaN
HIGHEST_ORDER = 100  # of derivatives
USUAL_ORDER = 3  # up to which derivatives of what is accepted stay below 1e308
MOST = 1_000_000  # of counts that have no bound of their own
MOST_WEIGHT = 1e9  # of the smallest weight; beyond it, lengths and closest points lose digits
SMALLEST_SPAN = 1e-15  # of the domain; knots closer than this are one knot in float64


def as_floats(name, value, shape=None):
    """A finite, writable, contiguous float64 array; ``shape`` names its axes, e.g. ``("n", "dim")``."""
    array = as_reals(name, value, shape)
    require_finite(name, array)
    return array


def as_reals(name, value, shape=None):
    """Like `as_floats`, but NaN and infinity are allowed."""
    if np.ma.is_masked(value):
        raise ValueError(f"{name} has masked entries; fill them or leave them out")
    try:
        array = np.asarray(value)
        if array.dtype == object:
            if None in array.ravel().tolist():
                raise TypeError  # which NumPy would read as NaN
            array = array.astype(np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        if isinstance(error, ValueError) and isinstance(value, (list, tuple, np.ndarray)):
            said = "must be a regular array of numbers; its rows differ in length"
            raise ValueError(f"{name} {said}") from None
        raise TypeError(f"{name} must hold real numbers, got {shown(value)}") from None
    if array.dtype.kind not in "iuf":
        got = shown(value) if array.dtype.kind == "U" else array.dtype
        raise TypeError(f"{name} must hold real numbers, got {got}")
    if shape is not None and array.ndim != len(shape):
        raise ValueError(f"{name} must have shape ({', '.join(shape)}), got {array.shape}")
    return array.astype(np.float64, order="C")


def shown(value):
    """Text of a wrong value for an error message: its repr if that is short, else its type."""
    text, kind = repr(value), type(value).__name__
    return text if len(text) <= 80 else f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def shown_place(point):
    """Text of a point in space: (1.5, 0, -2) mm."""
    return f"({', '.join(f'{x:.4g}' for x in point)}) mm"


def require_representable(name, order, derivatives):
    """ValueError if derivatives of a high order are larger than double precision holds."""
    if order > USUAL_ORDER and not np.isfinite(derivatives).all():
        raise ValueError(
            f"{name} = {order}: the derivatives are beyond double precision; ask for a lower order, "
            "or scale the knots up"
        )


def require_finite(name, array):
    """Refuse NaN, infinity and magnitudes whose squares overflow."""
    if array.size and not (array.max() <= LARGEST and array.min() >= -LARGEST):
        where = np.argwhere(~(np.abs(array) <= LARGEST))[0].tolist()
        raise ValueError(
            f"{name}{where or ''} is {array[tuple(where)]}; "
            f"every value must be finite and at most {LARGEST:g}"
        )


def as_points(name, value, least=1):
    """Points ``(n, dim)`` with at least ``least`` rows and one column."""
    points = as_floats(name, value, ("n", "dim"))
    if len(points) < least or points.shape[1] < 1:
        raise ValueError(
            f"{name} must hold at least {least} points of one coordinate or more, got {points.shape}"
        )
    return points


def as_vector(name, value, *sizes):
    """A vector with one of these numbers of coordinates."""
    vector = as_floats(name, value, ("dim",))
    if vector.size not in sizes:
        raise ValueError(f"{name} must have {' or '.join(map(str, sizes))} coordinates, got {vector.size}")
    return vector


def as_direction(name, value):
    """A unit vector in 3-D."""
    vector = as_vector(name, value, 3)
    size = np.linalg.norm(vector)
    if not size > 0:
        raise ValueError(f"{name} must not be zero, got {vector}")
    return vector / size


def as_integer(name, value):
    """An integer of any size; floats and booleans are refused."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, got {shown(value)}") from None


def as_count(name, value, least=1, most=MOST):
    """An integer in ``least .. most``."""
    count = as_integer(name, value)
    if not least <= count <= most:
        bound = f"at least {least}" if count < least and most == MOST else f"{least} to {most}"
        raise ValueError(f"{name} must be {bound}, got {shown(value)}")
    return count


def as_sequence(name, value):
    """The entries of a sequence, or of any other iterable, as a list."""
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"{name} must be a sequence, got {shown(value)}") from None


@contextmanager
def said_of(name):
    """Name an argument in errors about an object that was made from it: ``with said_of("part"): ...``."""
    try:
        yield
    except (ValueError, TypeError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"{name}: {error}") from None


def counted(number, noun, plural=None):
    """A number with its noun, as in 1 hole or 2 holes."""
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


def as_pair(name, value, check=None, *bounds):
    """The two values of a pair, one for each direction, each passed through a check of this module."""
    try:
        first, second = value
    except (ValueError, TypeError) as error:
        raise type(error)(f"{name} must be a pair, one entry per direction, got {shown(value)}") from None
    if check is None:
        return first, second
    return check(f"{name}[0]", first, *bounds), check(f"{name}[1]", second, *bounds)


def as_number(name, value):
    """A single finite float."""
    if type(value) is float and abs(value) < LARGEST:  # as below, twenty times faster
        return value
    array = as_floats(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)


def as_positive(name, value):
    """A single finite float above zero."""
    number = as_number(name, value)
    if number <= 0:
        raise ValueError(f"{name} must be positive, got {number}")
    return number


def as_not_negative(name, value):
    """A single finite float, zero or more."""
    number = as_number(name, value)
    if number < 0:
        raise ValueError(f"{name} must not be negative, got {number}")
    return number


def as_parameters(name, value, domain):
    """Parameters of any shape inside the domain; values beyond it by rounding only are clipped to it."""
    u = as_floats(name, value)
    low, high = domain
    slack = 4 * np.finfo(float).eps * max(abs(low), abs(high))
    if u.size and (u.min() < low - slack or u.max() > high + slack):
        wrong = u[(u < low - slack) | (u > high + slack)][0]
        raise ValueError(f"{name} = {wrong} is outside the domain [{low}, {high}]")
    return np.clip(u, low, high)


def wrapped(name, value, domain, closed):
    """`as_parameters`, but where ``closed()`` is true those outside the domain go round."""
    u = as_reals(name, value)
    low, high = domain
    if not u.size or (u.min() >= low and u.max() <= high):
        return u
    require_finite(name, u)
    if not closed():
        return as_parameters(name, u, domain)
    return np.clip(np.where((u < low) | (u > high), low + (u - low) % (high - low), u), low, high)


def as_knots(name, value, degree, count):
    """A knot vector for ``count`` control points of ``degree``: ``(count + degree + 1,)``."""
    knots = as_floats(name, value, ("n + degree + 1",))
    if knots.size != count + degree + 1:
        raise ValueError(
            f"{name} must have {count + degree + 1} entries "
            f"({count} control points + degree {degree} + 1), got {knots.size}"
        )
    steps = knots[1:] - knots[:-1]
    low, high = knots[degree], knots[count]
    clamped = knots[0] == low and knots[-1] == high
    if (steps[degree:-degree] if clamped else steps).min() >= SMALLEST_SPAN * (high - low) > 0 <= steps.min():
        return knots  # those that differ do so by more than rounding: none of the faults below can be there
    if (steps < 0).any():
        i = int(np.argmax(steps < 0))
        raise ValueError(
            f"{name} must not decrease, but {name}[{i + 1}] = {knots[i + 1]} < {name}[{i}] = {knots[i]}"
        )
    if not high > low:
        raise ValueError(f"{name} leaves an empty domain: {name}[{degree}] = {name}[{count}] = {low}")
    tiny = (steps > 0) & (steps < SMALLEST_SPAN * (high - low))
    if tiny.any():
        i = int(np.argmax(tiny))
        raise ValueError(
            f"{name}[{i}] and {name}[{i + 1}] differ by rounding only ({steps[i]:g}); make them equal"
        )
    inner = knots[(knots > low) & (knots < high)]
    for run, most in ((inner, degree), (knots, degree + 1)):
        crowded = run[most:] == run[:-most]
        if crowded.any():
            value = run[np.argmax(crowded)]
            times = np.count_nonzero(knots == value)
            raise ValueError(f"{name} holds {value} {times} times; degree {degree} allows {most} there")
    return knots


def as_weights(name, value, shape):
    """Positive weights of the control points' shape; all one if none are given."""
    if value is None:
        return np.ones(shape)
    weights = as_floats(name, value, ("n",) if len(shape) == 1 else ("nu", "nv"))
    if weights.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, one per control point, got {weights.shape}")
    if not weights.min() >= 1 / LARGEST:
        where = tuple(int(i) for i in np.argwhere(~(weights >= 1 / LARGEST))[0])
        raise ValueError(f"{name}{list(where)} is {weights[where]}; weights must be positive")
    if weights.max() > MOST_WEIGHT * weights.min():
        raise ValueError(
            f"{name} may differ by a factor of at most {MOST_WEIGHT:g}, "
            f"but these go from {weights.min()} to {weights.max()}"
        )
    return weights


def freeze(array):
    """A C-contiguous read-only float64 array."""
    array = np.ascontiguousarray(array, dtype=np.float64)
    array.setflags(write=False)
    return array


def as_flag(name, value):
    """A Python bool; anything else is refused."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be True or False, got {shown(value)}")
    return bool(value)


def as_increasing(name, value, count, others):
    """``count`` parameters, each larger than the one before; ``others`` names the data they belong to."""
    t = as_floats(name, value, (str(count),))
    if t.size != count:
        raise ValueError(f"{name} must have {count} entries for these {others}, got {t.size}")
    gaps = np.diff(t)
    if not gaps.min() > 1e-14 * (t[-1] - t[0]):
        i = int(np.argmin(gaps))
        raise ValueError(f"{name} must increase, but {name}[{i}] = {t[i]} and {name}[{i + 1}] = {t[i + 1]}")
    return t


def as_kind(name, value, kind):
    """The value unchanged, if it is an instance of ``kind``."""
    if not isinstance(value, kind):
        raise TypeError(f"{name} must be a {kind.__name__}, got {type(value).__name__}")
    return value


def as_choice(name, value, choices):
    """The value unchanged, if it is one of the strings ``choices``."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(choices)}; got {shown(value)}")
    return value


def as_path(name, value):
    """A file name as a `Path`; the file itself need not exist."""
    if not isinstance(value, (str, os.PathLike)) or not os.fspath(value):
        raise TypeError(f"{name} must be a file name, a str or a Path, got {shown(value)}")
    return Path(value)


def as_file(name, value):
    """The `Path` of a file that exists and may be read."""
    path = as_path(name, value)
    if path.is_dir():
        raise IsADirectoryError(f"{name}: {str(path)!r} is a folder; give the name of a file in it")
    if not path.is_file():
        raise FileNotFoundError(f"{name}: there is no file {str(path)!r}")
    path.open("rb").close()  # raises PermissionError
    return path


def lengths(vectors):
    """Euclidean lengths along a short last axis (several times faster than `numpy.linalg.norm`)."""
    return np.sqrt(np.einsum("...i,...i->...", vectors, vectors))


def largest(vectors):
    """Largest size of a component of vectors ``(n, dim)``, 0 without one (ten times faster than `max`)."""
    return reduce(np.maximum, np.abs(vectors).T, np.zeros(len(vectors)))


def extent(points):
    """Diagonal of the box around points ``(..., dim)`` (by columns, which is many times faster)."""
    return np.linalg.norm([np.ptp(column) for column in points.reshape(-1, points.shape[-1]).T])
