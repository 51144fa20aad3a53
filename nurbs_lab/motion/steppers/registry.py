"""The catalogue of steppers, the one signature they share, and the options they declare."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib import import_module

import numpy as np

from nurbs_lab import LATE_STEPPERS
from nurbs_lab.common.checks import as_choice, as_count, as_kind, as_number, as_reals, as_vector, shown
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.motion.prepared_curve import Track
from nurbs_lab.nurbs import NurbsCurve


@dataclass(frozen=True)
class Job:
    """What a stepper is asked to do: step along a curve every ``period_s``, at the speed of ``feed``."""

    track: Track
    feed: FeedProfile
    period_s: float

    @property
    def curve(self) -> NurbsCurve:
        """The curve itself."""
        return self.track.curve

    @property
    def last_step(self) -> int:
        """Number of the step that has to end at the curve's end.

        A feed that comes to rest ends with its last period. One that does not goes on at its end speed
        until the curve ends, for at most a twentieth longer than planned.
        """
        planned = int(np.ceil(self.feed.duration / self.period_s - 1e-9))
        return planned if self.feed.rests else planned + planned // 20 + 16


@dataclass(frozen=True)
class Steps:
    """What a stepper gives back.

    ``evaluations`` counts C, C', C'' and C''' over the whole run. ``points`` are left out by a stepper whose
    points are C(u); ``details`` holds whatever else it measured.
    """

    u: np.ndarray
    evaluations: tuple[int, int, int, int]
    points: np.ndarray | None = None
    details: Mapping = field(default_factory=dict)

    def __post_init__(self):
        object.__setattr__(self, "u", as_reals("u", self.u, ("n",)))
        as_vector("evaluations", self.evaluations, 4)


@dataclass(frozen=True)
class Option:
    """A choice that a stepper leaves to whoever calls ``trace``.

    ``kind`` is ``int``, ``float``, ``str`` or any other type; ``allowed`` are the least and the greatest of
    a number, or the words that a ``str`` may be: none if it may be any.
    """

    name: str
    kind: type
    default: object
    allowed: tuple
    summary: str

    def check(self, value):
        """The value, if it is of the declared kind and in the declared range."""
        if self.kind is int:
            return as_count(self.name, value, *self.allowed)
        if self.kind is str and self.allowed:
            return as_choice(self.name, value, self.allowed)
        if self.kind is not float:
            return as_kind(self.name, value, self.kind)
        number, (least, most) = as_number(self.name, value), self.allowed
        if not least <= number <= most:
            raise ValueError(f"{self.name} must be from {least:g} to {most:g}, got {number:g}")
        return number


@dataclass(frozen=True)
class Stepper:
    """A rule that gives the next parameter.

    Attributes
    ----------
    name, summary : str
        The summary is one line with the source.
    evaluations : tuple of int
        Of C and of its first three derivatives, per step once under way. The point that moves the tool is
        counted only where the rule itself makes use of it.
    run : callable
        ``run(job, **options)`` returns the `Steps` of the whole path.
    order : int or None
        Order of accuracy on a smooth span; None where the error is not a power of the period.
    options : tuple of Option
    keeps : tuple of str
        Limits of a plan that its paths were measured to keep, by differences of their points, on 240 curves
        with weights of 1e-3 to 1e3, to 0.2 %, jerks to 0.7 %. Empty for a rule not fit for a machine.
    """

    name: str
    summary: str
    evaluations: tuple[int, int, int, int]
    run: Callable[..., Steps]
    order: int | None = None
    options: tuple[Option, ...] = ()
    keeps: tuple[str, ...] = ()

    def checked(self, given):
        """The options that were given, each checked by its declaration."""
        declared = {option.name: option for option in self.options}
        for name in given:
            if name not in declared:
                known = ", ".join(declared) or "none"
                raise TypeError(f"stepper {self.name!r} has no option {name!r}; it takes {known}")
        return {name: declared[name].check(value) for name, value in given.items()}


#: Limits that a stepper keeps which moves the commanded arc.
KEPT = "speed", "chord_error", "axis_speed", "acceleration", "axis_acceleration", "jerk", "axis_jerk"
_STEPPERS: dict[str, Stepper] = {}


class _Catalogue(Mapping):
    """Name -> stepper, in the order of registration; a stepper of another package is imported on demand."""

    def __getitem__(self, name):
        if name not in _STEPPERS and name in LATE_STEPPERS:
            import_module(LATE_STEPPERS[name])
        return _STEPPERS[name]

    def __iter__(self):
        return iter(_STEPPERS | dict.fromkeys(LATE_STEPPERS))

    def __len__(self):
        return len(_STEPPERS.keys() | LATE_STEPPERS)


STEPPERS = _Catalogue()


def software_steppers():
    """Names of the steppers that are kernels, not simulated hardware."""
    return [name for name in STEPPERS if name not in LATE_STEPPERS]


def register(stepper):
    """Add a stepper under its name; ``trace`` and every test that runs over ``STEPPERS`` then know it."""
    _STEPPERS[as_kind("stepper", stepper, Stepper).name] = stepper
    return stepper


def find_stepper(name):
    """The stepper of that name; the error names the nearest names, if there is none."""
    if isinstance(name, Stepper):
        return name
    if not isinstance(name, str):
        raise TypeError(f"stepper must be a name, one of {', '.join(STEPPERS)}; got {shown(name)}")
    if name not in STEPPERS:
        near = " or ".join(map(repr, get_close_matches(name, STEPPERS, n=3, cutoff=0.4)))
        hint = f"did you mean {near}?" if near else f"choose from {', '.join(STEPPERS)}"
        raise ValueError(f"unknown stepper {shown(name)}; {hint}")
    return STEPPERS[name]


def run(stepper, job, options):
    """The `Steps` of the whole path; a path from or to a double end point only by steppers that are fit."""
    if not stepper.keeps and not np.isin(job.track.dips[1][[0, -1]], job.curve.domain).all():
        raise ValueError(
            f"curve has a double end point, where C' vanishes and {stepper.name!r} finds no step; take "
            + ", ".join(repr(one.name) for one in _STEPPERS.values() if one.keeps)
        )
    steps = as_kind(f"what {stepper.name!r} returns", stepper.run(job, **options), Steps)
    u, (begin, end) = steps.u, job.track.domain
    forward = np.append(np.diff(u) >= 0.0, u[-1:] == end)
    if steps.points is None and u[:1].tolist() != [begin]:
        raise ValueError(f"u of {stepper.name!r} begins with {u[:1]}; it must begin with {begin:.9g}")
    if steps.points is None and not forward.all():
        step = int(forward.argmin())
        what = "no forward step" if step < len(u) - 1 else "the end of the curve is not reached"
        raise ValueError(f"step {step} at u = {u[step]:.9g}: {what}; try a shorter period or another stepper")
    return steps


def steps_of(job, kernel, *options, details=None):
    """The `Steps` of a rule in software: ``kernel(spans, feed, period, u, counts, *options) -> step``.

    The kernel fills ``u``, which begins with the first parameter and has room for every step, adds its
    evaluations to ``counts``, and returns the number of its last step.
    """
    track, counts, u = job.track, np.zeros(4, dtype=np.int64), np.empty(job.last_step + 1)
    u[0] = track.domain[0]
    step = kernel(track.spans, job.feed.table, job.period_s, u, counts, *options)
    return Steps(u[: step + 2], tuple(map(int, counts)), details=details or {})
