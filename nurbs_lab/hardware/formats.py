"""The number format that the Verilog and its twins share."""

from dataclasses import dataclass

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
    max_degree = 5
    max_points = 64
    #: Largest power of two in the reciprocal of a knot difference.
    max_exponent = 15
    #: Largest weight over the smallest.
    max_weight_ratio = 1024

    def __post_init__(self):
        object.__setattr__(self, "word", as_count("word", self.word, 17, 35))
        if self.word % 2 == 0:
            raise ValueError(f"word must be odd, got {self.word}")

    @property
    def fraction(self) -> int:
        """Fraction bits of u, knots, N and weights."""
        return self.word - 2

    @property
    def one(self) -> int:
        """The number 1 as a parameter, an N or a weight."""
        return 1 << self.fraction

    @property
    def largest(self) -> int:
        """Largest signed word; also the largest number without sign of one bit less."""
        return (1 << (self.word - 1)) - 1


#: The format of the Verilog as shipped.
SHIPPED = Format()
