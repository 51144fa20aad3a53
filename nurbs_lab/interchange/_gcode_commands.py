"""What the words of a block do besides moving: modes, units, offsets, dwells, and how a motion begins."""

from nurbs_lab.interchange import _gcode_table as table
from nurbs_lab.interchange._gcode_shapes import AXES, Shapes, shown_words
from nurbs_lab.interchange._gcode_table import ALL_AXES, PLANES, SYSTEMS, UNITS_OF_PATHS
from nurbs_lab.interchange._gcode_words import shown
from nurbs_lab.interchange._moves import NO_FEED

OTHER_AXES = set("ABCUVWE")
POLAR = set("@^&")
PLACED = set("XxtYyuZzv") | POLAR
TOGETHER = ["rapid", "line"], ["arc", "arc"]  # of Heidenhain: L with FMAX, and C with DR
WITH_AXES = OTHER_AXES | set("FS")  # what a block may hold beside a command that takes its axes
SAVED = table.SETTINGS | {"system", "unit", "feed_length", "feed", "spindle"}  # by M70, for M72


class Commands(Shapes):
    """The commands of a controller, which change its state."""

    def _commands(self, codes, machine, lettered, block):
        """Each command takes its letters; motions come last, as what is left of the block is theirs."""
        self.codes.update(codes)
        placed = not PLACED.isdisjoint(block)
        cycles = self.lathe and not block.keys().isdisjoint("XZxz") and table.OF_LATHES.intersection(codes)
        if cycles and all(table.G_WORDS.get(code, "?")[0] != "motion" for code in codes):
            said = f"G{min(cycles) / 10:g} beside an axis is a cycle of a lathe"
            raise ValueError(f"{said}; write its moves out, or part them if it is none")
        for number in machine:
            self._order(number, block)
        chosen, owned = {}, self.owned
        motions = [motion for code in codes if (motion := self._word(code, block, chosen, owned))]
        names = [*lettered, *(motion for motion, *_ in motions)]
        turns = self.heidenhain and names[len(lettered) :] == ["arc"] != lettered
        if turns or (len(names) > 1 and names not in TOGETHER):
            raise ValueError(
                f"{shown(self.lines[self.line - 1])} moves in two ways, or turns without C or CP"
            )
        if 800 in codes and not motions:
            self._close_spline()
            self._start(self.before if self.motion == "drill" else self.motion)
            self.resumed, chosen["axes"] = self.motion is not None, 800
        drills = not motions or ("unit" in chosen and motions[0][0] == "drill")
        if self.motion == "drill" and drills and "heights" in chosen:
            raise ValueError(
                f"G{chosen['heights'] / 10:g} moves or scales the heights of a cycle; end it by G80"
            )
        for motion, code, letters in motions:
            if both := owned & set(letters):
                raise ValueError(f"its {min(both)} belongs to G{code / 10:g} and to another word; part them")
            if motion and placed and "axes" in chosen:
                both = f"G{chosen['axes'] / 10:g} and G{code / 10:g}"
                raise ValueError(f"{both} cannot share the axes of one block; give each its own")
            if code == 53 and self.motion != "nurbs":
                raise ValueError("G5.3 ends no G5.2; a block is missing")
            self._start(motion)
            self.clockwise = code == 20 if motion == "arc" else self.clockwise
            self.cycle = code // 10
        if "axes" in chosen and (left := block.keys() - WITH_AXES):
            left = shown_words({letter: block[letter] for letter in block if letter in left})
            both = f"{left} is not known beside G{chosen['axes'] / 10:g}"
            raise ValueError(f"{both}; correct or remove it")
        if lettered == ["pole"]:
            self._place_pole(block)
            if block:
                raise ValueError(f"{shown_words(block)} is not known beside CC; correct or remove it")
        elif lettered:
            self._start(lettered[0])

    def _order(self, number, block):
        """Do what an M word says."""
        if number not in table.MACHINE:
            self.left_out[f"M{number:g}", "an order of the builder of the machine, and left out"] += 1
        if self.heidenhain and number == 99 and self.holes:
            self.due = True
        elif why := table.REFUSED_M[self.heidenhain].get(number):
            raise ValueError(f"M{number:g} {why}")
        if self.heidenhain and number in (91, 92):
            self._machine(number, None, {a: block.pop(a) for a in AXES if a in block}, block)
        elif self.heidenhain and number == 140:
            self._machine(number, None, {AXES[PLANES[self.plane][2]]: None}, block)
        if number == 70:
            self.saved = {name: getattr(self, name) for name in SAVED}
        elif number == 72:
            if not self.saved or block:
                raise ValueError("M72 has no M70 before it, or words beside it; mend it")
            vars(self).update(self.saved)
        elif number == 98 and not self.heidenhain:
            if block.keys() & set(ALL_AXES):
                raise ValueError("M98 has an axis beside it; give the call its own block")
            self.flow.call_program(int(block.pop("P", 0)), int(block.pop("L", 1)))
        if number == 99 and "P" in block:
            raise ValueError(f"M99 P{block['P']:g} goes to a block; write GOTO {block['P']:g}")
        if not self.due:
            last = number == 17 and not "".join(self.lines[self.line :]).strip("% ")  # ends one of Siemens
            self.ended |= self.flow.end_program() if number == 99 else last or number in (2, 30)

    def _word(self, code, block, chosen, owned):
        """Do what a G word says, or return its motion; note its group and its letters."""
        if self._is_setting(code, block, owned):
            return None
        kind, value, letters = table.G_WORDS.get(code, ("refused", None, ""))
        if kind in table.GROUPS:
            if kind in chosen:
                said = f"G{chosen[kind] / 10:g} and G{code / 10:g} exclude each other"
                raise ValueError(f"its words {said}; keep one of them")
            chosen[kind] = code
        if kind == "motion":
            return value, code, letters
        taken = {letter: block.pop(letter) for letter in letters if letter in block}
        owned.update(taken)
        if kind in ("unit", "plane", "system", "shift") or (kind == "offset" and value != "tool"):
            chosen["heights"] = code
        if (kind == "offset" and taken) or (kind == "dwell" and "P" not in block) or value == "alone":
            chosen["axes"] = code
        if kind in table.SETTINGS:
            if kind == "per" and value != self.per:
                self.feed = NO_FEED
            elif kind == "per" and self.feed != NO_FEED and "F" not in block:
                self.left_out[f"G{code / 10:g}", "without F, and the feed before it goes on"] += 1
            self.spindle = 0.0 if kind == "surface" else self.spindle
            setattr(self, kind, value)
        elif kind == "note":
            self.left_out[f"G{code / 10:g}", value] += 1
        elif kind not in ("nothing", "path"):
            getattr(self, f"_{kind}")(code, value, taken, block)
        return None

    def _hole(self, code, value, taken, block):
        """A cycle of Siemens or Heidenhain, whose holes are elsewhere; without a value it ends."""
        if not set("RZIL") <= taken.keys():
            raise ValueError(f"G{code / 10:g} is no word that this reader knows; mend it")
        self.holes = value and (value, taken)
        self.due = taken.get("P") == 1

    def _place_pole(self, block):
        """The pole of Heidenhain, which is here if the block names no coordinate of it, and its plane."""
        self.pole = list((block and self.pole) or self.position)
        given = {i for i, axis in enumerate(AXES) if {axis, axis.lower()} & block.keys()}
        self.pole_plane = next((p for p, axes in PLANES.items() if set(axes[:2]) == given), self.plane)
        for k in PLANES[self.pole_plane][:2]:
            if AXES[k] in block:
                self.pole[k] = block.pop(AXES[k]) * self.unit
            elif AXES[k].lower() in block:
                self.pole[k] = self.position[k] + block.pop(AXES[k].lower()) * self.unit

    def _is_setting(self, code, block, owned):
        """Whether G5 or G5.1 of this block is Fanuc's mode and no curve of LinuxCNC."""
        mode = "Q" in block if code == 51 else code == 50 and block.keys() == {"P"}
        if mode:
            self.left_out[f"G{code / 10:g}", "a mode of Fanuc that moves nothing"] += 1
            owned.add(code)
            for letter in "PQR" if code == 50 else "PQRXYZ":
                block.pop(letter, None)
        return mode

    def _refused(self, code, value, taken, block):
        why = table.REFUSED.get(code, "is not among the words that this reader knows; write its moves out")
        raise ValueError(f"G{code / 10:g} {why}")

    def _dwell(self, code, value, taken, block):
        given = block.keys() & set("P" if "P" in block else "XUFSx")
        if not given:
            raise ValueError(f"G{code // 10} has no time; give it, such as P1")
        for letter in given:
            del block[letter]

    def _machine(self, code, value, taken, block):
        word = f"M{code:g}" if self.heidenhain else "SUPA or G153" if code == 1530 else f"G{code / 10:g}"
        self.left_out[word, "a position of the machine, and left out, as are rapid moves from there"] += 1
        self._forget(
            {axis.upper() for axis in taken.keys() - {"P"}} or ({} if code in (91, 92, 530, 1530) else AXES)
        )

    def _forget(self, axes):
        """The machine has moved these to places of its own; all of them if none is named."""
        for i, axis in enumerate(AXES):
            if self.known[i] and axis in axes:
                self.known[i] = None

    def _unit(self, code, value, taken, block):
        if code in UNITS_OF_PATHS and block.keys() & set("PQRL"):
            raise ValueError(f"G{code // 10} {table.TURNED}")
        if "F" in block and value != self.unit and self.kinds:
            self.left_out["F", f"beside G{code // 10} and in its unit; LinuxCNC takes the one before"] += 1
        self.unit = value
        self.feed_length = self.feed_length if code in UNITS_OF_PATHS else value

    def _system(self, code, value, taken, block):
        place = int(taken.get("P", 0))
        if code in (541, 1540) and place < 1:
            raise ValueError(f"G{code / 10:g} has no place P from 1; give it")
        system = value + place
        self.systems[system] = f"G{code / 10:g}" + f" P{place}" * (place > 0)
        if system != self.system and any(self.known):
            for unset in {self.system, system} - self.set_offsets:
                why = "a shift that the file does not hold, and taken as zero"
                self.left_out[self.systems[unset], why] += 1
        self.system = system

    def _start(self, motion):
        self.resumed = False
        if motion != self.motion:
            self._close_spline(motion is None)
            self.before = self.motion if motion == "drill" else None
            self.mirrored, self.motion = None, motion
            self.hole, self.level = {}, self.position[PLANES[self.plane][2]]

    def _offset(self, code, value, taken, block):
        given = [i for i, axis in enumerate(AXES) if axis in taken]
        if self.diameter and "X" in taken:
            taken["X"] /= 2
        if value == "tool":
            for _ in given:
                self.left_out["G43.1", "a length of the tool, and left out"] += 1
            return
        if value in ("G52", "G92") and not (taken or "E" in block):
            self.left_out[value, "without an axis, and moves nothing"] += 1
        if value == "G52":
            for i in given:
                self.shift[i] = taken[AXES[i]] * self.unit
        elif value == "G92":
            if not given:  # the fastest that the spindle may be
                block.pop("S", None)
            for i in given:
                if self.known[i] is None:  # so it is there, as after G28 of a printer
                    here = self._absolute(i, taken[AXES[i]])
                    self.position = [*self.position[:i], here, *self.position[i + 1 :]]
                self.shift[i] += self.position[i] - self._absolute(i, taken[AXES[i]])
                self.known[i] = True
        else:
            kind, place = taken.get("L"), taken.get("P", -1)
            if kind in (1, 10, 11, 12, 13) or not taken.keys() & set("LXYZ"):
                self.left_out["G10", "of the table of tools, or of a printer, and left out"] += 1
                return
            most = (300 if kind == 20 else 6) if self.fanuc else len(SYSTEMS)
            place = place if self.fanuc else place or self.system + 1  # P0 of Fanuc shifts all of them
            if kind not in (2, 20) or place not in range(1, 1 + most) or any(map(taken.get, "RIJQ")):
                raise ValueError(f"G10 is read with L2 or L20 and P1 to P{most} only; write others out")
            extended, step = self.fanuc and kind == 20, self.fanuc and not self.absolute
            system = int(place) - 1 + 101 * extended  # G54.1
            self.set_offsets |= set() if step else {system}
            for i in given:
                value = taken[AXES[i]] * self.unit + step * self.offsets[system][i]
                here = self.position[i] - self.shift[i]
                self.offsets[system][i] = here - value if kind == 20 and not extended else value

    def _shift(self, code, value, taken, block):
        """G92.1 to G92.3: forget the shift, or put it away, or take it up again."""
        if value == "on":
            self.shift = [a or b for a, b in zip(self.shift, self.last_shift, strict=True)]
        else:
            self.shift, self.last_shift = [0.0] * 3, self.shift if value == "off" else [0.0] * 3

    def _absolute(self, i, value):
        return value * self.unit + self.offsets[self.system][i] + self.shift[i]
