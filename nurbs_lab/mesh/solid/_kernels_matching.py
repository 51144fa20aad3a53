"""Largest matching of a graph: Edmonds' blossom algorithm, on plain arrays."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def common_base(mate, base, parent, a, b, seen):
    """Lowest common ancestor of two even nodes in the alternating tree."""
    seen[:] = False
    while True:
        a = base[a]
        seen[a] = True
        if mate[a] < 0:
            break
        a = parent[mate[a]]
    while True:
        b = base[b]
        if seen[b]:
            return b
        b = parent[mate[b]]


@njit(cache=True, nogil=True)
def mark_path(mate, base, parent, blossom, v, root, child):
    """Mark the nodes of a blossom on the way from v to its base."""
    while base[v] != root:
        blossom[base[v]] = blossom[base[mate[v]]] = True
        parent[v] = child
        child = mate[v]
        v = parent[mate[v]]


@njit(cache=True, nogil=True)
def complete_matching(first, neighbours, mate):
    """Augment the matching ``mate`` (-1 for none) in place until it is as large as it can be.

    One search for each node without a mate; a search visits every node once (Edmonds' blossoms).
    """
    n = len(mate)
    parent, base = np.empty(n, np.int64), np.empty(n, np.int64)
    used, blossom, seen = np.empty(n, np.bool_), np.empty(n, np.bool_), np.empty(n, np.bool_)
    queue = np.empty(n, np.int64)
    for root in range(n):
        if mate[root] >= 0:
            continue
        used[:] = False
        parent[:] = -1
        base[:] = np.arange(n)
        used[root] = True
        queue[0], low, high = root, 0, 1
        end = -1
        while low < high and end < 0:
            v = queue[low]
            low += 1
            for k in range(first[v], first[v + 1]):
                to = neighbours[k]
                if base[v] == base[to] or mate[v] == to:
                    continue
                if to == root or (mate[to] >= 0 and parent[mate[to]] >= 0):
                    joint = common_base(mate, base, parent, v, to, seen)
                    blossom[:] = False
                    mark_path(mate, base, parent, blossom, v, joint, to)
                    mark_path(mate, base, parent, blossom, to, joint, v)
                    for i in range(n):
                        if blossom[base[i]]:
                            base[i] = joint
                            if not used[i]:
                                used[i] = True
                                queue[high] = i
                                high += 1
                elif parent[to] < 0:
                    parent[to] = v
                    if mate[to] < 0:
                        end = to
                        break
                    used[mate[to]] = True
                    queue[high] = mate[to]
                    high += 1
        while end >= 0:
            before = parent[end]
            after = mate[before]
            mate[end], mate[before] = before, end
            end = after
