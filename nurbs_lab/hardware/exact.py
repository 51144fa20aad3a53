"""Twin of rtl/streamer.v: steps by arc length with the exact |C'|, per-span polynomials, in integers."""

from dataclasses import replace
from itertools import chain, islice, pairwise, repeat, takewhile

from nurbs_lab.common.checks import as_count, as_kind, as_sequence
from nurbs_lab.hardware.arithmetic import Format, round_shift
from nurbs_lab.hardware.exact_program import BANK, S_GUARD, T_GUARD, ExactProgram, is_cubic
from nurbs_lab.hardware.feed import distances
from nurbs_lab.hardware.feed_override import FeedOverride
from nurbs_lab.hardware.stepper import Fault, Run, check_limits


def run_exact(program, rates=(), abort=None) -> Run:
    """Run the twin: positions ``piece, t`` in one integer, points, and outputs.

    Parameters
    ----------
    program : ExactProgram
    rates : iterable of int, optional
        Feed override sampled in each period, 0 (hold) to 256, as which 257 to 511 count; the last one
        goes on, 256 if there is none.
    abort : int, optional
        Period from which on the run is aborted: the tool slows down, and the run ends where it rests.

    Raises
    ------
    ValueError
        If a rate is out of its range, or the last one is 0 and the motion would never end.
    """
    as_kind("program", program, ExactProgram)
    rates = [as_count("rates", rate, 0, 511) for rate in as_sequence("rates", rates)] or [256]
    abort = None if abort is None else as_count("abort", abort, 0)
    override = FeedOverride([*distances(program.feed)], program.override, program.format.word)
    later = takewhile(lambda rate: rate or override.rate or abort is not None, repeat(rates[-1]))
    commands = chain(islice(chain(rates, later), abort), repeat(None))
    done = Run()
    try:
        for beat in walk(program, override, commands):
            for column, value in zip((done.u, done.points, done.outputs), beat, strict=True):
                column.append(value)
    except Fault as fault:
        return replace(done, flags=fault.args)
    if abort is None and not override.arrived:
        raise ValueError("rates end in 0 before the motion does, which would hold for ever")
    return done if override.arrived else replace(done, flags=("aborted",))


def walk(program, override, commands):
    """Position, point and outputs of each period under its command; `Fault` as the chip."""
    bits = program.format.word - 1
    pieces, number, names = program.pieces, 0, []
    # Number of each piece in its bank, with the bank above, and whether the bank is cubic.
    for n, ((first, _), (last, _)) in enumerate(pairwise(program.cuts())):
        cubic = is_cubic(pieces[first:last])
        names += [((n & 1) * BANK + i, cubic) for i in range(last - first)]
    limits = {**dict(enumerate(chain.from_iterable(program.axis_limits))), 7: program.largest_step}
    bounds = chain.from_iterable(program.bounds())
    if any(bound > limits[i] if i & 1 else bound < limits[i] for i, bound in bounds):  # rtl/banks.v
        raise Fault("bad curve", "beyond")
    t, y, along, before, outputs = 0, pieces[0].root, 0, [], 0
    for move in override.run(commands):
        position, point = _place(pieces[number], names[number][0], t, bits)
        check_limits(program, point, before)
        yield position, point, outputs
        before = [point]
        moved = round_shift(move, Format.ramp_guard - S_GUARD)
        along += moved
        while along >= pieces[number].length and number + 1 < len(pieces):
            along -= pieces[number].length
            moved, number = along, number + 1
            t, y = 0, pieces[number].root
        outputs = pieces[number].outputs
        t, y, h = advance(pieces[number], t, y, round_shift(moved, S_GUARD), bits, names[number][1])
        settled = -1 << bits - 8 <= h < 1 << bits - 8
        past = along - pieces[number].length >= 1 << bits + 11  # the end, by more than fits a step
        if (past or not settled) and not override.arrived:
            raise Fault("overflow")
    if override.arrived:
        point = program.end
    else:
        position, point = _place(pieces[number], names[number][0], t, bits)
    check_limits(program, point, before)
    yield position, point, outputs


def _place(piece, name, t, bits):
    """Position and point."""
    word = min(t >> T_GUARD, (1 << bits) - 1)
    values = []
    for a in piece.points:
        x = a[3]
        for c in a[2::-1]:
            x = round_shift(x * word, bits) + c
        values.append(x)
    return name << bits | word, tuple(values)


def advance(piece, t, y, ds, tf, cubic):
    """One step of arc length ``ds``: t and y after it, and what y² |C'|² lacked of 1 in its middle."""
    ef = tf - 4
    d0, d1, d2, d3, d4 = piece.metric
    p = (ds * y) >> piece.shift  # with guard bits
    p_word = p >> T_GUARD
    m = min((t + (p >> 1)) >> T_GUARD, (1 << tf) - 1)
    yy = round_shift(y * y, ef)
    w, ty, d0yy = round_shift(p_word * yy, tf), round_shift(m * yy, tf), round_shift(d0 * yy, ef)
    if cubic:
        q = round_shift(d4 * m, tf)
        b3, c3, e3 = q + d3, 2 * q + d3, 3 * q + d3
        b2 = round_shift(b3 * m, tf) + d2
        c2 = round_shift(c3 * m, tf) + b2
        e2 = round_shift(e3 * m, tf) + c2
        b1 = round_shift(b2 * m, tf) + d1
        c1 = round_shift(c2 * m, tf) + b1
    else:
        q = round_shift(d2 * m, tf)
        b1, c1, e2 = q + d1, 2 * q + d1, d2
    h = (1 << ef) - d0yy - round_shift(b1 * ty, ef)
    x = round_shift(c1 * w, ef)
    v = round_shift(round_shift(e2 * p_word, tf) * w, ef)
    xx = round_shift(x * x, ef)
    part = (4 * v - xx) >> 7
    part += part >> 2
    part += part >> 4
    both = (h >> 1) + (round_shift(h * (3 * h - x), ef) >> 3)
    of_t = both - part - (part >> 8)
    of_y = both - (x >> 1) + (3 * xx >> 3) - (v >> 1)
    t_new = t + p + round_shift(p_word * of_t, ef - T_GUARD)
    y_new = y + round_shift(y * of_y, ef)
    return t_new, y_new, h
