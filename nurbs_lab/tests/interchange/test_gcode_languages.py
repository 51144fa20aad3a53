"""Programs in the own languages of Heidenhain and Siemens."""

import re

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.test_gcode_reader import ends, program, sampled

pytestmark = pytest.mark.filterwarnings("ignore:.*has no end of a program")


@pytest.mark.parametrize(
    ("rows", "knots"),
    [
        (" X0 Y0 PL=0\nX1 Y5 PL=0\nX4 Y6 PL=0\nX9 Y2 PL=1\nX12 Y0 PL=2", [1]),
        ("\nX1 Y5 PL=1\nX4 Y6 PL=0\nX8 Y5 PL=2\nX9 Y2 PL=0\nX12 Y0 PL=0", [1, 1]),
    ],
)
def test_empty_spans_of_siemens_may_come_first(tmp_path, rows, knots):
    """Some posts write the empty spans of the start and the start itself, others those of the end."""
    spline, _ = program(tmp_path, f"G71 G90\nG0 X0 Y0 Z0\nF600\nBSPLINE SD=3{rows}\nG1 X20").moves
    points = [(0, 0), (1, 5), (4, 6), *[(8, 5)] * (len(knots) - 1), (9, 2), (12, 0)]
    expected = nl.NurbsCurve(3, [0, 0, 0, 0, *knots, 3, 3, 3, 3], points)
    np.testing.assert_allclose(sampled(spline.curve)[:, :2], sampled(expected), atol=1e-9)


@pytest.mark.parametrize("away", ["Z+0 R0 FMAX M91", "M140 MB MAX"])
def test_circles_and_tools_of_heidenhain(tmp_path, away):
    text = "0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0\n2 TOOL CALL 1 Z S5000\n3 L X+10 Y+0 Z+0 R0 FMAX M3\n"
    text += "4 CC X+0 Y+0\n5 C X-10 Y+0 DR+ F600\n6 CR X+10 Y+0 R+10 DR-\n"
    text += f"7 CYCL DEF 32.0 TOLERANCE\n8 L Z+5 C+90\n9 L {away}\n10 L X+9 FMAX\n11 END PGM A MM\n"
    with pytest.warns(UserWarning, match="(C in 1 .* another axis|M[91]\\d+ in 1 .* position of)"):
        below, above, line = program(tmp_path, text).moves
    assert below.curve.length() == pytest.approx(10 * np.pi)
    np.testing.assert_allclose(below.curve(0.5), (0, 10, 0), atol=1e-9)
    np.testing.assert_allclose(above.curve(0.5), (0, 10, 0), atol=1e-9)
    assert line.curve.length() == pytest.approx(5)


def test_steps_and_poles_of_heidenhain(tmp_path):
    text = "0 BEGIN PGM A MM\n1 L X+20 Y+0 Z+0 FMAX\n2 L X+10 IY+5 F600\n3 CC IX+0 IY+5\n"
    text += "4 C X+10 Y+15 DR+\n5 CC\n6 CC X+0\n7 C X-10 Y+15 DR+\n8 END PGM A MM\n"
    moves = program(tmp_path, text).moves
    np.testing.assert_allclose(ends(moves), [(10, 5, 0), (10, 15, 0), (-10, 15, 0)])
    assert [move.curve.length() for move in moves[1:]] == pytest.approx([5 * np.pi, 10 * np.pi])


def heidenhain(folder, *blocks):
    blocks = "BEGIN PGM A MM", *"\n".join(blocks).split("\n"), "END PGM A MM"
    return program(folder, "\n".join(f"{i} {block}" for i, block in enumerate(blocks))).moves


@pytest.mark.parametrize(
    ("block", "feed"),
    [
        ("L X+5 F0.2 M136", 0.2 * 1500 / 60),  # by the turn
        ("L X+5 F300", 5.0),
        ("M136\nM137\nL X+5 F300", 5.0),
        ("L X+5", 4.0),  # of TOOL CALL
        ("L X+0 F9\nL X+5 F AUTO", 4.0),
        ("L X+0 F9\nL X+5 FAUTO M8", 4.0),
        ("L X+5 F300 M128 F1000", 5.0),
        ("M128 F1000\nL X+5", 4.0),
        ("L X+5 F300 M118 X1 Z1", 5.0),
        ("L X+5 F300 M120 LA5 M98", 5.0),
    ],
)
def test_a_word_of_heidenhain_belongs_to_the_m_word_before_it(tmp_path, block, feed):
    call = 'TOOL CALL "X 3" Z S1500 F240 DL+0.2'
    (move,) = heidenhain(tmp_path, call, "L X+0 Y+0 Z+0 R0 F MAX M3", block)
    np.testing.assert_allclose(ends([move]), [(5, 0, 0)])
    assert move.feed == pytest.approx(feed)


@pytest.mark.parametrize(
    ("block", "why"),
    [
        ("L X+5 M103 F20", "M103 slows down what plunges"),
        ("CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+0\nCYCL DEF 7.2 Y+5", "shifts, turns, scales or mirrors"),
        ("L X+5 M99", "M99 calls what is not in this file"),
        ("L X+5 FU0.2", "gives its feed by the turn, the tooth"),
        ("TOOL CALL 2 Z S Q1\nL X+5 F0.1 M136", "the feed by the turn needs the speed of the spindle"),
    ],
)
def test_what_steers_the_feed_of_heidenhain_otherwise_is_refused(tmp_path, block, why):
    with pytest.raises(ValueError, match=rf"line \d: .*{why}"):
        heidenhain(tmp_path, "TOOL CALL 1 Z S1500 F240", "L X+0 Y+0 Z+0 R0 FMAX", block)


NOT_GIVEN = [
    ("CC X+0 Y+0\nC X-10 Y+0", "line 5: the arc has no direction, .* give it DR"),
    ("CR X+0 Y+10 R+10", "line 4: the arc has no direction"),
    ("CC X+0 Y+0\nCP IPA+90", "line 5: the arc has no direction"),
    ("CC X+0 Y+0\nCR X-10 Y+0 DR+", r"line 5: 'CR X-10 Y\+0 DR\+': C has its end, CR has R too"),
    ("CC X+0 Y+0\nC X-10 Y+0 R+10 DR+", "line 5: .*: C has its end"),
    ("CC X+0 Y+0\nCP Z-5 DR+", "line 5: .* and CP one of IPA and PA; mend it"),
    ("CC X+0 Y+0\nX-10 Y+0 DR+", "line 5: .* turns without C or CP; mend it"),
    ("CC X+0 Y+0\nC X-10 Y+0 DR+ FMAX", "line 5: .* moves in two ways"),
    ("L X+1 CC Y+0 FMAX", "line 4: .* moves in two ways"),
    ("L X+5 Y+Q7", "line 4: Q7 has no value"),
    ("CYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-7 ~\nQ206= ~\nQ202=4 ~\nQ203=0", "line 4: 'CYCL DEF 200"),
    ("CC X+0 Y+0\nC X+10 Y+0 P2 DR+", "line 5: P2 is not known in such a move"),
    ("SPL X+5 ~\nK3X+0 K2X+0 K1X+5 K1X+5", "line 4: K1X5 follows another K1X"),
]


@pytest.mark.parametrize(("blocks", "said"), NOT_GIVEN)
def test_what_heidenhain_needs_is_not_taken_as_given(tmp_path, blocks, said):
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S100 F300\nL X+10 Y+0 Z+0 FMAX\n{blocks}\nEND PGM A MM"
    with pytest.raises(ValueError, match=said):
        program(tmp_path, text)


def test_direction_holds_and_fmax_and_arcs_end_with_their_block(tmp_path):
    """As in the ISO words G05 and G15 of the same controllers, an arc without DR turns as the last one."""
    blocks = "CC X+0 Y+0", "C X-10 DR+ F60", "C X+10", "X+5", "Y+3 FMAX", "X+1"
    moves = heidenhain(tmp_path, "TOOL CALL 1 Z S100", "L X+10 Y+0 Z+0 FMAX", *blocks)
    assert [move.kind for move in moves] == ["cut", "cut", "cut", "rapid", "cut"]
    np.testing.assert_allclose([move.curve(0.5) for move in moves[:2]], [(0, 10, 0), (0, -10, 0)], atol=1e-9)
    np.testing.assert_allclose(ends(moves[2:]), [(5, 0, 0), (5, 3, 0), (1, 3, 0)])


def test_the_unit_of_heidenhain_is_asked_for(tmp_path):
    with pytest.warns(UserWarning, match="it has no MM or INCH in BEGIN PGM; its numbers"):
        program(tmp_path, "BEGIN PGM A\nL X+0 Y+0 Z+0 FMAX\nL X+5 F60\nEND PGM A")


def test_blocks_of_heidenhain_with_one_number_are_doubled(tmp_path):
    with pytest.raises(
        ValueError, match="line 2: its block is empty, or one before it is missing or doubled"
    ):
        program(tmp_path, "1 BEGIN PGM A MM\n1 L X+0 FMAX\n2 END PGM A MM")


@pytest.mark.parametrize("cycle", ["CYCLE81(10,1,2)", "CYCLE81(10,1,2-,-6)", "CYCLE81(10,1,2,--6)"])
def test_cycles_of_siemens_without_a_depth_or_with_broken_numbers_are_refused(tmp_path, cycle):
    with pytest.raises(ValueError, match=r"line 2: 'CYCLE81"):
        program(tmp_path, f"G17 G90 F60\n{cycle}\nM30")


@pytest.mark.parametrize(("tool", "axes"), [("Z", "XYZ"), ("Y", "ZXY"), ("X", "YZX")])
def test_arcs_of_heidenhain_turn_about_the_axis_of_the_tool(tmp_path, tool, axes):
    """Counterclockwise seen from its positive side, from the first of the other axes to the second."""
    blocks = f"TOOL CALL 1 {tool} S100", "L A+10 B+0 C+0 FMAX", "CR A+0 B+10 R+10 DR+ F60", "CC A+0 B+0"
    blocks = [*blocks, "C A-10 B+0 DR+", "CC IA+2", "C A-6 B+0 DR-"]
    letters = str.maketrans("ABC", axes)
    blocks = [re.sub(r"(?<=[ I])[ABC](?=[-+])", lambda w: w[0].translate(letters), b) for b in blocks]
    moves = heidenhain(tmp_path, *blocks)
    found = np.array([move.curve(np.mean(move.curve.domain)) for move in moves])
    order = ["XYZ".index(axis) for axis in axes]
    r = 10 * np.sqrt(0.5)
    np.testing.assert_allclose(found[:, order], [(r, r, 0), (-r, r, 0), (-8, 2, 0)], atol=1e-9)


@pytest.mark.parametrize(("word", "turns"), [("", 0), ("TURN=0", 0), ("TURN=1", 1), ("TURN=3", 3)])
def test_turns_of_siemens_come_before_the_arc(tmp_path, word, turns):
    (move,) = program(tmp_path, f"G710 G0 X10 Y0 Z0\nG3 X0 Y10 Z-6 I-10 J0 {word} F60\nM30").moves
    assert move.curve.length() == pytest.approx(np.hypot(10 * (turns + 0.25) * 2 * np.pi, 6))


DRILLED = """0 BEGIN PGM A MM
1 TOOL CALL 1 Z S1000 F300
2 CYCL DEF 247 DATUM SETTING ~
    Q339=+1 ;DATUM NUMBER
3 L X+1 Y+2 Z+20 FMAX M3
4 CYCL DEF 200 DRILLING ~
    Q200=+2 ;SET-UP CLEARANCE ~
    Q201=-7 ;DEPTH ~
    Q206=+60 ;FEED RATE ~
    Q202=+4 ;PLUNGING DEPTH ~
    Q203=+1 ;SURFACE COORDINATE ~
    Q204=+9 ;2ND SET-UP CLEARANCE
5 L FMAX M99
6 L X+5 FMAX
7 L X+8 FMAX M99
8 END PGM A MM"""
CALLED = "G17 G90 F60 S1000\nG0 X1 Y2 Z20\n{}\nX1 Y2\nG0 X8\nMCALL\nX5\nM30"
#: The same two holes, from 3 to -6 in pecks of 4 from the surface at 1, and then up to 10; some by smaller
#: pecks, of which those of Siemens end in two of equal depth.
HOLES = {
    DRILLED: [-3.0, -6.0],
    CALLED.format("MCALL CYCLE83(10,1,2,-6,,-3,,0,0,0,1,1)"): [-3.0, -6.0],
    CALLED.format("MCALL CYCLE83(10,1,2,-6,,,4,0,0,0,1,0)"): [-3.0, -6.0],
    CALLED.format("MCALL CYCLE83(10,1,2,-6,,,3,1,0,0,1,1)"): [-2.0, -4.0, -5.0, -6.0],
    CALLED.format("MCALL CYCLE83(10,1,2,-6.5,,,3,1,0,0,1,1)"): [-2.0, -4.0, -5.0, -5.75, -6.5],
    CALLED.format("N5 MCALL CYCLE81(10, 1, 2, , 7)"): [-6.0],
    CALLED.format("MCALL CYCLE84(10,1,2,-6,,0,3,,0.06,0,1000)"): [-6.0, 3.0],
}


@pytest.mark.parametrize("text", HOLES)
def test_holes_of_siemens_and_heidenhain_are_where_they_are_called(tmp_path, text):
    moves = program(tmp_path, text).moves
    cuts = np.array([move.curve(move.curve.domain[1]) for move in moves if move.kind == "cut"])
    np.testing.assert_allclose(cuts[:, 2], 2 * HOLES[text], atol=1e-9)
    np.testing.assert_allclose(cuts[:, :2], np.repeat([(1, 2), (8, 2)], len(cuts) // 2, axis=0))
    assert {move.feed for move in moves if move.kind == "cut"} == {1.0}
    tops = [move.curve(move.curve.domain[1])[2] for move in moves if move.kind == "rapid"]
    assert max(tops) == 10.0


@pytest.mark.parametrize(
    ("blocks", "end", "length"),
    [
        (["CC X+0 Y+0", "CP IPA+90 DR+ F60"], (0, 10, 0), 5 * np.pi),
        (["CC X+0 Y+0", "CP IPA-450 Z-5 DR- F60"], (0, -10, -5), np.hypot(25 * np.pi, 5)),
        (["CC X+0 Y+0", "CP PA+180 DR+ F60"], (-10, 0, 0), 10 * np.pi),
        (["CC X+7 Z+0", "CP IPA+90 DR+ F60"], (7, 0, -3), 1.5 * np.pi),  # from Z to X is positive
        (["LBL 1", "PLANE RESET STAY", "LBL 0", "FUNCTION RESET TCPM", "L Y+4 F60"], (10, 4, 0), 4.0),
        (
            ["CYCL DEF 7.0 DATUM SHIFT", "CYCL DEF 7.1 X+0", "CYCL DEF 7.2 IY+0.0", "L Y+4 F60"],
            (10, 4, 0),
            4.0,
        ),
        (["FN 0: Q5 = +4", "L Y+Q5 F60"], (10, 4, 0), 4.0),
        (["L Y+4,5 F60"], (10, 4.5, 0), 4.5),
    ],
)
def test_polar_arcs_and_parameters_of_heidenhain(tmp_path, blocks, end, length):
    (move,) = heidenhain(tmp_path, "TOOL CALL 1 Z S100", "L X+10 Y+0 Z+0 FMAX", *blocks)
    np.testing.assert_allclose(move.curve(move.curve.domain[1]), end, atol=1e-9)
    assert move.curve.length() == pytest.approx(length)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ("G98 G81 X1 R2 Z-1\nG80\nX3", "G80 in 1 of its blocks is followed by moves without a word"),
        ("G22 X1 Y1", "G22 in 1 of its blocks is a limit"),
        ("G05.1 Q1\nG1 X1", "G5.1 in 1 of its blocks is a mode of Fanuc"),
        ("G05 P10000\nG1 X1", "G5 in 1 of its blocks is a mode of Fanuc"),
        ("G94 G5\nG1 X1", "G5 in 1 of its blocks is without an axis"),
        ("G43.1 Z1", "G43.1 in 1 of its blocks is a length of the tool, and left out"),
        ("M44", "M44 in 1 of its blocks is an order of the builder"),
        ("M109 S200", "orders of a printer in 1 of its blocks .*: M109$"),
        ("M981 P1", "orders of a printer in 1 of its blocks .*: M981$"),
        ("G10", "G10 in 1 of its blocks is of the table of tools"),
    ],
)
def test_what_linuxcnc_refuses_is_named(tmp_path, block, said):
    with pytest.warns(UserWarning, match=said) as found:
        program(tmp_path, f"G21 G90 F600\nG0 X0 Y0 Z9\n{block}\nM30")
    words = [str(one.message).split()[2] for one in found]
    assert len(set(words)) == len(words)


@pytest.mark.parametrize(
    "words", ["DYNFINISH\nDIAMOF UPATH", "N5 ORIWKS\nRTLIOF", "FIFOCTRL\nDYNSEMIFIN", "G103 P1"]
)
def test_words_of_posts_that_move_nothing_are_taken(tmp_path, recwarn, words):
    """A preamble of Siemens or Haas; a word that means diameters is no such one."""
    (move,) = program(tmp_path, f"G71 G90\n{words}\nG0 X0 Y0 Z0\nG1 X5 F600\nM30").moves
    np.testing.assert_array_equal(ends([move]), [(5, 0, 0)])
    assert not recwarn
    with pytest.raises(ValueError, match="line 2: 'DIAMON' "):
        program(tmp_path, "G71 G90\nDIAMON\nG0 X0 Y0 Z0\nG1 X5 F600\nM30")
