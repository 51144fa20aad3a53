"""Values: frozen dataclasses over read-only arrays that are equal by content."""

import dataclasses
from collections.abc import Mapping

import numpy as np


class Value:
    """Base of frozen dataclasses declared with ``eq=False, repr=False``.

    Two values are equal if they are of one type and all their fields are equal, arrays entry by entry. Equal
    values have the same hash. Arrays are read-only. A copied or unpickled value is made by its constructor,
    so that they stay so and kernels take them without being compiled again. The printed form is one short
    line: an array is shown by its shape, a sequence by its length.
    """

    __slots__ = ()

    def __post_init__(self):
        _freeze(_fields(self))

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        return self is other or _key(_fields(self)) == _key(_fields(other))

    def __hash__(self):
        return hash((type(self).__name__, _key(_fields(self))))

    def __repr__(self):
        names = [field.name for field in dataclasses.fields(self) if not field.name.startswith("_")]
        return (
            f"{type(self).__name__}({', '.join(f'{name}={_brief(getattr(self, name))}' for name in names)})"
        )

    def __reduce__(self):
        return type(self), tuple(_fields(self))


def _freeze(items):
    """Make arrays read-only, also those in sequences and in other frozen records."""
    for item in items:
        if isinstance(item, np.ndarray):
            item.setflags(write=False)
        elif isinstance(item, (list, tuple)):
            _freeze(item)
        elif hasattr(item, "__dataclass_fields__") and not isinstance(item, Value):
            _freeze(_fields(item))


def _fields(value):
    return [getattr(value, name) for name in value.__dataclass_fields__]


def _brief(item):
    if isinstance(item, np.ndarray):
        return f"<array {' x '.join(map(str, item.shape))}>"
    if isinstance(item, (list, tuple)) and item and (len(item) > 4 or not np.isscalar(item[0])):
        return f"<{len(item)} {type(item[0]).__name__}>"
    if isinstance(item, Value):
        return f"<{type(item).__name__}>"
    return f"{item:.6g}" if isinstance(item, float) else repr(item)


def _key(item):
    """A key that is equal for equal items, and hashable if they are."""
    if isinstance(item, np.ndarray):
        return item.shape, (item + 0.0).tobytes()  # makes integers floats, and -0.0 and 0.0 one number
    if isinstance(item, (list, tuple)):
        return tuple(map(_key, item))
    if isinstance(item, Mapping):
        return frozenset((name, _key(value)) for name, value in item.items())
    return item
