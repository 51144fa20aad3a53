"""The words of a program: every dialect as rows of one letter and one number, found in a few passes.

What a dialect writes with more letters becomes a small letter: ``BSPLINE`` b, ``SD=`` d, ``PL=`` l, ``PW=``
w, a block of Heidenhain's ``SPL`` s, its ``FMAX`` m, and its nine ``K3X`` to ``K1Z`` the letters of POWERS.
"""

import re
from dataclasses import dataclass

import numpy as np

POWERS = dict(zip((f"K{k}{axis}" for axis in "XYZ" for k in (3, 2, 1)), "cefghijkn", strict=True))
WORD = rb"[A-Za-z][ \t]*[-+]?(?:\d+\.?\d*|\.\d+)"
REFUSED = (  # what a program may hold, and plain moves cannot
    (rb"#", "a variable", "give its number"),
    (rb"\[", "an expression", "give its number"),
    (rb"\bO[ \t]*(?:<|\d+[ \t]*[A-Z])", "a subroutine or a condition", "write its moves out"),
    (
        rb"\b(?:CALL|REPEAT|IF|WHILE|GOTO\w*|LBL|CYCL|PROC|DEF)\b",
        "a subroutine or a condition",
        "write its moves out",
    ),
    (rb"^[ \t]*/", "an optional block", "take the block or its '/' out"),
)


@dataclass(frozen=True)
class Words:
    """Letters and numbers, in order, and where their blocks begin."""

    letters: np.ndarray
    numbers: np.ndarray
    #: Number of the first word of every block, and one more at the end.
    first: np.ndarray
    #: Line of every block, counted from 1.
    lines: np.ndarray
    #: Units of the head of a program of Heidenhain, which count its feed in tenths where they are inches.
    head: str | None
    #: Whether the last line is the end of a tape or of a program of Heidenhain.
    ended: bool

    def plain_runs(self):
        """For every block, the end of the run of plain blocks that it begins; itself if it is not plain.

        A plain block holds nothing but G0 to G3, X, Y, Z, I, J, K, R, F and N, each once.
        """
        letters, numbers, first = self.letters, self.numbers, self.first
        if len(first) < 2:
            raise ValueError("it holds no block of a program")
        kept = np.isin(letters, np.frombuffer(b"XYZIJKRN", np.uint8))
        kept |= (letters == ord("G")) & np.isin(numbers, (0, 1, 2, 3))
        kept |= (letters == ord("F")) & (numbers > 0)
        plain = np.logical_and.reduceat(kept, first[:-1])
        for letter in b"XYZIJKRFNG":
            plain &= np.add.reduceat(letters == letter, first[:-1]) <= 1
        breaks = np.r_[np.flatnonzero(~plain), len(plain)]
        return breaks[np.searchsorted(breaks, np.arange(len(plain)))]


def words_of(data):
    """Split the bytes of a program; ValueError names the line and the word that is none."""
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").upper()
    text = re.sub(rb"\([^()\n]*\)|;[^\n]*", b"", text)
    for pattern, what, cure in REFUSED:
        if found := re.search(pattern, text, re.MULTILINE):
            word = _shown(text[found.start() :].split(b"\n")[0])
            raise ValueError(f"line {_line(text, found.start())}: {word} is {what}; {cure}")
    ended = text.rstrip().rpartition(b"\n")[2].strip().startswith(b"%") or b"END PGM" in text
    text = re.sub(rb"^[ \t]*%[^\n]*", b"", text, flags=re.MULTILINE)
    heidenhain = b"BEGIN PGM" in text
    head = None
    if heidenhain:
        head = "inch" if re.search(rb"BEGIN PGM [^\n]*\bINCH\b", text) else "mm"
    text = _heidenhain(text) if heidenhain else _siemens(text)
    if left := re.search(rb"\S", rest := re.sub(WORD, b"", text)):
        line = _line(rest, left.start())
        word = _shown(text.replace(b"\v", b"\n").split(b"\n")[line - 1])
        raise ValueError(
            f"line {line}: {word} is no row of words, each a letter and a number; mend or remove it"
        )
    codes = np.frombuffer(text, dtype=np.uint8)
    places = np.flatnonzero((codes | 32) - ord("a") < 26)
    ends = np.flatnonzero(codes == ord("\n"))
    block = np.searchsorted(ends, places)
    first = np.flatnonzero(np.r_[True, np.diff(block) > 0]) if places.size else np.zeros(0, dtype=int)
    numbers = np.array(re.sub(rb"[A-Za-z]", b" ", text).split(), dtype=np.float64)
    lines = 1 + np.searchsorted(np.flatnonzero((codes == ord("\n")) | (codes == ord("\v"))), places[first])
    if far := np.flatnonzero(~np.isfinite(numbers)).tolist():
        line = lines[np.searchsorted(first, far[0], side="right") - 1]
        raise ValueError(f"line {line}: a number is too large to be one; mend it")
    return Words(codes[places], numbers, np.r_[first, len(places)], lines, head, ended)


def _siemens(text):
    if b"BSPLINE" in text:
        names = {b"BSPLINE": b"b0", b"SD=": b"d", b"PL=": b"l", b"PW=": b"w"}
        for word, letter in names.items():
            text = text.replace(word, letter)
    return text


def _heidenhain(text):
    """Blocks without their numbers, which are evenly spaced; the next line goes on where one ends in ~."""
    text = text.replace(b"~\n", b"\v")
    blocks = list(re.finditer(rb"^[ \t]*(?=\S)(\d*)", text, re.MULTILINE))
    steps = np.diff([int(block[1] or -1) for block in blocks])
    if wrong := np.flatnonzero(steps != steps[:1]).tolist():
        line = _line(text, blocks[wrong[0] + 1].start())
        raise ValueError(f"line {line}: its number does not follow the last; a block is missing or doubled")
    text = re.sub(rb"^[ \t]*\d+ +(?:(?:BEGIN|END) PGM [^\n]*)?", b"", text, flags=re.MULTILINE)
    for word, letter in POWERS.items():
        text = text.replace(word.encode(), letter.encode())
    return re.sub(rb"\bL ", b"G1 ", text.replace(b"FMAX", b"m0")).replace(b"SPL ", b"s0 ")


def _line(text, place):
    return 1 + text.count(b"\n", 0, place) + text.count(b"\v", 0, place)


def _shown(line):
    text = line.decode("latin-1").strip()
    return repr(text if len(text) <= 40 else text[:40] + "...")


def filled(values, start):
    """Each NaN replaced by the number before it; ``start`` before the first."""
    last = np.maximum.accumulate(np.where(np.isnan(values), -1, np.arange(len(values))))
    return np.where(last < 0, start, values[last])
