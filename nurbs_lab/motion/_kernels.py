"""Kernels that all of this room shares: the feed in time, how a step ends, and what is measured on a path.

The curve comes as a span table, its arc length as a panel table; see `nurbs.span_kernels`.

A *feed table* is ``(times, terms)``: on phase i the travelled length is
``terms[i] @ (1, tau, tau**2, tau**3)`` with ``tau = t - times[i]``; the last phase has no end.
"""

from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import ZERO, inlined, kernel
from nurbs_lab.nurbs.span_kernels import derivatives, find_span, point, speed


@kernel
def feed_at(feed, t, hint):
    """Speed, acceleration and jerk at time t, and the phase that holds t."""
    times, terms = feed
    hint = find_span(times, t, hint)
    tau = t - times[hint]
    v = terms[hint, 1] + tau * (2.0 * terms[hint, 2] + tau * 3.0 * terms[hint, 3])
    return v, 2.0 * terms[hint, 2] + 6.0 * tau * terms[hint, 3], 6.0 * terms[hint, 3], hint


@kernel
def displacement(feed, t, duration, hint):
    """Length commanded between t and t + duration, without the cancellation of s(t + duration) - s(t)."""
    times = feed[0]
    total = 0.0
    while duration > 0.0:
        v, a, j, hint = feed_at(feed, t, hint)
        left = times[hint + 1] - t
        if left >= duration * (1.0 - 1e-12) or hint == times.size - 2:
            left = duration
        total += left * (v + left * (0.5 * a + left * j / 6.0))
        duration -= left
        t = times[hint + 1]
    return total


@inlined
def length_at(feed, t, phase):
    """Length commanded until time t, in the phase that holds t."""
    times, terms = feed
    tau = t - times[phase]
    return terms[phase, 0] + tau * (terms[phase, 1] + tau * (terms[phase, 2] + tau * terms[phase, 3]))


@kernel
def settle(u, step, following, end):
    """Store the next parameter, which is NaN if the rule broke down; whether the path goes on after it.

    What would be left for a step of less than a hundredth of this one is moved with it.
    """
    going = following < end - 0.01 * (following - u[step]) and step + 2 < u.size
    u[step + 1] = following if going else end
    if not (np.isfinite(following) and following >= u[step]):
        u[step + 1] = np.nan
        going = False
    return going


@kernel
def slowest_places(spans):
    """Span, parameter and |C'| of both ends of every span and of every local minimum of |C'| inside.

    The minima are those of 33 samples a span that lie clearly below a neighbour, narrowed by 80 thirds.
    """
    breaks, found, values = spans[0], [], np.empty(33)
    for span in range(breaks.size - 1):
        start, step = breaks[span], (breaks[span + 1] - breaks[span]) / 32.0
        for k in range(33):
            values[k] = speed(spans, span, start + k * step)
        found.append((span, start, values[0]))
        for k in range(1, 32):
            least, beside = min(values[k - 1], values[k + 1]), max(values[k - 1], values[k + 1])
            if values[k] <= least and 1.2 * values[k] < beside:
                low, high = start + (k - 1) * step, start + (k + 1) * step
                for _ in range(80):
                    one, two = low + (high - low) / 3.0, high - (high - low) / 3.0
                    if speed(spans, span, one) < speed(spans, span, two):
                        high = two
                    else:
                        low = one
                found.append((span, low, speed(spans, span, low)))
        found.append((span, breaks[span + 1], values[32]))
    where = np.array([place[0] for place in found])
    return where, np.array([place[1] for place in found]), np.array([place[2] for place in found])


@kernel
def commanded_lengths(feed, period, out):
    """Length commanded in every period."""
    hint = ZERO
    for k in range(out.size):
        t = k * period
        hint = find_span(feed[0], t, hint)
        out[k] = displacement(feed, t, period, hint)


@kernel
def _time_within(times, terms, i, goal):
    """Time from the start of phase i in which a length has been travelled there.

    At most 100 steps of Newton's method; one that leaves the bracket is a bisection.
    """
    one, two, three = terms[i, 1], terms[i, 2], terms[i, 3]
    low, high = 0.0, times[i + 1] - times[i]
    width = terms[i + 1, 0] - terms[i, 0]
    tau = high * min(max(goal / width, 0.0), 1.0) if width > 0.0 else 0.0
    for _ in range(100):
        excess = tau * (one + tau * (two + tau * three)) - goal
        if excess > 0.0:
            high = tau
        else:
            low = tau
        slope = one + tau * (2.0 * two + tau * 3.0 * three)
        following = tau - excess / slope if slope > 0.0 else low - 1.0
        if not low <= following <= high:
            following = 0.5 * (low + high)
        moved = abs(following - tau)
        tau = following
        if moved <= 1e-16 * (times[i] + tau):
            break
    return tau


@kernel
def times_at(times, terms, lengths, out):
    """Times at which lengths, which do not fall, have been travelled."""
    i, last = 0, terms.shape[0] - 1  # the endless phase after the end
    for k in range(lengths.size):
        while i < last - 1 and lengths[k] >= terms[i + 1, 0]:
            i += 1
        out[k] = times[i] + _time_within(times, terms, i, lengths[k] - terms[i, 0])


@kernel
def plan_at(feed, length, hint):
    """Speed, acceleration, jerk and time where a length has been travelled, and the phase that holds it."""
    times, terms = feed
    while hint < terms.shape[0] - 1 and length >= terms[hint + 1, 0]:
        hint += 1
    while hint > 0 and length < terms[hint, 0]:
        hint -= 1
    tau = 0.0
    if hint < terms.shape[0] - 1:
        tau = _time_within(times, terms, hint, length - terms[hint, 0])
    v, a, j = terms[hint, 1], 2.0 * terms[hint, 2], 6.0 * terms[hint, 3]
    return v + tau * (a + tau * 0.5 * j), a + tau * j, j, times[hint] + tau, hint


@kernel
def _distance(spans, span, u, origin, chord, length):
    """Distance of C(u) from the chord that begins at ``origin``."""
    x, y, z = point(spans, find_span(spans[0], u, span), u)
    x, y, z = x - origin[0], y - origin[1], z - origin[2]
    along = (x * chord[0] + y * chord[1] + z * chord[2]) / (length * length) if length > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    x, y, z = x - along * chord[0], y - along * chord[1], z - along * chord[2]
    return sqrt(x * x + y * y + z * z)


@kernel
def chord_lengths_and_errors(spans, u, chords, errors):
    """Chord of every step and its chord error.

    The distance is measured at seven samples, below the top of the parabola through the largest three, and at
    the knots within the step, where the arc may have a corner.
    """
    span, breaks, sampled = 0, spans[0], np.zeros(9)  # at its ends the arc is on the chord
    for k in range(u.size - 1):
        span = find_span(spans[0], u[k], span)
        start = point(spans, span, u[k])
        end_x, end_y, end_z = point(spans, find_span(spans[0], u[k + 1], span), u[k + 1])
        chord = (end_x - start[0], end_y - start[1], end_z - start[2])
        chords[k] = sqrt(chord[0] ** 2 + chord[1] ** 2 + chord[2] ** 2)
        width = (u[k + 1] - u[k]) / 8
        for i in range(1, 8):
            sampled[i] = _distance(spans, span, u[k] + i * width, start, chord, chords[k])
        top = max(1, sampled.argmax())
        before, best, after = sampled[top - 1 : top + 2]
        second = before - 2.0 * best + after
        peak = top + 0.5 * (before - after) / second if second < 0.0 else top
        errors[k] = max(best, _distance(spans, span, u[k] + peak * width, start, chord, chords[k]))
        knot = span + 1
        while knot < breaks.size and breaks[knot] < u[k + 1]:
            errors[k] = max(errors[k], _distance(spans, knot, breaks[knot], start, chord, chords[k]))
            knot += 1


@kernel
def path_derivatives(spans, span_of, u, tangents, curvatures, rates):
    """Unit tangent, curvature vector and its derivative by arc length at every u, in the named span."""
    for k in range(u.size):
        x1, x2, x3 = derivatives(spans, span_of[k], u[k], ZERO)
        y1, y2, y3 = derivatives(spans, span_of[k], u[k], ZERO + 1)
        z1, z2, z3 = derivatives(spans, span_of[k], u[k], ZERO + 2)
        square = x1 * x1 + y1 * y1 + z1 * z1
        one = 1.0 / sqrt(square)  # of u by arc length: the first derivative, the second and the third
        along = (x1 * x2 + y1 * y2 + z1 * z2) / square
        turning = (x2 * x2 + y2 * y2 + z2 * z2 + x1 * x3 + y1 * y3 + z1 * z3) / square
        two = -along * one * one
        three = (4.0 * along * along - turning) * one**3
        for c, (first, second, third) in enumerate(((x1, x2, x3), (y1, y2, y3), (z1, z2, z3))):
            if c < tangents.shape[1]:
                tangents[k, c] = first * one
                curvatures[k, c] = second * one * one + first * two
                rates[k, c] = third * one**3 + 3.0 * second * one * two + first * three


@kernel
def pass_speeds(corners, window, period, budgets, top, out):
    """Lower ``out`` to the speeds at which no difference of positions takes more than its budget at corners.

    ``corners`` is (lengths, steps of the unit tangents, speeds v that other limits allow). The n-th
    difference of positions a period apart is a sum of these steps, each weighted by how far the positions lie
    beyond it. It is linear in the speed until a position meets another corner, and largest where one of them
    lies on a corner: the k-th, for the ``window`` (n, k). ``budgets`` holds what the vector may take, and
    each axis. Of it corners take at most ``(1 + (speed / V)**2) / 2`` at any speed up to the one V that is
    held, and ``(v / V + speed**2 / (v V)) / 2`` where v is lower.
    """
    (lengths, steps, fastest), (order, k) = corners, window
    weights, passed = np.ones(order + 1), np.empty(order + 1, dtype=np.int64)
    for m in range(order):
        weights[m + 1] = weights[m] * (m - order) / (m + 1.0)
    for i in range(lengths.size):
        change, rate = np.zeros(steps.shape[1]), np.zeros(steps.shape[1])
        for m in range(order + 1):
            passed[m] = i + 1 if m > k else i - 1
            rate += max(m - k, 0) * weights[m] * steps[i]
        speed, used, held, share = 0.0, 0.0, top, 0.0
        while speed < held:
            following, met = held, k
            for m in range(order + 1):
                if m != k and 0 <= passed[m] < lengths.size:
                    way = abs(lengths[passed[m]] - lengths[i]) / (abs(m - k) * period)
                    if way < following:
                        following, met = way, m
            change += (following - speed) * rate
            before, used = used, _used_of(change, budgets)
            held, share = _held(speed, following, before, used, held, share, fastest[i])
            speed = following
            if met == k:
                break
            rate += abs(met - k) * weights[met] * steps[passed[met]]
            passed[met] += 1 if met > k else -1
        if share > 0.0:
            out[i] = min(out[i], min(held, fastest[i]) / min(share, 1.0))


@inlined
def _used_of(change, budgets):
    """The largest part of the budgets of the vector and of each axis."""
    square, part = 0.0, 0.0
    for c in range(change.size):
        square += change[c] * change[c]
        part = max(part, abs(change[c]) / budgets[c + 1])
    return max(part, sqrt(square) / budgets[0])


@kernel
def _held(speed, following, before, used, held, share, fastest):
    """The speed held and the share of a corner, after what is used from one speed to the following."""
    steep = (used - before) / (following - speed) if following > speed else 0.0
    level, least = before - steep * speed, min(held, fastest)
    if steep > 0.0:
        at = min(max((1.0 - level - max(level, 0.0)) / steep, speed), following)
        part = level + steep * at
        if part > 0.5:
            held = min(held, at / sqrt(2.0 * part - 1.0))
        least = min(held, fastest)
        at = level / (steep * least)
        speed = max(speed, min(least * (sqrt(at * at + 1.0) - at), following, held))
    return held, max(share, 2.0 * (level + steep * speed) / (1.0 + (speed / least) ** 2))


@kernel
def near_corners(lengths, zones, held, parts):
    """Fill the least speed and the largest part at lengths inside zones."""
    for start, stop, most, part in zones:
        near = 1e-9 * (stop - start)
        for k in range(np.searchsorted(lengths, start + near), np.searchsorted(lengths, stop - near)):
            held[k], parts[k] = min(held[k], most), max(parts[k], part)


@kernel
def speed_limits(tangents, curvatures, along, period, axis_speed, axis_acceleration, out):
    """Fill ``out`` with the largest speed by each limit, in the order of `limits.NAMES`, and the curvature.

    A speed is infinite where the limit does not apply. ``along`` holds the limits of speed, chord error and
    centripetal acceleration. A chord error eps allows ``2/T sqrt(2 rho eps - eps**2)``, and 2 rho / T where
    it exceeds the radius of curvature rho.

    Axis i alone allows strips ``|t_i a + n_i v²| <= A_i`` in the plane of a and v²; two of them cross where
    eliminating a leaves ``|n_i t_k - n_k t_i| v² <= A_i |t_k| + A_k |t_i|``.
    """
    speed, chord_error, centripetal = along
    out[0] = speed
    out[1:5] = np.inf
    for k in range(curvatures.shape[0]):
        t, n, square = tangents[k], curvatures[k], 0.0
        for i in range(n.size):
            square += n[i] * n[i]
        out[5, k] = curvature = sqrt(square)
        if chord_error < np.inf and curvature > 0.0:
            radius = 1.0 / curvature
            depth = min(chord_error, radius)
            out[1, k] = 2.0 / period * sqrt(depth * (2.0 * radius - depth))
        if curvature > 0.0:
            out[2, k] = sqrt(centripetal / curvature)
        for i in range(axis_speed.size):
            if t[i] != 0.0:
                out[3, k] = min(out[3, k], axis_speed[i] / abs(t[i]))
        for i in range(axis_acceleration.size):
            for j in range(i):
                cross = abs(n[i] * t[j] - n[j] * t[i])
                if cross > 0.0:
                    room = axis_acceleration[i] * abs(t[j]) + axis_acceleration[j] * abs(t[i])
                    out[4, k] = min(out[4, k], sqrt(room / cross))
