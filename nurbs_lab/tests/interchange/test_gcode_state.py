"""The state of a controller that no block of the file gives: positions of the machine, offsets, units."""

import re

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import MOVES, milling
from nurbs_lab.tests.interchange.test_gcode_reader import START, ends, program


@pytest.mark.parametrize("coding", ["utf-16", "utf-8-sig", "latin-1"])
def test_programs_in_any_coding(tmp_path, coding):
    (tmp_path / "a.nc").write_bytes("G21 G90 (\u00fc)\r\nG0 X0 Y0 Z0\r\nG1 X5 F60\r\nM2\r\n".encode(coding))
    np.testing.assert_allclose(ends(nl.read(tmp_path / "a.nc").moves), [(5, 0, 0)])


@pytest.mark.parametrize("suffix", [".nc", ".mpf", ".spf", ".gcode", ".TAP", ".cnc", ".h"])
def test_programs_by_their_usual_suffixes(tmp_path, suffix):
    """Those of Heidenhain say in their first line that they are."""
    dialect = "heidenhain" if suffix == ".h" else "g1"
    file = nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, **MOVES)
    one, two = nl.read(file), nl.read(file.rename(tmp_path / f"a{suffix}"))
    np.testing.assert_array_equal(ends(one.moves), ends(two.moves))


@pytest.mark.parametrize(
    ("order", "count"),
    [
        *(("G29 P9 X1 Y2 W3 H4", 1), ("G80", 1), ("G28 O", 1), ("G150.3", 1), ("G28 W ; all", 1)),
        *(("M1002 gcode_claim_action : 29", 2), ("M1002 judge_flag g29_flag", 2), ("T1000\nSYNC R1", 2)),
        *(("GET_POSITION", 2), ("G380 S2 Z30 F300", 1), ("M486 APart G", 2)),
        *(("M17 X1 Y2", 2), ("M42 P1 S9", 2), ("M0", 2), ("M117 G1 X7", 2), ("G28 Z (home)\nG1 Z1", 2)),
    ],
)
def test_orders_of_a_printer_are_left_out_and_named_at_once(tmp_path, recwarn, order, count):
    """With the cut from where one of them has moved; its retraction is no exponent, and M84 an end."""
    text = f"G1 X0 Y0 Z1 F600\nM104 S9\n{order}\nG1X5Y2Z1 E-1\nG1E-1\nX9\nM84"
    moves = program(tmp_path, "G21 G90\nG92 E0\n" + text).moves
    np.testing.assert_allclose(ends(moves)[-count:], [(5, 2, 1), (9, 2, 1)][-count:])
    assert len(moves) == count + 1
    said = [str(one.message) for one in recwarn]
    assert sum("orders of a printer" in one for one in said) == 1
    assert not any("cut off" in one or "G92" in one for one in said)


def test_checksums_of_a_printer(tmp_path):
    text = "G21\nN1 G90*17\nN2 G92 X0 Y0 Z0*91 ; here\nN3 G1 X10 F600*2\nN4 #1=2*3\nN5 G1 X#1\nM2"
    np.testing.assert_allclose(ends(program(tmp_path, text).moves), [(10, 0, 0), (6, 0, 0)])
    with pytest.raises(ValueError, match="line 4: its checksum is 2, that of its words 3; it is damaged"):
        program(tmp_path, text.replace("X10", "X11"))


@pytest.mark.parametrize("gone", ["G91 G28 Z0\nG90", "G30 Z5", "G53 G0 Z100", "SUPA G0 Z100 D0", "G28"])
def test_an_axis_that_the_machine_moved_has_no_position(tmp_path, gone):
    text = f"G1 Z-2\n{gone}\nG0 X20\nG1 X25\nG91 G81 Z-1 R0\nG90 G0 X0 Y0 Z5\nG1 Z-1\nX30\nM2"
    with pytest.warns(UserWarning, match="2 of its cuts begin where the program does not say, .* line"):
        moves = program(tmp_path, START + text).moves
    np.testing.assert_allclose(ends(moves), [(0, 0, -2), (0, 0, -1), (30, 0, -1)])


@pytest.mark.parametrize("way", ["G90", "G91"])
def test_absolute_words_of_siemens(tmp_path, way):
    """They are absolute in G91 too, and about the offset that holds."""
    text = f"G10 L2 P1 X1\n{way}\nG1 X=AC(5) Y=AC(2*1)\nG2 X=AC(15) Y=AC(2) I=AC(10) J=AC(2)\n"
    text += "X=AC(5) I=AC(10)\nM2"
    line, arc, back = program(tmp_path, START + text).moves
    np.testing.assert_allclose(ends([line, arc, back])[:, :2], [(6, 2), (16, 2), (6, 2)])
    np.testing.assert_allclose(arc.curve(0.5)[:2], (11, 7))
    assert [arc.curve.length(), back.curve.length()] == pytest.approx(2 * [5 * np.pi])


def test_blanks_in_numbers(tmp_path):
    (move,) = program(tmp_path, START + "G 1 X 1 0 Y - 5 . 2\t5 F 1 00\nM2").moves
    np.testing.assert_allclose(ends([move])[0], (10, -5.25, 0))
    assert move.feed == pytest.approx(100 / 60)
    with pytest.raises(ValueError, match="line 2: '1 L X 1 0' is no row of words"):
        program(tmp_path, "0 BEGIN PGM A MM\n1 L X 1 0\n2 END PGM A MM")


@pytest.mark.parametrize("line", ["G1 X=AC(5) ,R2", "G1 X5 CR=2 Y=IC(2) oops", "Q1=2 SUPA (note)"])
def test_a_line_is_quoted_as_it_is_written(tmp_path, line):
    with pytest.raises(ValueError, match=f"line 4: {re.escape(repr(line.upper()))} "):
        program(tmp_path, START + line)


def test_offsets_that_the_program_sets_are_kept_and_others_named(tmp_path, recwarn):
    text = "G10 L2 P1 X1\nG10 L2 P2 X100\nG54 G1 X10\nG55 X20\nG54 X0\nM2"
    np.testing.assert_allclose(ends(program(tmp_path, START + text).moves)[:, 0], [11, 120, 1])
    assert not recwarn
    with pytest.warns(UserWarning, match="a shift that the file does not hold") as said:
        moves = program(tmp_path, START + "G10 L2 P2 X100\nG1 X1\nG55 X2\nG54 X0\nG505 X1\nM2").moves
    np.testing.assert_allclose(ends(moves)[:, 0], [1, 102, 0, 1])
    named = [re.search(r"ngc: (\S+) in (\d)", str(one.message)).groups() for one in said]
    assert named == [("G54", "3"), ("G505", "1")]  # and not G55


@pytest.mark.parametrize(
    ("begin", "block", "ends_at"),
    [
        ("", "G10 L20 P1 X100\nG1 X1", -99),  # LinuxCNC: this place becomes X100
        ("%\nO5\n", "G10 L20 P1 X100\nG1 X1", 1),  # Fanuc: the offset of G54.1 P1
        ("%\nO5\n", "G10 L20 P1 X100\nG54.1 P1 G1 X1", 101),
        ("", "G10 L20 P2 X100\nG54.1 P2 G1 X1", 101),
        ("%\nO5\n", "G10 L2 P1 X9\nG91 G10 L2 P1 X3\nG90 G1 X1", 13),
        ("", "G10 L2 P1 X9\nG91 G10 L2 P1 X3\nG90 G1 X1", 4),
        ("%\nO5\n", "G10 L13 P1 R3\nG1 X1", 1),
    ],
)
def test_offsets_that_fanuc_and_linuxcnc_write_alike(tmp_path, begin, block, ends_at):
    (move,) = program(tmp_path, f"{begin}{START}{block}\nM30\n" + "%" * bool(begin)).moves
    assert ends([move])[0, 0] == ends_at


def test_functions_that_fanuc_and_linuxcnc_write_alike(tmp_path):
    """Of negative numbers; and a variable that nothing has set is empty in Fanuc, not 0."""
    block = "G1 X[FIX[-2.5]] Y[FUP[-2.1]] Z[-7 MOD 3]\n"
    for begin, ends_at in (("", (-3, -2, 2)), ("%\nO5\n", (-2, -3, -1))):
        (move,) = program(tmp_path, f"{begin}{START}{block}M30\n" + "%" * bool(begin)).moves
        np.testing.assert_array_equal(ends([move]), [ends_at])
    assert len(program(tmp_path, f"{START}G1 X1\nX#100 Y3\nM30\n").moves) == 2
    with pytest.raises(ValueError, match="#100 is not set in this file, and empty in Fanuc; give it a value"):
        program(tmp_path, f"%\nO5\n{START}G1 X1\nX#100 Y3\nM30\n%")
    text = "IF [1 EQ 1] THEN #2=7\nIF [1 EQ 2] THEN #3=8\nG1 X#2\n"
    np.testing.assert_array_equal(ends(program(tmp_path, f"O5\n{START}{text}M30\n").moves), [(7, 0, 0)])


@pytest.mark.parametrize(("word", "feed"), [("G70", 1.0), ("G700", 25.4), ("G20", 25.4)])
def test_inches_of_paths_and_of_feeds(tmp_path, word, feed):
    """G70 of Siemens leaves F as it is."""
    (move,) = program(tmp_path, f"{word} G90\nG0 X0 Y0 Z0\nG1 X1 F60\nM2").moves
    assert move.feed == pytest.approx(feed)
    assert move.curve.length() == pytest.approx(25.4)
    with pytest.raises(ValueError, match="line 1: it is G-code of Heidenhain; give the program in its plain"):
        program(tmp_path, "%A G70 *\nN1 G00 X+0 Y+0 Z+0 *\nN2 G01 X+1 F600 *\nN9 %A G70 *")


@pytest.mark.parametrize(("begin", "count"), [("", 1), ("G71 ", 0), ("G20 ", 0), ("M201 X9\n", 0)])
def test_a_program_that_names_no_unit_is_in_mm_and_said(tmp_path, recwarn, begin, count):
    """A program of a printer has always been."""
    program(tmp_path, f"{begin}G0 X0 Y0\nG1 X5 F600\nM2")
    assert sum("no G20 or G21; its numbers are taken as mm" in str(one.message) for one in recwarn) == count


def test_a_start_that_no_block_gives(tmp_path):
    """It is 0, and named, for steps, for the cut that gives the first one, and for all cuts before it."""
    with pytest.warns(UserWarning, match="a step of . in 2 .* from a place .* taken as 0") as said:
        moves = program(tmp_path, "G21 G91 F600\nG1 X10\nG1 Y10\nG1 X-10\nG1 Y-10\nM2").moves
    assert len(said) == 2
    np.testing.assert_allclose(ends(moves)[:, :2], [(10, 0), (10, 10), (0, 10), (0, 0)])
    with pytest.warns(UserWarning, match=r"Y in 3 of its blocks is from a place .* taken as 0") as said:
        moves = program(tmp_path, "G21 G0 X0 Z5\nG1 Z-1 F600\nX5\nY2\nX0\nM2").moves
    assert len(said) == 1
    np.testing.assert_allclose(ends(moves), [(0, 0, -1), (5, 0, -1), (5, 2, -1), (0, 2, -1)])


@pytest.mark.parametrize("miss", [0.004, 0.02])
def test_arcs_that_do_not_close_are_closed_exactly(tmp_path, miss):
    (move,) = program(tmp_path, START + f"G3 X{20 + miss} Y0 I10 J0\nM2").moves
    np.testing.assert_allclose(move.curve(move.curve.domain), [(0, 0, 0), (20 + miss, 0, 0)], atol=1e-12)
    assert np.ptp(move.curve.curvature(np.linspace(0, 1, 9))) < 1e-9


def test_cycles_come_from_the_height_before_the_first_of_them(tmp_path):
    """As in LinuxCNC, which goes up on the way to the next hole, and takes G80 beside a cycle for nothing."""
    text = "G0 Z5\nG99 G81 X1 Z-6 R1\nG98 G81 X2 Z-3 R2\nS9 M3 G86 G80 X3 P0\nG91 G81 X1 Z-2 R-1\nM2"
    heights = [5, 1, -6, 1, 5, 2, -3, 5, 5, 2, -3, 5, 5, 4, 2, 5]
    np.testing.assert_allclose(ends(program(tmp_path, START + text).moves)[:, 2], [5, *heights])


@pytest.mark.parametrize("word", ["L3", "K3"])
def test_cycles_are_repeated_by_l_or_as_on_a_fanuc_by_k(tmp_path, word):
    moves = program(tmp_path, START + f"G0 Z9\nG91 G99 G81 X10 Z-3 R-8 {word}\nM2").moves
    np.testing.assert_allclose(ends(m for m in moves if m.kind == "cut")[:, 0], [10, 20, 30])


@pytest.mark.parametrize(("begin", "heights"), [("%\nO5\n", [2, -5]), ("", [22, 17])])
def test_heights_of_a_cycle_stay_absolute_in_g91_on_a_fanuc(tmp_path, recwarn, begin, heights):
    """And become steps in LinuxCNC, which is said; those that G91 gives are steps on both."""
    text = "G0 Z20\nG99 G81 X5 Z-5 R2\nG91 X10 L2\nX5 Z-1 R-19\nG90 X40 Z-5 R2\nM30\n"
    moves = program(tmp_path, begin + START + text + "%" * bool(begin)).moves
    cuts = np.array([move.curve(move.curve.domain) for move in moves if move.kind == "cut"])
    np.testing.assert_allclose(cuts[:, 0, 0], [5, 15, 25, 30, 40])
    np.testing.assert_allclose(cuts[:, :, 2], [[2, -5], heights, heights, [1, 0], [2, -5]])
    assert sum("which Fanuc keeps" in str(one.message) for one in recwarn) == (not begin)


def test_programs_that_nothing_calls_are_named(tmp_path, recwarn):
    text = "%\nO1\n" + START + "M98 P0003\nM30\nO2\nG1 X9\nM30\nO0003\nG1 X1\nM99\nO4 (none)\nM30\n%"
    (move,) = program(tmp_path, text).moves
    np.testing.assert_array_equal(ends([move]), [(1, 0, 0)])
    assert [str(one.message) for one in recwarn] == [
        "path: part.ngc: its programs O2, O4 are not called, and left out"
    ]
