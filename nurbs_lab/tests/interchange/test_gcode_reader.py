"""Programs read: every dialect comes back, and ordinary G-code as a controller reads it."""

import itertools

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.interchange._dialects import DIALECTS
from nurbs_lab.machining.program import Move
from nurbs_lab.tests.clock import least_seconds
from nurbs_lab.tests.interchange.shapes import MOVES, PLANE, curve, milling
from nurbs_lab.tests.interchange.simulated import Machine

pytestmark = pytest.mark.filterwarnings(
    "ignore:.*(has no end of a program|another axis|optional|machine|miss their|a shift|from a place)"
)
CIRCLE, U = nl.nurbs.circle(30.0).transform(np.eye(3)[:2]), np.linspace(0, 1, 101)


def program(folder, text):
    file = folder / "part.ngc"
    file.write_text(text)
    return nl.read(file)


def sampled(one):
    low, high = one.domain
    return one(low + (high - low) * U)


def points_of(moves):
    return np.concatenate([sampled(move.curve) for move in moves])


def gaps(moves):
    return [
        np.linalg.norm(one.curve(one.curve.domain[1]) - two.curve(two.curve.domain[0]))
        for one, two in itertools.pairwise(moves)
    ]


@pytest.mark.parametrize("units", ["mm", "inch"])
@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("one", [nl.paper.CURVE, curve(3, 8, 2, seed=2), curve(2, 7, 2, False), CIRCLE])
def test_every_dialect_comes_back(tmp_path, dialect, units, one):
    asked = {**PLANE, "units": units, "tolerance": 1e-3}
    moves = nl.read(nl.export(tmp_path / "a.ngc", one, dialect=dialect, **asked)).moves
    points = points_of(moves)
    assert not points[:, 2].any()
    exact = dialect in ("linuxcnc", "fanuc", "siemens") or (dialect == "heidenhain" and not one.rational)
    away = one.closest_point(points[:, :2])[1].max()
    assert away <= (1e-6 if exact else 1e-3)
    if len(moves) == 1:  # the same function of its parameter
        np.testing.assert_allclose(points[:, :2], sampled(one), rtol=0, atol=1e-6)
    assert max(gaps(moves), default=0) < 1e-12
    length = sum(move.curve.length() for move in moves)
    assert length == pytest.approx(one.length(), rel=3e-4)
    assert {round(move.feed, 5) for move in moves} == {10.0}


@pytest.mark.parametrize("dialect", sorted(DIALECTS))  # approximated anew
def test_a_file_read_and_written_again_is_the_same_program(tmp_path, dialect):
    one = nl.read(nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, **MOVES))
    two = nl.read(nl.export(tmp_path / "b.ngc", one, dialect=dialect, **MOVES))
    assert [(m.kind, m.feed) for m in one.moves] == [(m.kind, m.feed) for m in two.moves]
    np.testing.assert_allclose(points_of(one.moves), points_of(two.moves), rtol=0, atol=1e-6)
    assert [move.kind for move in one.moves][:2] == ["rapid", "cut"]


def test_moves_know_their_lines_kinds_and_feeds(tmp_path):
    text = "%\nO1001 (a part)\nG21 G90 G17\n\nT1 M6\nS8000 M3\nG0 X0 Y0 Z5\nZ1\nG1 Z-1 F120\nX10 F600\n"
    text += "M5\nY10\nG0 Z5\nM30\nX99"
    moves = program(tmp_path, text).moves
    assert [m.line for m in moves] == [8, 9, 10, 12, 13]
    assert [m.kind for m in moves] == ["rapid", "cut", "cut", "cut", "rapid"]
    assert [m.feed for m in moves] == [None, 2.0, 10.0, 10.0, None]
    assert isinstance(moves[-1], Move)
    assert [m.line for m in moves[1:3]] == [9, 10]
    np.testing.assert_array_equal(moves[-2].curve(1.0), [10, 10, -1])


def ends(moves):
    return np.array([move.curve(move.curve.domain[1]) for move in moves])


@pytest.mark.parametrize("seed", range(12))
def test_random_programs_go_where_a_simulator_goes(tmp_path, seed):
    """Lines, arcs and helices in three planes, cycles, splines, units, shifts, loops and expressions."""
    machine = Machine(100 + seed)
    moves = program(tmp_path, machine.text).moves
    for move, (kind, points, feed) in zip(moves, machine.moves, strict=True):
        assert move.kind == kind
        assert move.feed == (feed and pytest.approx(feed, rel=1e-9))
        np.testing.assert_allclose(move.curve(move.curve.domain), points[[0, -1]], atol=1e-6)
        if len(points) > 2:
            assert move.curve.closest_point(points)[1].max() < 1e-6
            chords = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
            assert move.curve.length() == pytest.approx(chords, rel=0.05)


def test_splines_of_linuxcnc(tmp_path):
    text = "G0 X0 Y0\nF60\nG5 I0 J3 P0 Q-3 X1 Y1\nG5.1 X2 Y2 I1\nG5.2 P1 L3\nX3 Y3 P2\n"
    text += "X4 Y2 P1\nX5 Y3 P1\nG5.3\nG1 X9"
    cubic, quadratic, nurbs, line = program(tmp_path, text).moves
    np.testing.assert_allclose(cubic.curve.control_points[:, :2], [(0, 0), (0, 3), (1, -2), (1, 1)])
    np.testing.assert_allclose(quadratic.curve.control_points[:, :2], [(1, 1), (2, 1), (2, 2)])
    assert (nurbs.curve.degree, nurbs.line, line.line) == (2, 5, 10)
    np.testing.assert_allclose(nurbs.curve.knots, [0, 0, 0, 1, 2, 2, 2])
    np.testing.assert_allclose(nurbs.curve.weights, [1, 2, 1, 1])


@pytest.mark.parametrize(
    "still",
    [
        "G5.2 P1 L3\nX0 Y0 P1\nX0 Y0 P9\nG5.3",
        "BSPLINE SD=2 X0 Y0\nX0 Y0\nX0 Y0",
        "G6.2 P3 K0 X0 Y0 R1\nK0 X0 Y0 R1\nK0 X0 Y0 R1\nK1\nK1\nK1",
        "G5 I0 J0 P0 Q0 X0 Y0",
        "G93\nG5.1 I0 J0 X0 Y0 F5\nG94 F600",
    ],
)
def test_a_curve_without_length_is_no_move_as_a_line_is_none(tmp_path, still):
    moves = program(tmp_path, f"{START}{still}\nG1 X5").moves
    np.testing.assert_array_equal(ends(moves), [(5, 0, 0)])


START = "G21 G90 G17\nG0 X0 Y0 Z0\nF600\n"
#: Blocks after START -> ends of their moves in the plane.
READ = {
    "G64 P0.05\nG1 X5": [(5, 0)],  # a stray word is no move
    "G61.1\nG1 X5": [(5, 0)],
    "N1 O1\nG1 X5": [(5, 0)],
    "M62 P0\nG1 X5 M66 P0 L3 Q5\nM100 P1 Q2": [(5, 0)],
    "G1 X5\nG4 F2\nX9\nG4 P1\nG04 X2.\nX10": [(5, 0), (9, 0), (10, 0)],
    "G43 H1 T2 M6 S500 M3\nG96 D100 S200\nG1 X5 D1": [(5, 0)],
    "G10 L2 P2 X100\nG55 G1 X5\nG92 X0\nX1\nG92.1": [(105, 0), (106, 0)],
    "G10 L20 P1 X10\nG1 X12\nG52 X1 Y1\nX0 Y0": [(2, 0), (-9, 1)],
    "G05 P10000\nG1 X5\nG05 P0\nG05.1 Q1\nX6\nG05.1 Q0": [(5, 0), (6, 0)],
    "G28 G91 Z0\nG90 G53 G0 Z0\nG0 Z0\nG1 X5": [(5, 0)],
    "/G1 X5\n:77\n<PART>\nN10 X6 (a) Y1 ; b": [(5, 0), (6, 1)],
    "G10 L2 P1 X5\nG54.1 P3 G1 X1\nG54 X2": [(1, 0), (7, 0)],
    "G2 X10 I5 J0 K0": [(10, 0)],
    "g1x5y-.5f9\nx 6": [(5, -0.5), (6, -0.5)],
    "G1 X=5 Y=-1\nG2 X7 Y1 CR=2": [(5, -1), (7, 1)],
    "G91\nG1 X5 E0.2\nE-1\nA90\nG90 X2": [(5, 0), (2, 0)],
    "#1=3\n#<side>=[#1 + 2] #2=#1\nG1 X#<side> Y-#2": [(5, -3)],
    "G1 X[7 MOD -2.5] Y[0 - 7 MOD 2.5]": [(2, -2)],
    "G1 X[2 ** 3 - 6 / 3 * 2] Y[ATAN[1]/[1] MOD 40]": [(4, 5)],
    "#1=1 #1=5\nG1 X#1": [(5, 0)],
    "G1 X[EXISTS[#<no>]] Y[[3 GT 2] AND [1 LE 0] OR [2 EQ 2]]": [(0, 1)],
    "O1 sub\nG1 X#1 Y#2\nO1 endsub\nO1 call [1] [2]\nO1 call [3] [4]": [(1, 2), (3, 4)],
    "#1=9\nO<ab> sub\n#1=[#1 + 1]\nO<ab> endsub [#1]\nO<ab> call [4]\nG1 X#1 Y#<_value>": [(9, 5)],
    "#1=0\nO1 while [#1 LT 3]\n#1=[#1+1]\nG1 X#1\nO1 endwhile": [(1, 0), (2, 0), (3, 0)],
    "#1=0\nO1 do\n#1=[#1+1]\nO2 if [#1 EQ 2]\nO1 continue\nO2 endif\nG1 X#1\nO1 while [#1 LT 2]": [(1, 0)],
    "#1=2\nO1 if [#1 EQ 1]\nG1 X1\nO1 elseif [#1 EQ 2]\nG1 X2\nO1 else\nG1 X3\nO1 endif": [(2, 0)],
    "O1 sub\nO2 if [#1 GT 0]\nG1 X#1\nO1 call [#1 - 1]\nO2 endif\nO1 endsub\nO1 call [2]": [(2, 0), (1, 0)],
    "G1 F600\nM98 P7 L2\nG1 X9\nM30\nO7\nG91 X1\nG90 M99": [(1, 0), (2, 0), (9, 0)],
    "G10 L1 P1 R5\nG7\nG1 X10\nG10 L2 P1 X2\nX10\nG8 X6": [(5, 0), (6, 0), (7, 0)],
    "G95 S300 F2\nG1 X5\nG94 F600 X6\nG33 X9 K2": [(5, 0), (6, 0), (9, 0)],
    "G92 X5\nG92.2\nG1 X1\nG92.3\nX0\nG92.1\nX0": [(1, 0), (-5, 0), (0, 0)],
    "G1 X=2+3 Y1\nX=IC(2) Y=IC(-1)\nX=2*2 Y=0": [(5, 1), (7, 0), (4, 0)],
    'G1 X5\nM201 X9 Y9\nM73 P5 R3\nM117 to X7\nMSG "to X8"\nM862.3 P "MK3S"\nX6': [(5, 0), (6, 0)],
    "SET_LIMIT X=3\nG28 X Y\nG10\nG0 X0 Y0\nG1 X5": [(5, 0)],
    "#1=0\nWHILE [#1 LT 2] DO1\n#1=#1+1\nG1 X#1\nEND1": [(1, 0), (2, 0)],
    "G1\nM98 P20007\nM30\nO7\nG91 X1\nG90 M99": [(1, 0), (2, 0)],
    "M70\nG91 G20 F1\nM72\nG1 X1\nX2": [(1, 0), (2, 0)],
    "G0 G80 G98 G90\nG1 X1": [(1, 0)],
    "G00 G40 G49 G80 G90 G50\nG0 G11\nG4 F2 G1\nX1": [(1, 0)],
    "#1=0\nN5 #1=[#1+1]\nG1 X#1\nIF [#1 LT 3] GOTO 5\nGOTO7\nX9\nN7 Y1": [(1, 0), (2, 0), (3, 0), (3, 1)],
    "M98 P7\nG1 X9\nM30\nO7\nGOTO 1\nX5\nN1 G1 X4\nM99\nO8\nN1 X6": [(4, 0), (9, 0)],
    "M98 P7 L0\nG1 X9\nM30\nO7\nX5\nM99": [(9, 0)],
    "G16 G1 X10 Y90\nY180\nG15 X3\nG16 G91 X5 Y-90": [(0, 10), (-10, 0), (3, 0), (0, -8)],
    "O1 while [1]\nG1 X1\nO1 break\nO1 endwhile\nX2\nM30\nX3": [(1, 0), (2, 0)],
    "O1 sub\nO1 endsub [4]\nO2 sub\nO1 call\nO2 endsub\nO2 call\nG1 X5 Y#<_value>": [(5, 0)],
    'G500 G40.1\nMSG("to (X9); ")\nG641 ADIS=0.1 ADISPOS=.2\nM17\nG1 X5\nM17\n%': [(5, 0)],
    "G60\nG1 X5\nG91 G30 P2 Z0": [(5, 0)],
    "#1=1\nIF [#1 EQ 1] THEN #2=7 (a)\nIF [#1 EQ 2] THEN #2=8\nG1 X#2": [(7, 0)],
    "T0101\nG1 X5 Z0\nU2 W0\nG90 G1 X9": [(5, 0), (7, 0), (9, 0)],
    "T0101 M6\nG90 G1\nG90 X5 W1": [(5, 0)],
    "R1=5\nR2=R1*2-1\nG1 X=R1 Y=R2/3\nX=IC(R1) Y-R1": [(5, 3), (10, -5)],
}


@pytest.mark.parametrize("text", READ)
def test_blocks_are_read_as_a_controller_reads_them(tmp_path, text):
    moves = program(tmp_path, START + text).moves
    np.testing.assert_allclose(ends(moves)[:, :2], READ[text], atol=1e-9)
    if "g1x5" not in text:
        assert {move.feed for move in moves} == {10.0}


def test_a_cubic_goes_on_with_its_tangent(tmp_path):
    moves = program(tmp_path, START + "G5 I0 J3 P0 Q-3 X1 Y1\nP0 Q-3 X2 Y2").moves
    np.testing.assert_allclose(moves[1].curve.control_points[:, :2], [(1, 1), (1, 4), (2, -1), (2, 2)])
    with pytest.raises(ValueError, match="line 6: the curve needs"):
        program(tmp_path, START + "G5 I0 J3 P0 Q-3 X1 Y1\nG1 X3\nG5 P0 Q-3 X2 Y2")


@pytest.mark.parametrize(("plane", "axes"), [("G17", "XYZ"), ("G19", "YZX"), ("G18", "ZXY")])
@pytest.mark.parametrize("word", ["Q1", "Q2", "Q3", ""])
def test_splines_with_knots_in_all_planes(tmp_path, plane, axes, word):
    points, knots = curve(3, 6, 2, seed=8).control_points.round(3), [0, 0, 0, 0, 1, 2, 3, 3, 3, 3]
    rows = [
        f"{'G06.2 P4 ' + word if i == 0 else ''} {axes[0]}{x} {axes[1]}{y} R{1 + i} K{knots[i]}"
        for i, (x, y) in enumerate(points)
    ]
    start = f"G21 G90 {plane}\nG0 X0 Y0 Z0\nG1 {axes[0]}{points[0, 0]} {axes[1]}{points[0, 1]} F600\n"
    *_, spline, last = program(tmp_path, start + "\n".join([*rows, *4 * ["G6.2 K3"], f"G1 {axes[2]}1"])).moves
    expected = nl.NurbsCurve(3, knots, points, np.arange(1.0, 7.0))
    order = ["XYZ".index(axis) for axis in axes[:2]]
    np.testing.assert_allclose(sampled(spline.curve)[:, order], sampled(expected), atol=1e-9)
    assert last.curve.length() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "said", "count"),
    [
        ("G1 X5000 Y200", "its coordinates have no point; they are taken as mm", 1),
        ("G1 X5\nM201 X9\nM17 Z2", r"orders of a printer in 2 of its blocks are left out, .*: M201, M17$", 1),
        ("G1 X5\nG1\nG1 F50", r"G1 in 1 of its blocks is without an axis, and moves nothing", 1),
        ("G1 X5 E1\nE2\nX6 A3", r"E in 2 of its blocks is another axis than X, Y and Z", 2),
        ("G0 Z9\nG81 X1 Z-1 R2", r"G81 in 1 of its blocks is without G98 or G99", 5),
        ("G1 X5\nG94\nX6", r"G94 in 1 of its blocks is without F, and the feed before it goes on", 2),
        ("G1 X5\nM395\nG9", r"M395 in 1 of its blocks is an order of the builder of the machine", 1),
        ("G1 X5\nM220 S50\nM220 S100", r"orders of a printer in 2 of its blocks .*: M220$", 1),
        ("G1 X5\nSUPA G0 Z9", r"SUPA or G153 in 1 of its blocks is a position of the machine", 1),
        ("G53 G0 Z9\nG98 G81 X1 Z-1 R2", r"G81 in 1 of its blocks is from a height", 3),
        ("G18 G99\nG1 X5 F0.2", "G96, G99 or T0101 is of a lathe; without G7 and G95 X is", 1),
        ("T0101\nG1 X5\nG4 U1\nU2 W-1\nG28 U0", "G28 in 1 of its blocks is a position of the machine", 2),
        ("G1 X5\nM48 P9 X3 V2\nX6", r"orders of a printer in 1 of its blocks .*: M48$", 2),
        ("G92\nG1 X5", r"G92 in 1 of its blocks is without an axis, and moves nothing", 1),
        ("/G1 X5", r"/ in 1 of its blocks is an optional block, which is read", 1),
        ("$H\nG0 X0 Y0 Z0\nG1 X5", r"G28 in 1 of its blocks is a position of the machine", 1),
        ("G1 X5\nG20 F9 X1", r"F in 1 of its blocks is beside G20 and in its unit", 2),
        ("G1 X5\n%", r"% in 1 of its blocks is behind the program without one before it", 1),
        ("G53 G0 Z0\nG0 Z0\nG1 X5", r"G53 in 1 of its blocks is a position of the machine", 1),
        ("G2 X10.03 I5 F600", r"1 of its arcs miss their ends by up to 0\.03 mm, in line 4", 1),
    ],
)
def test_what_is_left_out_is_named_once(tmp_path, text, said, count):
    with pytest.warns(UserWarning, match=rf"path: part\.ngc: {said}"):
        assert len(program(tmp_path, START + text).moves) == count


@pytest.mark.parametrize(
    "limit", ["G25 X-80 Y-80 S100", "G26 S9", "G22 X9 Z1 I2 J3 K4", "G92 S90", "G50 S90"]
)
def test_a_limit_is_no_move_and_no_speed(tmp_path, limit):
    text = f"{START}S1500 M3\n{limit}\nG95 F0.2 G1 X5\nG96 S200\n"
    (move,) = program(tmp_path, text + "M30").moves
    np.testing.assert_allclose(ends([move]), [(5, 0, 0)])
    assert move.feed == pytest.approx(0.2 * 1500 / 60)
    with pytest.raises(ValueError, match="needs the speed of the spindle"):  # which turned faster and faster
        program(tmp_path, text + "G97 G1 X9\nM30")


@pytest.mark.parametrize("blocks", ["G1 X{x:.4f} Y{y:.4f}", "G2 X{x:.4f} Y{y:.4f} R9"])
def test_reading_takes_time_in_proportion_to_the_file(tmp_path, blocks):
    def seconds(count):
        steps = np.cumsum(np.random.default_rng(0).normal(size=(count, 2)), axis=0)
        lines = (blocks.format(x=x, y=y) for x, y in steps)
        (tmp_path / "a.ngc").write_text("G0 X0 Y0\nF600\n" + "\n".join(lines))
        assert len(nl.read(tmp_path / "a.ngc").moves) == count
        return least_seconds(lambda: nl.read(tmp_path / "a.ngc"))

    assert seconds(40_000) < 9 * seconds(10_000)  # between 4 of linear time and 16 of quadratic
