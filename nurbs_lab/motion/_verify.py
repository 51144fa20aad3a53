"""By what a planned feed exceeds its limits, measured on the sampled path."""

import numpy as np

from nurbs_lab.common.progress import step_blocks
from nurbs_lab.motion import _measure
from nurbs_lab.nurbs import span_kernels


def measure(track, limits, profile):
    """By what factor the sampled path is too fast.

    Returns
    -------
    most : float
        1 or less where every limit holds.
    lengths : ndarray, shape (n,)
        Of the samples along the path.
    steps : ndarray, shape (n - 1,)
        The same factor for each period, of the limits that a lower speed there cures.
    """
    count = 1 + int(np.ceil(profile.duration / limits.period_s - 1e-9))
    t = np.linspace(0.0, profile.duration, max(count, 2))
    v, a, lengths = (
        profile.speed(t),
        profile.acceleration(t),
        np.minimum(profile.displacement(t), track.length),
    )
    u, tangents, curvatures = np.empty(len(t)), np.empty((len(t), 3)), np.empty((len(t), 3))
    for part in step_blocks(len(t), "checking"):
        span_kernels.invert(track.spans, track.panels, lengths[part], u[part])
        span = np.clip(np.searchsorted(track.spans[0], u[part], side="right") - 1, 0, len(track.spans[0]) - 2)
        _measure.bends(track.spans, span, u[part], tangents[part], curvatures[part])
    terms = profile.terms
    accelerations = np.append(
        2.0 * terms[:, 2], 2.0 * terms[:, 2] + 6.0 * terms[:, 3] * np.diff(profile.times)
    )
    along = [profile.peak / limits.speed, np.sqrt(np.abs(accelerations).max() / limits.acceleration)]
    if limits.jerk is not None:
        along.append(np.cbrt(6.0 * np.abs(terms[:, 3]).max() / limits.jerk))
    if limits.axis_acceleration is not None:
        axes = (a[:, None] * tangents + v[:, None] ** 2 * curvatures)[:, : len(limits.axis_acceleration)]
        along.append(np.sqrt((np.abs(axes) / limits.axis_acceleration).max()))
    here = np.zeros(len(u))
    if limits.centripetal_acceleration is not None:
        across = v**2 * np.linalg.norm(curvatures, axis=1)
        here = np.maximum(here, np.sqrt(across / limits.centripetal_acceleration))
    if limits.axis_speed is not None:
        speeds = np.abs(v[:, None] * tangents[:, : len(limits.axis_speed)])
        here = np.maximum(here, (speeds / limits.axis_speed).max(axis=1))
    steps = np.maximum(here[1:], here[:-1])
    if limits.chord_error is not None:
        chords, rises = np.empty(len(u) - 1), np.empty(len(u) - 1)
        for part in step_blocks(len(chords), "checking"):
            ends = u[part.start : part.stop + 1]
            _measure.chord_lengths_and_rises(track.spans, ends, chords[part], rises[part])
        steps = np.maximum(steps, np.sqrt(rises / limits.chord_error))
    return max(*along, steps.max()), lengths, steps
