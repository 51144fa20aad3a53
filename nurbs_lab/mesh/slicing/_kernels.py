"""Hot loops of the slicer, on plain arrays. The faces validate; nothing here does.

Half-edge ``3 f + e`` runs from corner e of triangle f to its next corner.
"""

from math import ceil

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined

LINES = 8  # across a contour, which show whether it is inside another


@inlined
def planes_below(heights, z, guess):
    """Number of planes at or below ``z``; the guess is tried first."""
    if (guess == 0 or heights[guess - 1] <= z) and (guess == len(heights) or z < heights[guess]):
        return guess
    low, high = 0, len(heights)
    while low < high:
        middle = (low + high) // 2
        if heights[middle] <= z:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def vertex_levels(z, heights, level):
    """Number of planes at or below every vertex, so that vertex v is above plane k when ``level[v] > k``."""
    planes = len(heights)
    span = heights[-1] - heights[0]
    scale = (planes - 1) / span if span > 0.0 else 0.0
    for v in range(len(z)):  # the guess is right where the heights are even
        guess = min(max(1.0 + (z[v] - heights[0]) * scale, 0.0), planes)
        level[v] = planes_below(heights, z[v], int(guess))


@compiled
def crossed_in_block(corners, normal, heights):
    """Triangles of a block of a file that planes cross, the first plane of each; a sum of all coordinates."""
    found, first = np.empty(len(corners), np.int64), np.empty(len(corners), np.int32)
    count, low, total = 0, 0, 0.0
    for f in range(len(corners)):
        least, most = np.inf, -np.inf
        for v in range(3):
            x, y, z = np.float64(corners[f, v, 0]), np.float64(corners[f, v, 1]), np.float64(corners[f, v, 2])
            height = x * normal[0] + y * normal[1] + z * normal[2]  # the bits of `in_frame`
            least, most, total = min(least, height), max(most, height), total + height
        low = planes_below(heights, least, low)
        if low < len(heights) and heights[low] <= most:
            found[count], first[count] = f, low
            count += 1
    return found[:count], first[:count], total


@compiled
def count_crossings(triangles, junk, level, planes):
    """Step 1, the prescreen: the triangles that planes cross, and how many each of these crosses."""
    many = np.zeros(planes, np.int64)
    crossed = np.empty(len(triangles), np.int32)
    count = 0
    for f in range(len(triangles)):
        a, b, c = level[triangles[f, 0]], level[triangles[f, 1]], level[triangles[f, 2]]
        low, high = min(a, b, c), max(a, b, c)
        if low < high and not junk[f]:
            crossed[count] = f
            count += 1
            for k in range(low, high):
                many[k] += 1
    return crossed[:count], many


@compiled
def place_crossings(triangles, crossed, level, place, crossing):
    """Write each crossed triangle at the next place of every plane across it."""
    for f in crossed:
        a, b, c = level[triangles[f, 0]], level[triangles[f, 1]], level[triangles[f, 2]]
        for k in range(min(a, b, c), max(a, b, c)):
            crossing[place[k]] = f
            place[k] += 1


@inlined
def crossed_edges(triangles, xyz, f, height):
    """The two crossed edges of a triangle: first the one that falls in its winding, then the one that rises.

    Entering by the falling edge keeps the material on the left. The corner that is alone on its side names
    both: they are its edges to the next corner and to the one before.
    """
    a = xyz[triangles[f, 0], 2] >= height
    b = xyz[triangles[f, 1], 2] >= height
    c = xyz[triangles[f, 2], 2] >= height
    lone, up = (2, c) if a == b else ((1, b) if a == c else (0, a))
    before = lone - 1 if lone else 2
    return (lone, before) if up else (before, lone)


@inlined
def crossing_point(xyz, low, high, height, out, at):
    """Eq. (3), always computed from the lower end, so that both triangles of an edge get the same bits."""
    bottom, top = xyz[low, 2], xyz[high, 2]
    if top == height:
        out[at, 0], out[at, 1] = xyz[high, 0], xyz[high, 1]
    else:
        t = (height - bottom) / (top - bottom)
        out[at, 0] = xyz[low, 0] + t * (xyz[high, 0] - xyz[low, 0])
        out[at, 1] = xyz[low, 1] + t * (xyz[high, 1] - xyz[low, 1])


@compiled
def first_of_loop(points):
    """Index of the least point of a closed contour, where it starts for any order of the triangles."""
    n = len(points)
    best = 0
    for i in range(1, n):
        if points[i, 0] > points[best, 0]:
            continue
        for step in range(2):
            (x, y), (u, v) = points[(i + step) % n], points[(best + step) % n]
            if x != u or y != v:
                if x < u or (x == u and y < v):
                    best = i
                break
    return best


@compiled
def trace_contour(half, graph, height, stamp, mark, track, carried):
    """Follow one contour from a crossed half-edge into the track: ``(number of points, closed)``.

    Every step meets one new vertex: it replaces the end of the crossed edge that lies on its own side, and
    the opposite half-edge (the weight of Eq. (1)) says by which edge the next triangle is entered. No
    triangle is entered twice, so there are at most as many steps as triangles.
    """
    triangles, opposite, xyz = graph
    f, entry = half // 3, half % 3
    low, high = triangles[f, entry], triangles[f, entry + 1 if entry < 2 else 0]
    if xyz[low, 2] >= height:
        low, high = high, low
    n = 0
    while half >= 0 and mark[half // 3] != stamp:
        f, entry = half // 3, half % 3
        mark[f] = stamp
        crossing_point(xyz, low, high, height, track, n)
        if n == 0 or track[n, 0] != track[n - 1, 0] or track[n, 1] != track[n - 1, 1]:
            n += 1
        carried[n - 1] = f
        corner = entry - 1 if entry else 2
        new = triangles[f, corner]
        if xyz[new, 2] >= height:
            high = new
            kept = low
        else:
            low = new
            kept = high
        leave = corner if triangles[f, entry] == kept else (entry + 1 if entry < 2 else 0)
        half = opposite[3 * f + leave]
    closed = half >= 0
    if not closed:
        crossing_point(xyz, low, high, height, track, n)
        if track[n, 0] != track[n - 1, 0] or track[n, 1] != track[n - 1, 1]:
            n += 1
    elif n > 1 and track[0, 0] == track[n - 1, 0] and track[0, 1] == track[n - 1, 1]:
        n -= 1
    return n, closed


@compiled
def walk(triangles, opposite, xyz, heights, offsets, crossing, has_ends):
    """Steps 2 and 3: traverse the crossed triangles of every plane by the weights.

    Returns points, the triangle that carries the segment after each point, and for every contour where it
    begins, its plane and whether it is closed; and for every plane how many contours collapsed to a point or
    an edge.
    """
    mark = np.full(len(triangles), -1, np.int32)
    total = len(crossing)
    room = 2 * total if has_ends else total
    points = np.empty((room, 2))
    carriers = np.empty(room, np.int32)
    track = np.empty((total + 1, 2))
    carried = np.empty(total + 1, np.int32)
    begins = np.empty(total + 1, np.int64)
    plane = np.empty(total, np.int32)
    closed = np.empty(total, np.bool_)
    collapsed = np.zeros(len(heights), np.int64)
    filled, count = 0, 0
    for k in range(len(heights)):
        for look in range(0 if has_ends else 2, 3):  # from falling ends, from rising ends, loops
            for i in range(offsets[k], offsets[k + 1]):
                f = crossing[i]
                if mark[f] == k:
                    continue
                falling, rising = crossed_edges(triangles, xyz, f, heights[k])
                half = 3 * f + (rising if look == 1 else falling)
                if look < 2 and opposite[half] >= 0:
                    continue
                n, loop = trace_contour(half, (triangles, opposite, xyz), heights[k], k, mark, track, carried)
                if n < (3 if loop else 2):
                    collapsed[k] += 1
                    continue
                shift = first_of_loop(track[:n]) if loop else 0
                begins[count], plane[count], closed[count] = filled, k, loop
                count += 1
                for i in range(shift, shift + n):
                    at = i - n if i >= n else i
                    points[filled, 0], points[filled, 1] = track[at, 0], track[at, 1]
                    carriers[filled] = carried[at]
                    filled += 1
    begins[count] = filled
    return points[:filled], carriers[:filled], begins[: count + 1], plane[:count], closed[:count], collapsed


@compiled
def signed_area(points):
    """Shoelace about the first point: positive when counter-clockwise."""
    x, y = points[0]
    twice = 0.0
    for i in range(1, len(points) - 1):
        twice += (points[i, 0] - x) * (points[i + 1, 1] - y) - (points[i + 1, 0] - x) * (points[i, 1] - y)
    return twice / 2.0


@compiled
def extent(points):
    """The least and the largest x, and the least and the largest y."""
    least_x = most_x = points[0, 0]
    least_y = most_y = points[0, 1]
    for i in range(1, len(points)):
        least_x, most_x = min(least_x, points[i, 0]), max(most_x, points[i, 0])
        least_y, most_y = min(least_y, points[i, 1]), max(most_y, points[i, 1])
    return least_x, most_x, least_y, most_y


@compiled
def cut_by_lines(points, low, spacing, apart, cuts, n):
    """Where a contour crosses lines at ``low + k * spacing`` laid end to end: x, and ``k * apart`` more.

    The cuts are written from place ``n`` on; returns their end.
    """
    x, at = points[-1, 0], (points[-1, 1] - low) / spacing
    for i in range(len(points)):
        before, start, x, at = x, at, points[i, 0], (points[i, 1] - low) / spacing
        first, stop = ceil(min(max(min(start, at), 0.0), LINES)), ceil(min(max(start, at, 0.0), LINES))
        for k in range(first, stop):
            cuts[n] = k * apart + before + (k - start) / (at - start) * (x - before)
            n += 1
    return n


@compiled
def lies_within(cuts, mine):
    """Whether the first ``mine`` cuts enclose what the others do, but for half a line of all."""
    order = np.argsort(cuts, kind="mergesort")
    inside = around = False
    outside = whole = last = 0.0
    for i in order:
        length = cuts[i] - last
        if inside:
            whole += length
            if not around:
                outside += length
        if i < mine:
            inside = not inside
        else:
            around = not around
        last = cuts[i]
    return 2.0 * LINES * outside < whole


@compiled
def nest(points, begins, plane, closed, nonzero):
    """Area, depth and parent (-1: none) of every contour, and which have material on both sides.

    Contours of one plane follow one another. ``nonzero`` chooses the rule of winding numbers. Those that may
    be around a contour come before it: the larger ones, and of equal ones the first.
    """
    count, longest, least, most = len(plane), 0, np.inf, -np.inf
    area, smallness, box = np.zeros(count), np.zeros(count), np.zeros((count, 4))
    for c in range(count):
        if closed[c]:
            loop = points[begins[c] : begins[c + 1]]
            area[c] = signed_area(loop)
            smallness[c] = -abs(area[c])
            box[c, 0], box[c, 1], box[c, 2], box[c, 3] = extent(loop)
            longest, least, most = max(longest, len(loop)), min(least, box[c, 0]), max(most, box[c, 1])
    depth, parent = np.zeros(count, np.int32), np.full(count, -1, np.int32)
    left_out, cuts = np.zeros(count, np.bool_), np.empty(2 * LINES * longest)
    start = 0
    while start < count:
        stop = start
        while stop < count and plane[stop] == plane[start]:
            stop += 1
        order = np.argsort(smallness[start:stop], kind="mergesort")
        for rank in range(1, stop - start):
            c = start + order[rank]
            spacing = (box[c, 3] - box[c, 2]) / LINES  # 0 for an open contour
            low = box[c, 2] + 0.5 * spacing
            winding = mine = 0
            for larger in order[: rank if spacing > 0.0 else 0]:
                o = start + larger
                beside = box[o, 0] > box[c, 1] or box[o, 1] < box[c, 0]
                if beside or box[o, 2] > box[c, 3] or box[o, 3] < box[c, 2] or not closed[o]:
                    continue
                if mine == 0:
                    loop = points[begins[c] : begins[c + 1]]
                    mine = cut_by_lines(loop, low, spacing, most - least, cuts, mine)
                loop = points[begins[o] : begins[o + 1]]
                end = cut_by_lines(loop, low, spacing, most - least, cuts, mine)
                if lies_within(cuts[:end], mine):
                    winding += 1 if area[o] > 0.0 else -1
                    if not left_out[o]:
                        depth[c] += 1
                        parent[c] = o
            left_out[c] = nonzero and winding != 0 and winding + (1 if area[c] > 0.0 else -1) != 0
        start = stop
    return area, depth, parent, left_out
