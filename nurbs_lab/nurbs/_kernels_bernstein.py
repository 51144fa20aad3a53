"""Bounds of a polynomial on a patch, from its Bernstein coefficients.

The polynomials are those of closest points. On a patch A / w, the squared distance to a point q is at least b
wherever D - b W >= 0, with D = |A - q w|^2 and W = w^2.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined


@inlined
def square_nets(net, centre, factors_u, factors_v, out):
    """Coefficients of |A|^2, A_d w for each d, and w^2, with A seen from the centre.

    ``net (p + 1, q + 1, dim + 1)`` is homogeneous; ``out (dim + 2, 2 p + 1, 2 q + 1)``; the factors of
    the product of two Bernstein polynomials are ``factors_u`` and ``factors_v``.
    """
    dim = centre.size
    out[:] = 0.0
    for i in range(net.shape[0]):
        for j in range(net.shape[1]):
            for k in range(net.shape[0]):
                for m in range(net.shape[1]):
                    factor = factors_u[i, k] * factors_v[j, m]
                    heavy = factor * net[k, m, dim]
                    square = 0.0
                    for d in range(dim):
                        a = net[i, j, d] - centre[d] * net[i, j, dim]
                        square += a * (net[k, m, d] - centre[d] * net[k, m, dim])
                        out[1 + d, i + k, j + m] += heavy * a
                    out[0, i + k, j + m] += factor * square
                    out[dim + 1, i + k, j + m] += heavy * net[i, j, dim]


@inlined
def squared_size(vector):
    """The square of the length of a vector."""
    total = 0.0
    for part in vector:
        total += part * part
    return total


@inlined
def distance_net(squares, offset, out):
    """D and W ``(2, 2 p + 1, 2 q + 1)`` for a point at ``offset`` from the centre; the largest size of D."""
    dim, most = offset.size, 0.0
    far = squared_size(offset)
    for i in range(out.shape[1]):
        for j in range(out.shape[2]):
            weight = squares[dim + 1, i, j]
            total = squares[0, i, j] + far * weight
            for d in range(dim):
                total -= 2.0 * offset[d] * squares[1 + d, i, j]
            out[0, i, j] = total
            out[1, i, j] = weight
            most = max(most, abs(total))
    return most


@compiled
def excess(net, square, out):
    """Write D - square W to ``out`` and return the indices of its smallest coefficient."""
    where_i = where_j = 0
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = net[0, i, j] - square * net[1, i, j]
            if out[i, j] < out[where_i, where_j]:
                where_i, where_j = i, j
    return where_i, where_j


@compiled
def lowest_edge(gap):
    """The rows that can hold the minimum: one if the coefficients increase or decrease from row to row."""
    up = down = True
    for i in range(len(gap) - 1):
        for j in range(gap.shape[1]):
            up = up and gap[i + 1, j] >= gap[i, j]
            down = down and gap[i + 1, j] <= gap[i, j]
    return gap[:1] if up else gap[len(gap) - 1 :] if down else gap


@compiled
def second_derivatives(gap):
    """Bounds of the second derivative along axis 0: the least value and the largest size."""
    scale = (len(gap) - 1.0) * (len(gap) - 2.0)
    least, most = np.inf, 0.0
    for i in range(len(gap) - 2):
        for j in range(gap.shape[1]):
            second = scale * (gap[i, j] - 2.0 * gap[i + 1, j] + gap[i + 2, j])
            least, most = min(least, second), max(most, abs(second))
    return least, most


@inlined
def twist(gap):
    """Bound of the size of the mixed derivative."""
    most = 0.0
    for i in range(gap.shape[0] - 1):
        for j in range(gap.shape[1] - 1):
            most = max(most, abs(gap[i + 1, j + 1] - gap[i + 1, j] - gap[i, j + 1] + gap[i, j]))
    return most * (gap.shape[0] - 1) * (gap.shape[1] - 1)


@compiled
def doubtful_axis(gap, least, noise):
    """The axis to halve, or -1 if the polynomial is convex or nowhere negative, by its coefficients."""
    if least >= -noise:
        return -1
    gap = lowest_edge(lowest_edge(gap[:, :]).T).T  # strides of any kind: one type for the compiler
    least_u, most_u = second_derivatives(gap)
    least_v, most_v = second_derivatives(gap.T)
    least_u, least_v, mixed = least_u + noise, least_v + noise, twist(gap)
    if least_u >= 0.0 and least_v >= 0.0 and (mixed == 0.0 or least_u * least_v >= mixed * mixed):
        return -1
    return 0 if most_u >= most_v else 1


@compiled
def halve(first, second):
    """Both halves of a net along its axis 0, the net itself coming in ``first`` (de Casteljau)."""
    count, columns = first.shape
    for c in range(columns):
        for k in range(count):
            second[k, c] = first[k, c]
        for k in range(count):
            first[k, c] = second[0, c]
            for i in range(count - 1 - k):
                second[i, c] = 0.5 * (second[i, c] + second[i + 1, c])


@compiled
def bernstein(degree, t, table):
    """The Bernstein polynomials at t and their first two derivatives, into ``table (3, degree + 1)``."""
    table[:] = 0.0
    values = table[0]
    values[0] = 1.0
    for d in range(degree):
        if d == degree - 2:
            for i in range(d + 1):
                second = degree * (degree - 1) * values[i]
                table[2, i] += second
                table[2, i + 1] -= 2.0 * second
                table[2, i + 2] += second
        if d == degree - 1:
            for i in range(d + 1):
                table[1, i] -= degree * values[i]
                table[1, i + 1] += degree * values[i]
        carried = 0.0
        for i in range(d + 1):
            value = values[i]
            values[i] = carried + (1.0 - t) * value
            carried = t * value
        values[d + 1] = carried
