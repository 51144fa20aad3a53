"""The order of the items of a tree of boxes."""

import numpy as np
import pytest

from nurbs_lab.common.box_tree import LEAF, morton, order_halved


@pytest.mark.parametrize("count", [1, 4, 5, 33, 1000])
def test_a_plane_across_the_longest_side_parts_the_halves_of_a_node(count):
    places = np.random.default_rng(count).random((count, 3)) * (1.0, 2.0, 3.0)
    places[::3] = places[0]  # many are equal
    order = order_halved(places)
    assert sorted(order.tolist()) == list(range(count))

    def check(some, size):
        if size > LEAF:
            low, high = some[: size // 2], some[size // 2 :]
            if len(high):
                axis = np.ptp(some, axis=0).argmax()
                assert low[:, axis].max() <= high[:, axis].min()
                check(high, size // 2)
            check(low, size // 2)

    check(places[order], LEAF * 2 ** int(np.ceil(np.log2(max(count / LEAF, 1.0)))))


def test_codes_of_cells_interleave_their_bits():
    cells = np.random.default_rng(0).integers(0, 2**20, (50, 3))
    bits = [[f"{value:020b}" for value in cell[::-1]] for cell in cells]
    codes = [int("".join("".join(three) for three in zip(*b, strict=True)), 2) for b in bits]
    assert morton(cells).tolist() == codes
