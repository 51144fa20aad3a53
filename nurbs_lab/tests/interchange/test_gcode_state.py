"""The state of a controller that no block of the file gives: positions of the machine, offsets, units."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import MOVES, milling
from nurbs_lab.tests.interchange.test_gcode_reader import START, ends, program


@pytest.mark.parametrize("suffix", [".nc", ".mpf", ".gcode", ".TAP", ".cnc", ".h"])
def test_programs_by_their_usual_suffixes(tmp_path, suffix):
    """Those of Heidenhain say in their first line that they are."""
    dialect = "heidenhain" if suffix == ".h" else "g1"
    file = nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, **MOVES)
    one, two = nl.read(file), nl.read(file.rename(tmp_path / f"a{suffix}"))
    np.testing.assert_array_equal(ends(one.moves), ends(two.moves))


@pytest.mark.parametrize("gone", ["G91 G28 Z0\nG90", "G30 Z5", "G53 G0 Z100", "SUPA G0 Z100 D0", "G28"])
def test_an_axis_that_the_machine_moved_has_no_position(tmp_path, gone):
    text = f"G1 Z-2\n{gone}\nG0 X20\nG1 X25\nG91 G81 Z-1 R0\nG90 G0 X0 Y0 Z5\nG1 Z-1\nX30\nM2"
    with pytest.warns(UserWarning, match="2 of its cuts begin where the program does not say, .* line"):
        moves = program(tmp_path, START + text).moves
    np.testing.assert_allclose(ends(moves), [(0, 0, -2), (0, 0, -1), (30, 0, -1)])


def test_offsets_that_the_program_sets_are_kept_and_others_named(tmp_path, recwarn):
    text = "G10 L2 P1 X1\nG10 L2 P2 X100\nG54 G1 X10\nG55 X20\nG54 X0\nM2"
    np.testing.assert_allclose(ends(program(tmp_path, START + text).moves)[:, 0], [11, 120, 1])
    assert not recwarn
    with pytest.warns(UserWarning, match=r"another offset .* in 3 of its blocks is a shift that the file"):
        assert len(program(tmp_path, START + "G1 X1\nG55 X2\nG54 X0\nG505 X1\nM2").moves) == 4


@pytest.mark.parametrize(("word", "feed"), [("G70", 1.0), ("G700", 25.4), ("G20", 25.4)])
def test_inches_of_paths_and_of_feeds(tmp_path, word, feed):
    """G70 of Siemens leaves F as it is; in the head of Heidenhain's G-code it is the unit of both."""
    (move,) = program(tmp_path, f"{word} G90\nG0 X0 Y0 Z0\nG1 X1 F60\nM2").moves
    assert move.feed == pytest.approx(feed)
    assert move.curve.length() == pytest.approx(25.4)
    (move,) = program(tmp_path, "%A G70 *\nN1 G00 X+0 Y+0 Z+0 *\nN2 G01 X+1 F600 *\nN9 %A G70 *").moves
    assert (move.feed, move.curve.length()) == pytest.approx((25.4, 25.4))


def test_a_start_that_no_block_gives(tmp_path):
    """In steps no start is needed; otherwise a cut of an axis that has none yet is left out and named."""
    moves = program(tmp_path, "G21 G91 F600\nG1 X10\nG1 Y10\nG1 X-10\nG1 Y-10\nM2").moves
    np.testing.assert_allclose(ends(moves)[:, :2], [(10, 0), (10, 10), (0, 10), (0, 0)])
    with pytest.warns(UserWarning, match=r"1 of its cuts begin where the program does not say, .* line 2"):
        moves = program(tmp_path, "G0 X0 Y0\nG1 Z-1 F600\nX5\nM2").moves
    np.testing.assert_allclose(ends(moves), [(5, 0, -1)])


@pytest.mark.parametrize("miss", [0.004, 0.02])
def test_arcs_that_do_not_close_are_closed_exactly(tmp_path, miss):
    (move,) = program(tmp_path, START + f"G3 X{20 + miss} Y0 I10 J0\nM2").moves
    np.testing.assert_allclose(move.curve(move.curve.domain), [(0, 0, 0), (20 + miss, 0, 0)], atol=1e-12)
    assert np.ptp(move.curve.curvature(np.linspace(0, 1, 9))) < 1e-9
