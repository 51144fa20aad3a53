"""Twins of rtl/divide.v and rtl/square_root.v, and the rounding shift: Python integers, so exact."""

from math import isqrt


def round_shift(value: int, bits: int) -> int:
    """``value / 2**bits`` to the nearest integer, halves up."""
    return (value + (1 << bits >> 1)) >> bits


def divide(numerator: int, denominator: int, word: int) -> tuple[int, bool, bool]:
    """Twin of ``divide``: the quotient to nearest, halves away from zero.

    Returns
    -------
    quotient : int
        The largest number of the numerator's sign if a flag is up.
    overflow, by_zero : bool
    """
    largest = (1 << (word - 1)) - 1
    by_zero = denominator == 0
    magnitude = largest + 1 if by_zero else (2 * abs(numerator) + denominator) // (2 * denominator)
    overflow = not by_zero and magnitude > largest
    magnitude = min(magnitude, largest)
    return (-magnitude if numerator < 0 else magnitude), overflow, by_zero


def square_root(radicand: int) -> int:
    """Twin of ``square_root``: the root to nearest."""
    root = isqrt(radicand)
    return root + (radicand - root * root > root)
