"""Subroutines, conditions and loops of RS274/NGC: which line of a program comes next."""

import re
from dataclasses import dataclass, field

from nurbs_lab.interchange._gcode_words import Parameters, Scanner, evaluated, shown

O_WORD = re.compile(r"(?:N\d+\s*)?O\s*(?:<([^<>]*)>|(\d{1,9}))\s*([A-Z]*)\s*(.*)")
#: Word that opens a block -> the words that go on with it, the last of which closes it.
BLOCKS = {
    "SUB": ("ENDSUB",),
    "IF": ("ELSEIF", "ELSE", "ENDIF"),
    "WHILE": ("ENDWHILE",),
    "DO": ("WHILE",),
    "REPEAT": ("ENDREPEAT",),
}
LOOPS = ("WHILE", "DO", "REPEAT")
MOST_BLOCKS = 1_000_000  # that are run more often than they are written
MOST_CALLS = 100  # of subroutines within one another
LOCAL = 30  # parameters from 1 up to this belong to their subroutine


@dataclass
class Frame:
    """A call: where it returns to, what it hides, and how often its loops still repeat."""

    place: int
    hidden: dict
    left: dict = field(default_factory=dict)


class Flow:
    """The place of a controller in a program.

    Attributes
    ----------
    parameters : Parameters
    place : int
        Number of the next line, from 0.
    """

    def __init__(self, lines):
        self.lines, self.parameters, self.place = lines, Parameters(), 0
        self.words, self.partners, self.loops, self.subs = {}, {}, {}, {}
        self.frames, self.left = [Frame(len(lines), {})], MOST_BLOCKS + len(lines)
        for place, line in enumerate(lines):
            if line[:1] in "ON" and (found := O_WORD.match(line)) and found[3]:
                name, number, word, rest = found.groups()
                name = re.sub(r"\s", "", name) if name else str(int(number))
                self.words[place] = name, word, rest
        self._pair()

    def _pair(self):
        """Each line of a block knows the next, and the last of a loop its first."""
        open_blocks = []
        for place, (name, word, _) in self.words.items():
            last = open_blocks[-1] if open_blocks else (None, None, place)
            if name == last[0] and word in BLOCKS[last[1]]:
                self.partners[last[2]] = place
                if word == BLOCKS[last[1]][-1]:
                    open_blocks.pop()
                    self.partners[place] = last[3]
                else:
                    open_blocks[-1] = (name, last[1], place, last[3])
            elif word in BLOCKS:
                open_blocks.append((name, word, place, place))
                if word == "SUB":
                    self.subs[name] = place
            elif word in ("BREAK", "CONTINUE"):
                loops = (
                    block[3] for block in reversed(open_blocks) if block[0] == name and block[1] in LOOPS
                )
                self.loops[place] = next(loops, None)
            elif word not in ("CALL", "RETURN"):
                self._refuse(place, "goes on with no block that is open")
        if open_blocks:
            self._refuse(open_blocks[-1][3], "is never closed")

    def _refuse(self, place, why):
        raise ValueError(f"line {place + 1}: {shown(self.lines[place])} {why}; mend it")

    def follow(self):
        """Take the line here, if it is one of these words, and go to the next; whether it was one."""
        self.left -= 1
        if self.left < 0:
            raise ValueError(
                f"more than {MOST_BLOCKS:,} blocks are repeated; end its loops, or give the moves themselves"
            )
        if self.place not in self.words:
            return False
        place, (name, word, rest) = self.place, self.words[self.place]
        self.place += 1
        getattr(self, f"_{word.lower()}")(place, name, rest)
        return True

    def _values(self, rest):
        scanner, values = Scanner(rest), []
        while not scanner.at_end():
            scanner.expect("[")
            scanner.at -= 1
            values.append(evaluated(scanner.value(), self.parameters))
        return values

    def _holds(self, place, rest):
        values = self._values(rest)
        if len(values) != 1:
            self._refuse(place, "needs one value in brackets")
        return values[0]

    def _past(self, place):
        """To the line after the block that is open here."""
        while self.partners[place] > place:
            place = self.partners[place]
        self.place = place + 1

    def _if(self, place, name, rest):
        while not self._holds(place, rest):
            place = self.partners[place]
            self.place = place + 1
            _, word, rest = self.words[place]
            if word in ("ELSE", "ENDIF"):
                return

    def _elseif(self, place, name, rest):  # reached from the branch before it
        self._past(place)

    _else = _elseif

    def _endif(self, place, name, rest):
        pass

    _do = _endif

    def _while(self, place, name, rest):
        holds, partner = self._holds(place, rest), self.partners[place]
        if partner < place:  # the end of a do
            self.place = partner + 1 if holds else self.place
        elif not holds:
            self.place = partner + 1

    def _endwhile(self, place, name, rest):
        self.place = self.partners[place]

    def _repeat(self, place, name, rest):
        left = self.frames[-1].left
        left[place] = left[place] - 1 if place in left else int(self._holds(place, rest))
        if left[place] <= 0:
            del left[place]
            self.place = self.partners[place] + 1

    _endrepeat = _endwhile

    def _break(self, place, name, rest):
        start = self._loop(place)
        self.frames[-1].left.pop(start, None)
        self._past(start)

    def _continue(self, place, name, rest):
        self.place = self.partners[self._loop(place)]

    def _loop(self, place):
        start = self.loops[place]
        return self._refuse(place, "is in no loop of that name") if start is None else start

    def _sub(self, place, name, rest):
        self.place = self.partners[place] + 1

    def _call(self, place, name, rest):
        if name not in self.subs:
            self._refuse(place, "calls a subroutine of another file; put it into this one")
        if len(self.frames) > MOST_CALLS:
            self._refuse(place, f"calls more than {MOST_CALLS} subroutines within one another")
        values = self._values(rest)
        local = [key for key in self.parameters if _is_local(key)]
        self.frames.append(Frame(self.place, {key: self.parameters.pop(key) for key in local}))
        self.parameters.update({float(i): value for i, value in enumerate(values, start=1)})
        self.place = self.subs[name] + 1

    def _endsub(self, place, name, rest):
        values = self._values(rest)
        frame = self.frames.pop() if len(self.frames) > 1 else self._refuse(place, "ends no call")
        for key in [key for key in self.parameters if _is_local(key)]:
            del self.parameters[key]
        self.parameters.update(frame.hidden)
        if values:
            self.parameters["_VALUE"] = values[0]
        self.place = frame.place

    _return = _endsub


def _is_local(key):
    return not key.startswith("_") if isinstance(key, str) else 1 <= key <= LOCAL
