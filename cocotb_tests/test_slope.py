"""Bench of rtl/slope.v: every order, on one module cuk and on two."""

import cocotb
import pytest

from cocotb_tests.bench import WATCHDOG, Unit, load_bus, packed, signed, simulate, words
from cocotb_tests.curves import random_curve
from nurbs_lab.hardware import Format, evaluate_cu, load_curve
from nurbs_lab.hardware.arithmetic import divide, round_shift, square_root


@pytest.mark.parametrize(("pair", "dim"), [(0, 2), (1, 3)])
def test_slope(pair, dim):
    simulate("slope", __file__, DIM=dim, PAIR=pair)


def twin(loaded, want_a, want_b, want_k, given, u_a, u_b, shift, half, whole, s, du, base):
    """Point A, the slope, and the flags."""
    format = loaded.format
    move = round_shift((24 if whole else 12 if half else 0) * shift, format.guard)
    a, b = (evaluate_cu(loaded, min(max(u + move, 0), format.largest)).point for u in (u_a, u_b))
    chord = base if given else [x - y for x, y in zip(a, b if want_b else base, strict=True)]
    too_long = not all(-format.largest - 1 <= x <= format.largest for x in chord)
    if not want_k or too_long:
        return a, None, (want_k and too_long, False)
    k, overflow, by_zero = divide(s * du, square_root(sum(x * x for x in chord)), format.word)
    return a, k, (overflow, by_zero)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    names = "want_a want_b want_k given u_a u_b shift shift_half shift_whole s du base"
    unit = Unit(dut, names.split(), held=True)
    await unit.reset()
    dim, format, rng = dut.DIM.value.to_unsigned(), Format(), unit.rng
    for rational in (False, True):
        loaded = load_curve(random_curve(rng, 3, dim, rational), format)
        await load_bus(dut, loaded.writes())
        for _ in range(60):
            want_a, want_b, want_k, given = rng.choice(
                [(1, 1, 1, 0), (1, 0, 1, 0), (1, 0, 0, 0), (0, 0, 1, 1), (1, 0, 1, 1)]
            )
            u_a = int(rng.integers(loaded.first_u, loaded.last_u))
            du = int(rng.integers(1, 1 << 24))
            u_b = max(u_a - du, 0)
            shift = int(rng.integers(-(1 << 30), 1 << 34))
            half, whole = ((0, 0), (1, 0), (0, 1))[rng.integers(0, 3)]
            s = int(rng.integers(0, 1 << 26))
            near = evaluate_cu(loaded, u_b).point
            base = near if rng.random() < 0.8 else [int(x) for x in rng.integers(-(1 << 34), 1 << 34, dim)]
            order = (*map(int, (want_a, want_b, want_k, given)), u_a, u_b, shift, half, whole, s, du)
            await unit.ask(*order, packed(base, format.word))
            a, k, flags = twin(loaded, *order, base)
            assert (dut.overflow.value == 1, dut.by_zero.value == 1) == flags
            assert not want_a or words(dut.point.value.to_unsigned(), format.word, dim) == a
            assert k is None or signed(dut.k) == k
