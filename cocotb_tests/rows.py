"""Python in the place of rtl/slope.v: answers the orders of the sequencers, after any number of cycles."""

from collections import deque

import cocotb
from cocotb.triggers import FallingEdge

from cocotb_tests.bench import packed, unknown, words
from nurbs_lab.hardware import evaluate_cu
from nurbs_lab.hardware.arithmetic import divide, square_root


def field(handle, width: int, row: int) -> int:
    """One row's part of a vector without sign."""
    return handle.value.to_unsigned() >> row * width & (1 << width) - 1


class Rows:
    """Serves the orders of a sequencer; ``points(dut, row, slopes)`` gives the u of A and B."""

    def __init__(self, dut, loaded, rng, points, count=1):
        self.dut, self.loaded, self.rng, self.points, self.count = dut, loaded, rng, points, count
        self.orders = 0
        self.waiting = deque()  # orders whose points are evaluated
        self.slopes = [0] * count
        dut.row_done.value = 0
        self.taken(0)
        dut.row_overflow.value = dut.row_by_zero.value = 0
        self.point = None  # A of the latest answer
        unknown(dut.row_k)
        cocotb.start_soon(self.take())
        cocotb.start_soon(self.serve())

    async def pause(self):
        for _ in range(int(self.rng.integers(0, 9))):
            await FallingEdge(self.dut.clk)

    def taken(self, value):
        if hasattr(self.dut, "row_taken"):
            self.dut.row_taken.value = value

    async def take(self):
        """Evaluate the points of an order, then allow the next, even while this one waits for its slope."""
        dut = self.dut
        while True:
            while dut.row_start.value != 1:
                await FallingEdge(dut.clk)
            self.orders += 1
            ends = [self.points(dut, row, self.slopes) for row in range(self.count)]
            await self.pause()
            self.waiting.append([[evaluate_cu(self.loaded, u).point for u in pair] for pair in ends])
            self.taken(1)
            await FallingEdge(dut.clk)
            self.taken(0)

    def slope(self, row, a, b):
        """The slope of one row's order."""
        dut, word = self.dut, self.loaded.format.word
        base = words(dut.row_base.value.to_unsigned(), word, self.loaded.dim)
        of_adams = not hasattr(dut, "row_given")
        given = not of_adams and bool(dut.row_given.value)
        both = dut.ARRANGEMENT.value.to_unsigned() != 2 if of_adams else bool(dut.row_want_b.value)
        chord = base if given else [x - y for x, y in zip(a, b if both else base, strict=True)]
        s = field(dut.row_s, word - 1, row)
        (du,) = words(field(dut.row_du, word, row), word, 1)
        return divide(s * du, square_root(sum(x * x for x in chord)), word)[0]

    async def serve(self):
        dut, word = self.dut, self.loaded.format.word
        while True:
            while not self.waiting:
                await FallingEdge(dut.clk)
            await self.pause()
            points = self.waiting.popleft()
            self.slopes = [self.slope(row, *pair) for row, pair in enumerate(points)]
            self.point = points[0][0]
            left = set(range(self.count))
            dut.row_k.value = packed(self.slopes, word)
            while left:  # the rows finish in any order, one or more at a time
                now = {row for row in left if len(left) == 1 or self.rng.random() < 0.5}
                left -= now
                dut.row_done.value = sum(1 << row for row in now)
                await FallingEdge(dut.clk)
                dut.row_done.value = 0
