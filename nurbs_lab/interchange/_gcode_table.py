"""The commands of controllers: what each word does, and which letters it takes out of its block."""

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}  # first axis, second axis, axis of a helix
SYSTEMS = [540, 550, 560, 570, 580, 590, 591, 592, 593]  # tenths of G54 to G59.3
NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)"
ALL_AXES = "XYZABCUVW"
OF_LATHES = {900, 920, 940}  # which are cycles there, if an axis stands beside them
UNITS_OF_PATHS = (700, 710)  # G70 and G71 of Siemens, whose F stays in mm
#: Canned cycles -> whether they peck (and how far up), come back by the feed, and their letters.
CYCLES = {81: (None, False, "R"), 83: ("top", False, "RPQ"), 73: ("little", False, "RPQ")}
CYCLES |= {85: (None, True, "R"), **dict.fromkeys((82, 86), (None, False, "RP"))}
CYCLES |= dict.fromkeys((74, 84, 89), (None, True, "RP"))
#: What the words of `SETTINGS` set is the attribute of that name.
SETTINGS = {"plane", "absolute", "absolute_arcs", "retract", "diameter", "surface", "per", "polar"}
GROUPS = SETTINGS | {"motion", "unit", "system", "shift", "path"}  # of whose words a block has one
#: Tenths of a G word -> what it does, with what, and the letters that it takes out of its block; motions come
#: last, and theirs may belong to no other word.
G_WORDS = {
    **dict.fromkeys((220, 230, 250, 260), ("note", "a limit, and left out", ALL_AXES + "IJKPQRS")),
    **dict.fromkeys((110, 500), ("nothing", "alone", "S")),  # beside no axes
    **dict.fromkeys((90, 131, 281, 301, 400, 401, 430, 432, 490, 501), ("nothing", None, "")),
    **dict.fromkeys((610, 611), ("path", None, "")),
    **dict.fromkeys((600, 620, 630, 670, 690, 6000, 6010, 6020), ("nothing", None, "")),
    **dict.fromkeys((6410, 6420, 6430, 6440, 6450), ("nothing", None, "")),
    **{10 * code: ("motion", name, "") for code, name in enumerate(("rapid", "line"))},
    **dict.fromkeys((20, 30), ("motion", "arc", "P")),
    50: ("motion", "cubic", "PQ"),
    51: ("motion", "quadratic", ""),
    52: ("motion", "nurbs", "PL"),
    53: ("motion", None, ""),
    62: ("motion", "knots", ""),
    330: ("motion", "thread", ""),
    **{10 * code: ("motion", "drill", "") for code in CYCLES},
    800: ("nothing", None, ""),  # beside a motion
    **{-10 * code: ("hole", code, "RZILQJFKP") for code in CYCLES},  # of Siemens and Heidenhain
    -800: ("hole", None, "RZIL"),
    150: ("polar", False, ""),
    160: ("polar", True, ""),
    980: ("retract", "level", ""),
    990: ("retract", "R", ""),
    930: ("per", "move", ""),
    940: ("per", "minute", ""),
    950: ("per", "turn", ""),
    70: ("diameter", True, ""),
    80: ("diameter", False, "P"),
    **{10 * code: ("plane", code, "") for code in PLANES},
    **dict.fromkeys((200, 700, 7000), ("unit", 25.4, "")),
    **dict.fromkeys((210, 710, 7100), ("unit", 1.0, "")),
    900: ("absolute", True, ""),
    910: ("absolute", False, ""),
    901: ("absolute_arcs", True, ""),
    911: ("absolute_arcs", False, ""),
    **{code: ("system", i, "") for i, code in enumerate(SYSTEMS)},
    **{10 * code: ("system", code - 501, "") for code in (500, *range(505, 600))},  # of Siemens
    **dict.fromkeys((541, 1540), ("system", 100, "P")),
    2470: ("system", 300, "P"),  # of Heidenhain
    40: ("dwell", None, ""),
    431: ("offset", "tool", ALL_AXES),
    640: ("path", None, "PQ"),
    **dict.fromkeys((1030, 1870), ("nothing", None, "PE")),  # of Haas
    960: ("surface", True, "DS"),
    970: ("surface", False, ""),
    100: ("offset", "G10", ALL_AXES + "LPRIJQ"),
    520: ("offset", "G52", ALL_AXES),
    920: ("offset", "G92", ALL_AXES),
    921: ("shift", "none", ""),
    922: ("shift", "off", ""),
    923: ("shift", "on", ""),
    **dict.fromkeys((280, 290, 300, 530, 1530), ("machine", None, ALL_AXES + "Pxz")),  # G30 P2
}
COMPENSATED = "compensates the radius of the cutter; compute the path of its centre"
TURNED = "is a cycle of a lathe or for boring; write its moves out"
REFUSED = {
    **dict.fromkeys((410, 411, 420, 421), COMPENSATED),
    **dict.fromkeys((120, 130, 650, 660, 661, 1500), "calls a macro; write its moves out"),
    **dict.fromkeys((680, 682, 510, 511), "turns, scales or mirrors what follows; write its moves out"),
    **dict.fromkeys(
        (380, 382, 383, 384, 385), "ends where a probe touches, which no file can say; leave it out"
    ),
    **dict.fromkeys((331, 711, 712, 720, 721, 722, 760, 870, 880), TURNED),
}
#: Tenths of the G words that printers know too; with any other one they may move as only they know.
OF_PRINTERS = G_WORDS.keys() | REFUSED.keys()
OF_PRINTERS -= {120, 130, 260, 280, 290, 300, 330, *range(380, 386), 420, 610, 760, 1500, *range(800, 900)}
#: M words with a meaning that LinuxCNC or Heidenhain knows, or leaves to its users.
MACHINE = {*range(10), 13, 14, 17, 19, 30, *range(48, 54), *range(60, 74), 91, 92, *range(97, 200)}
#: M words, not of Heidenhain and of it -> the letters after them that they take.
M_WORDS = {19: "RPQS", 61: "Q", 66: "PLEQ", 67: "EQ", 68: "EQ"}
M_WORDS |= dict.fromkeys((*range(50, 54), *range(62, 66)), "P") | dict.fromkeys(range(100, 200), "PQ")
M_WORDS = M_WORDS, {118: ALL_AXES, 128: "F", 140: "F"}
#: Those that are refused -> why.
CALLED = "calls what is not in this file, or by its line; write its moves out"
REFUSED_M = {73: "restores the state after its subroutine; set it by words", 97: CALLED, 198: CALLED}
REFUSED_M = REFUSED_M, {89: CALLED, 99: CALLED, 103: "slows down what plunges; give its moves their feeds"}
#: Small letters, see `_gcode_words`, that stand for a motion of their block.
LETTERED = {"m": "rapid", "s": "powers", "b": "siemens", "a": "arc", "p": "pole"}
