"""The number format of the Verilog and its twins; quotient, root, rounding and checksum, in integers."""

from dataclasses import dataclass
from math import isqrt

from nurbs_lab.common.checks import as_count


@dataclass(frozen=True)
class Format:
    """Fixed point of one word length.

    Parameters
    ----------
    word : int
        Bits of a signed word: odd, 17 to 35. The shipped 35 is what four 18 x 18 multipliers take.
    """

    word: int = 35

    #: Bits below the last place of a parameter u that slopes carry.
    guard = 8
    #: Bits below the last place of a speed that the table of the feed carries.
    ramp_guard = 28

    def __post_init__(self):
        object.__setattr__(self, "word", as_count("word", self.word, 17, 35))
        if self.word % 2 == 0:
            raise ValueError(f"word must be odd, got {self.word}")

    #: Fraction bits of u, knots, N and weights; the number 1 as one of them.
    fraction = property(lambda self: self.word - 2)
    one = property(lambda self: 1 << self.fraction)
    #: Largest signed word; also the largest number without sign of one bit less.
    largest = property(lambda self: (1 << (self.word - 1)) - 1)


#: The format of the Verilog as shipped.
SHIPPED = Format()


def round_shift(value: int, bits: int) -> int:
    """``value / 2**bits`` to the nearest integer, halves up."""
    return (value + (1 << bits >> 1)) >> bits


def divide(numerator: int, denominator: int, word: int) -> tuple[int, bool, bool]:
    """Twin of ``divide``: the quotient to nearest, halves away from zero, and the flags overflow and by_zero.

    With a flag the quotient is the largest number of the numerator's sign.
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


def checksum(words, found=0) -> int:
    """Twin of what ``load_guard`` and ``axes`` sum up: rotated by a bit, then XOR with a word, of 32 bits."""
    for word in words:
        found = ((found << 1 | found >> 31) ^ word) & 0xFFFFFFFF
    return found
