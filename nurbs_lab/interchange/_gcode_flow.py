"""Subroutines, conditions and loops of RS274/NGC: which line of a program comes next."""

import re
from collections import defaultdict

from nurbs_lab.interchange._gcode_words import FANUC, Parameters, arguments_of, shown

O_WORD = re.compile(r"(?:N\d+\s*)?[O:]\s*(?:<([^<>]*)>|(\d{1,9})(?![\d.]))\s*([A-Z]*)\s*(.*)")
#: Word that opens a block -> the words that go on with it, the last of which closes it.
BLOCKS = {
    "SUB": ("ENDSUB",),
    "IF": ("ELSEIF", "ELSE", "ENDIF"),
    "WHILE": ("ENDWHILE",),
    "DO": ("WHILE",),
    "REPEAT": ("ENDREPEAT",),
}
ONE_VALUE = ("IF", "ELSEIF", "WHILE", "REPEAT", "GOTO")
MOST_BLOCKS = 1_000_000  # that are run more often than they are written
MOST_CALLS = 100  # of subroutines within one another
LOCAL = 30  # parameters from 1 up to this belong to their subroutine


class Flow:
    """The place of a controller in a program: ``place`` is the number of the next line, from 0."""

    def __init__(self, lines):
        self.lines, self.parameters, self.place = lines, Parameters(), 0
        self.words, self.partners, self.loops, self.subs, self.programs = {}, {}, {}, {}, {}
        self.labels = defaultdict(list)
        #: Calls: where they return to, the parameters that they hide, and how often their loops still repeat.
        self.frames, self.left = [(len(lines), None, {})], MOST_BLOCKS + len(lines)
        for place, line in enumerate(lines):
            if line[:1] in "ON:" and (found := O_WORD.match(line)):
                name, number, word, rest = found.groups()
                name = str(int(number)) if number else re.sub(r"\s", "", name)
                if word:
                    self.words[place] = name, word, rest
                else:
                    self.programs[name] = place
            elif line[:1] == "O" and self.words:
                self._refuse(place, "is no line of o-words")
        self.parameters.fanuc = FANUC if self.programs else {}
        self.unread = set(self.programs.values())  # places of programs that nothing has called
        self._pair()

    def _pair(self):
        """Each line of a block knows the next, and the last of a loop its first."""
        names, blocks = {}, []  # that are open: name, word, place of the last line and of the first
        for place, (name, word, rest) in self.words.items():
            if rest.strip() and word not in (*ONE_VALUE, "CALL", "RETURN", "ENDSUB"):
                self._refuse(place, f"has more than {word}")
            try:
                count = len(arguments_of(rest))
            except ValueError as error:
                raise ValueError(f"line {place + 1}: {error}") from None
            if word in ONE_VALUE and count != 1:
                self._refuse(place, "needs one value in brackets")
            opened, kind, last, first = blocks[-1] if blocks else (None, None, place, place)
            if name == opened and word in BLOCKS[kind]:
                self.partners[last] = place
                blocks[-1] = name, kind, place, first
                if word == BLOCKS[kind][-1]:
                    blocks.pop()
                    self.partners[place] = first
            elif word in BLOCKS:
                blocks.append((name, word, place, place))
                if names.setdefault(name, place) != place and name[:2] != "DO":  # of Fanuc's DO1
                    self._refuse(place, f"has the name of line {names[name] + 1}")
                if word == "SUB" and blocks[1:]:
                    self._refuse(place, "is within a block")
            elif word in ("BREAK", "CONTINUE"):
                loops = [block[3] for block in blocks if block[0] == name and block[1] not in ("SUB", "IF")]
                self.loops[place] = loops[-1] if loops else self._refuse(place, "is in no loop of that name")
            elif word not in ("CALL", "RETURN", "GOTO"):
                self._refuse(place, "goes on with no block that is open")
        if blocks:
            self._refuse(blocks[-1][3], "is never closed")

    def _refuse(self, place, why):
        raise ValueError(f"line {place + 1}: {shown(self.lines[place])} {why}; mend it")

    def follow(self):
        """Take the line here, if it is one of these words, and go to the next; whether it was one."""
        self.left -= 1
        if self.left < 0:
            raise ValueError(f"more than {MOST_BLOCKS:,} blocks are repeated; end its loops")
        self.unread.discard(self.place)
        if self.place not in self.words:
            return False
        place, (name, word, rest) = self.place, self.words[self.place]
        partner, repeats = self.partners.get(place), self.frames[-1][2]
        self.place += 1
        match word:
            case "IF":
                while word not in ("ELSE", "ENDIF") and not self._values(rest)[0]:
                    place = self.partners[place]
                    self.place = place + 1
                    _, word, rest = self.words[place]
            case "ELSEIF" | "ELSE":  # reached from the branch before it
                self._past(place)
            case "WHILE":
                if bool(self._values(rest)[0]) == (partner < place):
                    self.place = partner + 1  # the end of a do that goes on, or a while that ends
            case "ENDWHILE" | "ENDREPEAT":
                self.place = partner
            case "CONTINUE":  # at the last line of its loop
                self.place = self.partners[self.loops[place]]
            case "REPEAT":
                repeats[place] = repeats[place] - 1 if place in repeats else int(self._values(rest)[0])
                if repeats[place] <= 0:
                    del repeats[place]
                    self.place = partner + 1
            case "BREAK":
                repeats.pop(self.loops[place], None)
                self._past(self.loops[place])
            case "SUB":
                self.subs[name], self.place = place, partner + 1
            case "CALL":
                self._call(place, name, self._values(rest))
            case "ENDSUB" | "RETURN":
                self._return(place, self._values(rest))
            case "GOTO" if self._values(rest)[0]:
                if partner is None:
                    self.partners[place] = self._labelled(place, name)
                self.place = self.partners[place]
        return True

    def _values(self, rest):
        return [value(self.parameters) for value in arguments_of(rest)]

    def _past(self, place):
        """To the line after the block that is open here."""
        while self.partners[place] > place:
            place = self.partners[place]
        self.place = place + 1

    def _labelled(self, place, number):
        """The block N of that number in the same program, the next one, or else the first."""
        if not self.labels:
            for i, line in enumerate(self.lines):
                if found := re.match(r"N(\d+)", line):
                    self.labels[int(found[1])].append(i)
        first = max((i for i in self.programs.values() if i <= place), default=-1)
        last = min((i for i in self.programs.values() if i > place), default=len(self.lines))
        there = [i for i in self.labels[int(number)] if first < i < last]
        if not there:
            self._refuse(place, "goes to a block that is not there")
        return next((i for i in there if i > place), there[0])

    def _call(self, place, name, values):
        if name not in self.subs:
            self._refuse(place, "calls a subroutine of another file; put it into this one, before its call")
        if len(self.frames) > MOST_CALLS:
            self._refuse(place, f"calls more than {MOST_CALLS} subroutines within one another")
        self.frames.append((self.place, self._taken(), {}))
        self.parameters.update({float(i): value for i, value in enumerate(values, start=1)})
        self.place = self.subs[name] + 1

    def _return(self, place, values):
        self.place, hidden, _ = self.frames.pop()
        if hidden is None:
            self._refuse(place, "ends no call")
        self._taken()
        self.parameters.update(hidden)
        self.parameters["_VALUE"] = values[0] if values else 0.0

    def _taken(self):
        """Take the parameters that belong to the subroutine."""
        names = [k for k in self.parameters if (k[:1] != "_" if isinstance(k, str) else k <= LOCAL)]
        return {name: self.parameters.pop(name) for name in names}

    def call_program(self, number, times):
        """M98: the lines from that number on to M99; more than four digits begin with how often."""
        if number > 9999 and str(number) not in self.programs:
            times, number = divmod(number, 10_000)
        number = str(number)
        if number not in self.programs or not 0 <= times <= MOST_CALLS - len(self.frames):
            raise ValueError(f"M98 P{number} calls a program of another file, or too many; write it out")
        self.unread.discard(self.programs[number])
        if times:
            self.frames += [(self.place, None, {})] + (times - 1) * [(self.programs[number], None, {})]
            self.place = self.programs[number]

    def end_program(self):
        """M99: back to behind its call; whether there was none, so that the file ends."""
        if len(self.frames) == 1:
            return True
        self.place, hidden, _ = self.frames.pop()
        if hidden is not None:
            raise ValueError("M99 ends no subroutine of o-words; write its return")
        return False
