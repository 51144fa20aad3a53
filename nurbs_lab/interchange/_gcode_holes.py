"""Cycles for holes of Siemens and Heidenhain, which call them in other blocks, in words like those of G81."""

import math
import re

from nurbs_lab.interchange._gcode_table import NUMBER

#: Their numbers -> those of `CYCLES`, where they are others.
HOLES = {"201": "85", "240": "82", **dict.fromkeys(("200", "203", "205"), "83")}
HOLES |= dict.fromkeys(("87", "88", "202"), "86") | dict.fromkeys(("206", "207"), "84")


def hole_of_siemens(found):
    """A cycle: heights R, Z, L, and I above the surface, feed F; called once, P1, or by moves, P2.

    Pecks are Q deep, and each is J (DAM) less deep than the one before. A factor, below zero, is refused.
    """
    given = {i: float(text) for i, text in enumerate(found[3].split(",")) if text.strip()}
    call, code, _ = found.groups()
    surface = given.get(1, 0.0)
    words = {
        "I": given.get(2, 0.0),
        "Z": given.get(3, surface - abs(given.get(4, math.nan))),
        "L": given.get(0),
    }
    words["R"] = surface + words["I"]
    if code == "83":
        words["Q"] = surface - given[5] if 5 in given else given.get(6)
        words["J"] = less if (less := given.get(7, 0.0)) >= 0.0 else None
        code = "83" if given.get(11) else "73"
    elif code == "84":
        words["F"] = given[8] * given[10] if {8, 10} <= given.keys() else None
    elif code == "85":
        words["F"] = given.get(6)
    return _hole(found, code, words | {"P": 2.0 if call[0] == "M" else 1.0})


def hole_of_heidenhain(found):
    """A cycle of Heidenhain, which M99 calls; K is the pitch of a thread. Shrinking pecks are refused."""
    given = {int(key): float(value) for key, value in re.findall(rf"Q(\d+)\s*=\s*({NUMBER})", found[2])}
    if found[1] == "247" and 339 in given:  # the preset
        return f"G247 P{given[339]}" + "\n" * found[0].count("\n")
    surface = math.nan if given.get(212) else given.get(203, math.nan)
    heights = {"I": given.get(200, math.nan), "Z": surface + given.get(201, math.nan)}
    heights |= {"R": surface + heights["I"], "L": surface + max(heights["I"], given.get(204, 0.0))}
    others = {letter: given[key] for letter, key in (("Q", 202), ("F", 206), ("K", 239)) if key in given}
    return _hole(found, found[1], heights | others | {"P": 0.0})


def _hole(found, code, words):
    """The cycle as a G word below zero with its letters, or as it is written if one of them is missing."""
    code = HOLES.get(code, code)
    if int(code) > 99 or any(value is None or math.isnan(value) for value in words.values()):
        return found[0]
    text = " ".join(f"{letter}{value:.9f}" for letter, value in words.items())
    return f"G-{code} {text}" + "\n" * found[0].count("\n")
