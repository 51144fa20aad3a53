"""Programs read: every dialect comes back, ordinary G-code too; what is not read is refused by its line."""

import itertools
import random
import re
from functools import partial

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.interchange import _gcode_reader
from nurbs_lab.interchange._dialects import DIALECTS
from nurbs_lab.machining.program import Move
from nurbs_lab.tests.clock import least_seconds
from nurbs_lab.tests.interchange.shapes import MOVES, PLANE, curve, milling
from nurbs_lab.tests.robust import hostile

pytestmark = pytest.mark.filterwarnings("ignore:.* has no end of a program")
U = np.linspace(0, 1, 101)


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
@pytest.mark.parametrize(
    "one",
    [
        nl.paper.CURVE,
        curve(3, 8, 2, seed=2),
        curve(2, 7, 2, False),
        nl.nurbs.circle(30.0).transform(np.eye(3)[:2]),
    ],
)
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
    assert length == pytest.approx(one.length(), rel=2e-4)
    assert {round(move.feed, 5) for move in moves} == {10.0}


@pytest.mark.parametrize("dialect", sorted(DIALECTS.keys() - {"arcs"}))  # approximated anew
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
    assert [(m.line, m.kind, m.feed) for m in moves] == [
        (8, "rapid", None),
        (9, "cut", 2.0),
        (10, "cut", 10.0),
        (12, "cut", 10.0),
        (13, "rapid", None),
    ]
    assert isinstance(moves[-1], Move)
    assert [m.line for m in moves[1:3]] == [9, 10]
    np.testing.assert_array_equal(moves[-2].curve(1.0), [10, 10, -1])


@pytest.mark.parametrize("plane", ["G17", "G18", "G19"])
def test_columns_give_the_moves_that_single_blocks_give(tmp_path, monkeypatch, plane):
    """Lines and arcs of all spellings, by centre and by radius, at rest and in steps, in random order."""
    rng = random.Random(plane)
    a, b, i, j = {"G17": "XYIJ", "G18": "ZXKI", "G19": "YZJK"}[plane]
    lines = [plane, "G0 X1 Y1 Z1", "F600", "G91"]
    for _ in range(200):
        x, y = (round(rng.uniform(0.5, 2), 3) for _ in range(2))
        line = f"{a}{x} {b}{y} "
        lines.append(
            rng.choice(
                [
                    f"G{rng.choice('01')} {line}",
                    f"G{rng.choice('23')} {a}{2 * x} {b}{2 * y} {i}{x} {j}{y} F{x}",
                    f"G{rng.choice('23')} {line} R{rng.choice([-3, 3])}",
                ]
            )
        )
    text = "\n".join(lines)
    columns = program(tmp_path, text).moves
    assert len(columns) == len(lines) - 4
    monkeypatch.setattr(_gcode_reader, "LONG_RUN", 1000)
    single = program(tmp_path, text).moves
    for name in ("kinds", "starts", "ends", "feeds", "lines"):
        np.testing.assert_allclose(getattr(columns, name), getattr(single, name), rtol=1e-12, atol=1e-12)
    assert columns.curves.keys() == single.curves.keys()
    np.testing.assert_allclose(points_of(columns), points_of(single), atol=1e-9)


def ends(moves):
    return np.array([move.curve(move.curve.domain[1]) for move in moves])


@pytest.mark.parametrize("blocks", [1, 40])
def test_units_increments_and_shifts(tmp_path, blocks):
    """The same moves whether blocks are read one by one or as columns."""
    lines = ["G21 G90 G94", "G0 X0 Y0 Z0", "G1 F60 X10", "G91"]
    lines += ["G1 X1 Y0.5"] * blocks + ["G90 G20"] + [f"G1 X{i / 25.4!r}" for i in range(blocks)]
    lines += [
        "G21",
        "G92 X100",
        *[f"G1 X{101 + i} Y{i}" for i in range(blocks)],
        "G92.1 G10 L2 P2 X1000",
        "G55",
    ]
    lines += [f"G1 X{i} Y0" for i in range(blocks)]
    x = [10, *(11 + np.arange(blocks)), *range(blocks)]
    at, y = x[-1], blocks / 2
    expected = [*((i, min(0.5 * max(n, 0), y)) for n, i in enumerate(x))]
    expected += [(at + 1 + i, i) for i in range(blocks)] + [(1000 + i, 0) for i in range(blocks)]
    moves = program(tmp_path, "\n".join(lines)).moves
    got = ends(moves)[:, :2]
    expected = np.array(expected)
    kept = np.r_[True, (np.diff(expected, axis=0) != 0).any(axis=1)]
    np.testing.assert_allclose(got, expected[kept], atol=1e-9)


@pytest.mark.parametrize(("plane", "axes"), [("G17", "XYZ"), ("G18", "ZXY"), ("G19", "YZX")])
@pytest.mark.parametrize(("word", "sense"), [("G2", -1), ("G3", 1)])
@pytest.mark.parametrize("turn", [0.5, np.pi / 2, 3.0, 4.0, 2 * np.pi])
@pytest.mark.parametrize("rise", [0.0, 7.0])
def test_arcs_and_helices(tmp_path, plane, axes, word, sense, turn, rise):
    radius, first = 25.0, 0.3
    angle = first + sense * turn * U
    path = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rise * U])
    path -= path[0]
    a, b, _ = axes
    offset = -radius * np.array([np.cos(first), np.sin(first)])
    end = " ".join(f"{letter}{value:.12f}" for letter, value in zip(axes, path[-1], strict=True))
    words = dict(zip("XYZ", "IJK", strict=True))
    centre = f"{words[a]}{offset[0]:.12f} {words[b]}{offset[1]:.12f}"
    spellings = [centre] if turn > 6 else [centre, f"R{radius * (1 if turn <= np.pi else -1)}"]
    for spelling in spellings:
        (move,) = program(tmp_path, f"{plane} G0 X0 Y0 Z0\nF60\n{word} {end} {spelling}").moves
        order = ["XYZ".index(letter) for letter in axes]
        got = sampled(move.curve)[:, order]
        across = np.hypot(got[:, 0] - offset[0], got[:, 1] - offset[1])
        np.testing.assert_allclose(across, radius, atol=2e-7)
        np.testing.assert_allclose(got[[0, -1]], path[[0, -1]], atol=1e-9)
        assert move.curve.length() == pytest.approx(np.hypot(radius * turn, rise), rel=1e-7)
        if rise:  # the height is in step with the angle
            turned = np.unwrap(np.arctan2(got[:, 1] - offset[1], got[:, 0] - offset[0])) - first
            np.testing.assert_allclose(got[:, 2], rise * turned / (sense * turn), atol=2e-7)


def test_splines_of_linuxcnc(tmp_path):
    text = "G0 X0 Y0\nF60\nG5 I0 J3 P0 Q-3 X1 Y1\nG5.1 X2 Y2 I1\nG5.2 P1 L3\nX3 Y3 P2\n"
    text += "X4 Y2 P1\nX5 Y3 P1\nG5.3\nG1 X9"
    cubic, quadratic, nurbs, line = program(tmp_path, text).moves
    np.testing.assert_allclose(cubic.curve.control_points[:, :2], [(0, 0), (0, 3), (1, -2), (1, 1)])
    np.testing.assert_allclose(quadratic.curve.control_points[:, :2], [(1, 1), (2, 1), (2, 2)])
    assert (nurbs.curve.degree, nurbs.line, line.line) == (2, 5, 10)
    np.testing.assert_allclose(nurbs.curve.knots, [0, 0, 0, 1, 2, 2, 2])
    np.testing.assert_allclose(nurbs.curve.weights, [1, 2, 1, 1])


REFUSED = [
    ("G1 X1 F60\nG1 X#1", r"line 2: '#1' is a variable; give its number"),
    ("G1 X1 F60\nG1 X[1+2]", r"line 2: '\[1\+2\]' is an expression"),
    ("O100 sub\nG1 X1\nO100 endsub", r"line 1: 'O100 SUB' is a subroutine"),
    ("G0 X1\nM98 P1000", r"line 2: M98 calls or ends a subroutine; write its moves out"),
    ("G0 X1\n/G0 X2", r"line 2: '/G0 X2' is an optional block"),
    ("G0 X1\nG81 Z-1 R1", r"line 2: G81 is not among the words"),
    ("G0 X1\nG41 D1", r"line 2: G41 .*; compute the path of the centre"),
    ("G0 X1\nG53 G0 Z0", r"line 2: G53 .*coordinates of the program"),
    ("G0 X1\nG1 X2", r"line 2: the move has no feed; give it a word F"),
    ("G0 X1\n" + "G1 X2\nG1 X3\n" * 20, r"line 2: (the move|G1) has no feed"),
    ("G0 X1\nG1 X2 F0", r"line 2: the feed of F0 is not positive"),
    ("G0 X1\nG1 XX2", r"line 2: 'G1 XX2' is no row of words"),
    ("G0 X1\nG1 X2 X3 F1", r"line 2: X3 follows another X"),
    ("G0 X1 (open", r"line 1: 'G0 X1 \(OPEN' is no row"),
    ("G0 X0\nG2 X1 Y1 F60", r"line 2: the arc has neither a radius R nor a centre I, J"),
    ("G0 X0\nG2 X9 R1 F60", r"line 2: R1 joins no ends 9 mm apart"),
    ("G0 X0\nG2 X9 I1 F60", r"line 2: the centre is 1 mm from the start of its arc and 8 mm from its end"),
    ("G0 X0\nG2 X1 I1 P0.5 F60", r"line 2: P0\.5 is no number of turns from 1 to 1000"),
    ("G0 X0\nG10 L1 P1 X1", r"line 2: G10 is read as G10 L2 P1 to P9 only"),
    ("G0 X0\nG1 X1 F60 E5", r"line 2: E5 is not known in such a move"),
    ("G0 X0\nX" + "9" * 400, r"line 2: a number is too large"),
    ("G0 X0\nX9999999", r"line 2: X1e\+07 is beyond"),
    ("X1", r"line 1: X1 belongs to no move; give the block one of G0 to G3"),
    (
        "G0 X0 Y0\nF60\nG5.2 P1 L4\nX1 Y1 P1\nG5.3",
        r"line 3: the spline .*: 2 control points are too few for L4",
    ),
    (
        "G0 X0 Y0\nF60\nG6.2 P4 K0 X0 Y0\nX1 K0\nG1",
        r"line 3: the spline .* refused: every block needs its knot",
    ),
    ("", "it holds no block"),
    ("(nothing)\nM30", "it holds no move"),
]


@pytest.mark.parametrize(("text", "said"), REFUSED)
def test_what_is_not_read_is_refused_by_its_line(tmp_path, text, said):
    with pytest.raises(ValueError, match=rf"part\.ngc' cannot be read: {said}"):
        program(tmp_path, text)


def samples(folder):
    for dialect in DIALECTS:
        yield nl.export(
            folder / "a.ngc", milling(), dialect=dialect, **{**MOVES, "tolerance": 1.0}
        ).read_bytes()
    yield (
        b"G20 G90\nG0 X0 Y0\nG92 X1\nG10 L2 P3 X2\nG56 G1 X1 F10\n"
        + b"G91 X1 Y1\n" * 3
        + b"G3 X1 I2 J0\nG2 X1 R3 Z1\nM30"
    )
    yield b"G0 X0 Y0\nF60\nG5 I0 J3 P0 Q-3 X1 Y1\nG5.1 X2 I1\nG5.2 P1 L3\nX3 Y3 P2\nX4\nG5.3\nG18 G2 X1 R9\n"


def test_programs_with_a_damaged_line_are_read_or_refused_by_line(tmp_path):
    rng, refused, file = np.random.default_rng(1), [], tmp_path / "damaged.ngc"
    whole = list(samples(tmp_path))
    for k in range(1000):
        lines = whole[k % len(whole)].split(b"\n")
        damaged = rng.integers(len(lines))
        lines[damaged] = hostile.file(rng, lines[damaged])
        file.write_bytes(b"\n".join(lines))
        try:
            moves = _gcode_reader.read(file).moves
        except ValueError as error:
            refused.append(str(error))
            continue
        assert np.isfinite(moves.ends).all()
        assert all(np.isfinite(moves[i].curve.control_points).all() for i in moves.curves)
    assert 100 < len(refused) < 900
    assert all(re.match(r"line \d+: .*|it holds no (block|move)", said) for said in refused)


@pytest.mark.parametrize(
    "long", [b"(" * 10**6, b"X" * 10**6, b"G1 X" + b"9" * 10**6, b"O" + b" " * 10**6 + b"SUB"]
)
def test_long_nonsense_is_refused_in_linear_time(tmp_path, long):
    def refuse(line):
        (tmp_path / "a.ngc").write_bytes(b"G0 X0\n" + line)
        with pytest.raises(ValueError, match="line 2"):
            nl.read(tmp_path / "a.ngc")

    tenth, whole = (least_seconds(partial(refuse, line)) for line in (long[: 10**5], long))
    assert whole < 30 * tenth  # between 10 of linear time and 100 of quadratic


@pytest.mark.parametrize("blocks", ["G1 X{x:.4f} Y{y:.4f}", "G2 X{x:.4f} Y{y:.4f} R9"])
def test_reading_takes_time_in_proportion_to_the_file(tmp_path, blocks):
    def seconds(count):
        steps = np.cumsum(np.random.default_rng(0).normal(size=(count, 2)), axis=0)
        lines = (blocks.format(x=x, y=y) for x, y in steps)
        (tmp_path / "a.ngc").write_text("G0 X0 Y0\nF600\n" + "\n".join(lines))
        assert len(nl.read(tmp_path / "a.ngc").moves) == count
        return least_seconds(lambda: nl.read(tmp_path / "a.ngc"))

    assert seconds(80_000) < 9 * seconds(20_000)  # between 4 of linear time and 16 of quadratic
