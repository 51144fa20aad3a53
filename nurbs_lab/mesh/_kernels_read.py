"""Hot loops over the bytes of mesh files."""

import numpy as np
from numba import njit

NEWLINE, MINUS, SLASH, ZERO = (np.uint8(ord(sign)) for sign in "\n-/0")
VERTEX = np.uint8(ord("v"))
ELEMENTS = np.frombuffer(b"flp", np.uint8)
BLANKS = np.frombuffer(b" \t\r", np.uint8)


@njit(cache=True, nogil=True)
def unused_vertices(text):
    """Number of vertices of an OBJ file, and how many of them no face, line or point uses.

    A corner is a number from 1, or from -1 backwards. The first result is -1 if a corner is no such number.
    """
    most = text.size // 2  # vertices, for each takes a line
    used = np.zeros(2 * most + 1, np.bool_)  # by number; negative ones count from the end, as in the file
    vertices = largest = i = 0
    while i < text.size:
        first = text[i]
        i += 1
        blank = i < text.size and text[i] in BLANKS
        if blank and first == VERTEX:
            vertices += 1
        while blank and first in ELEMENTS and i < text.size and text[i] != NEWLINE:
            if text[i] in BLANKS:
                i += 1
                continue
            sign = -1 if text[i] == MINUS else 1
            i += sign < 0
            number = 0
            while i < text.size and ZERO <= text[i] < ZERO + 10 and number <= most:
                number = 10 * number + np.int64(text[i] - ZERO)
                i += 1
            if i < text.size and text[i] == SLASH and number > 0:
                while i < text.size and text[i] != NEWLINE and text[i] not in BLANKS:
                    i += 1
            ended = i == text.size or text[i] == NEWLINE or text[i] in BLANKS
            if not ended or not 0 < number <= most:
                return -1, 0
            used[sign * number] = True
            largest = max(largest, number)
        while i < text.size and text[i] != NEWLINE:
            i += 1
        i += 1
    if largest > vertices:
        return -1, 0
    unused = 0
    for number in range(1, vertices + 1):
        unused += not (used[number] or used[number - vertices - 1])
    return vertices, unused
