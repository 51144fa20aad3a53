"""The commands of controllers: what each word does, and which letters it takes out of its block."""

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}  # first axis, second axis, axis of a helix
SYSTEMS = [540, 550, 560, 570, 580, 590, 591, 592, 593]  # tenths of G54 to G59.3
ALL_AXES = "XYZABCUVW"
#: Tenths of a G word -> what it does, with what, and the letters that it takes out of its block.
G_WORDS = {
    **dict.fromkeys(
        (80, 150, 400, 490, 500, 501, 610, 611, 690, 800, 923, 940, 980, 990), ("nothing", None, "")
    ),
    **dict.fromkeys((281, 301, 6000, 6010, 6020, 6410, 6420, 6430, 6440, 6450), ("nothing", None, "")),
    **{10 * code: ("motion", name, "") for code, name in enumerate(("rapid", "line", "arc", "arc"))},
    50: ("motion", "cubic", ""),
    51: ("motion", "quadratic", ""),
    52: ("motion", "nurbs", ""),
    53: ("motion", None, ""),
    62: ("motion", "knots", ""),
    **{10 * code: ("plane", code, "") for code in PLANES},
    **dict.fromkeys((200, 700, 7000), ("unit", 25.4, "")),
    **dict.fromkeys((210, 710, 7100), ("unit", 1.0, "")),
    900: ("absolute", True, ""),
    910: ("absolute", False, ""),
    901: ("absolute_arcs", True, ""),
    911: ("absolute_arcs", False, ""),
    **{code: ("system", i, "") for i, code in enumerate(SYSTEMS)},
    541: ("system", len(SYSTEMS), "P"),
    40: ("dwell", None, ""),
    80: ("nothing", None, "PR"),
    **dict.fromkeys((430, 432), ("nothing", None, "H")),
    431: ("nothing", None, ALL_AXES),
    640: ("nothing", None, "PQ"),
    960: ("nothing", None, "DS"),
    970: ("nothing", None, "S"),
    100: ("offset", "G10", ALL_AXES + "LPRIJQ"),
    520: ("offset", "G52", ALL_AXES),
    920: ("offset", "G92", ALL_AXES),
    **dict.fromkeys((921, 922), ("offset", "none", "")),
    **dict.fromkeys((280, 300, 530), ("machine", None, ALL_AXES)),
}
COMPENSATED = "compensates the radius of the cutter; compute the path of its centre"
REFUSED = {
    **dict.fromkeys((410, 411, 420, 421), COMPENSATED),
    **dict.fromkeys((930, 950), "gives the feed by the time or the turn; give it per minute, G94"),
    **dict.fromkeys((160, 680, 511), "turns, scales or mirrors what follows; write its moves out"),
}
#: M words -> the letters that they take.
M_WORDS = {19: "RPQ", 61: "Q", 66: "PLEQ", 67: "EQ", 68: "EQ"}
M_WORDS |= dict.fromkeys((*range(48, 54), *range(62, 66)), "P") | dict.fromkeys(range(100, 200), "PQ")
ENDS = (2, 30, 99)
#: Small letters, see `_gcode_words`, that stand for a motion of their block.
LETTERED = {"m": "rapid", "s": "powers", "b": "siemens", "a": "arc", "p": "pole"}
