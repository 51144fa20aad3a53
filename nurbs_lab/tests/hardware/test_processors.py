"""The paper's FPGA against a CPU: operations counted twice, formulas seen again in the steppers."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import estimate_s, measure_s, serial_parameters
from nurbs_lab.hardware.timing import operations


def test_eight_serial_points_give_the_parameters_of_the_stepper():
    path = nl.trace(nl.paper.CURVE, 4.0, stepper="paper", period_s=1e-3)
    np.testing.assert_allclose(serial_parameters(path)[:-2], path.u[5:-1], rtol=1e-14)
    assert measure_s(path) < 1e-5


class Counter:
    """A number that counts what is done with it."""

    def __init__(self, counts):
        self.counts = counts

    def counted(self, kind):
        self.counts[kind] += 1
        return self

    def __add__(self, other):
        return self.counted("add")

    def __mul__(self, other):
        return self.counted("multiply")

    def __truediv__(self, other):
        return self.counted("divide")

    __sub__ = __add__


def cox_de_boor(u, knots, weights, degree, dim):
    """The NURBS Book, A2.2 and A3.1, on numbers that count."""
    left = [u - knots for _ in range(degree)]
    right = [knots - u for _ in range(degree)]
    for j in range(degree):
        for r in range(j + 1):
            part = weights / (right[r] + left[j - r])
            _ = weights + right[r] * part
            _ = left[j - r] * part
    total = [weights * knots for _ in range(dim)]
    for _ in range(degree):
        total = [total[k] + weights * knots for k in range(dim)]
    return total


@pytest.mark.parametrize("cached", [False, True])
def test_operations_of_eq_17_are_those_of_a_program_that_counts(cached):
    degree, dim = 2, 2
    counts = {"add": 0, "multiply": 0, "divide": 0, "root": 0}
    number, total = Counter(counts), Counter(counts)
    slopes = []
    for quotient in range(4):
        if cached and quotient:
            slopes.append(number)  # kept from the step before
            continue
        one = cox_de_boor(number, number, number, degree, dim)
        two = [number] * dim if cached else cox_de_boor(number, number, number, degree, dim)
        squares = [(b - a) * (b - a) for a, b in zip(one, two, strict=True)]
        counts["add"] -= dim  # each difference is taken once
        for other in squares[1:]:
            squares[0] = squares[0] + other
        counts["root"] += 1
        slopes.append(number / (squares[0] / (number - number)))
    total = number * slopes[0] - number * slopes[1] + number * slopes[2] - number * slopes[3]
    number + number * total
    assert [*counts.values()] == operations(cached=cached).tolist()


def test_an_estimate_is_a_range():
    low, high = estimate_s()
    assert 2e-6 < low < high < 1e-5
    assert estimate_s(cached=True)[1] < low / 2
