"""The twins of the arithmetic units beside exact fractions."""

from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from nurbs_lab.hardware.arithmetic import divide, round_shift, square_root

WORD = st.integers(-(1 << 69), (1 << 69) - 1)


@given(WORD, st.integers(0, 60))
def test_a_rounding_shift_is_within_half_a_unit(value, bits):
    error = round_shift(value, bits) - Fraction(value, 1 << bits)
    assert -Fraction(1, 2) < error <= Fraction(1, 2)


@given(WORD, st.integers(0, (1 << 35) - 1))
def test_a_quotient_is_within_half_a_unit_or_flagged(numerator, denominator):
    quotient, overflow, by_zero = divide(numerator, denominator, 35)
    assert by_zero == (denominator == 0)
    if by_zero or overflow:
        assert abs(quotient) == (1 << 34) - 1
        assert by_zero or abs(Fraction(numerator, denominator)) >= Fraction((1 << 35) - 1, 2)
    else:
        error = quotient - Fraction(numerator, denominator)
        assert abs(error) <= Fraction(1, 2)
        assert abs(error) < Fraction(1, 2) or (error > 0) == (numerator > 0)


def test_every_small_quotient():
    for numerator, denominator in product(range(-40, 41), range(1, 20)):
        exact = Fraction(numerator, denominator)
        quotient, *flags = divide(numerator, denominator, 9)
        assert flags == [False, False]
        assert abs(quotient - exact) <= Fraction(1, 2)


@given(st.integers(0, (1 << 70) - 1))
def test_a_root_is_within_half_a_unit(radicand):
    root = square_root(radicand)
    assert max(2 * root - 1, 0) ** 2 <= 4 * radicand < (2 * root + 1) ** 2
