"""Programs for controllers: within the tolerance, exact where a dialect can be, nothing chosen in silence."""

import itertools
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.interchange import _pieces
from nurbs_lab.interchange._dialects import DIALECTS
from nurbs_lab.machining.program import Move, Program
from nurbs_lab.tests.interchange.shapes import ASKED, MOVES, PLANE, curve, milling, path


def words(file):
    """Every line of a program as a mapping of letters to numbers."""
    found = (dict(re.findall(r"([A-Z])([-+]?[\d.]+)", line)) for line in file.read_text().splitlines())
    return [{letter: float(value) for letter, value in line.items()} for line in found]


@pytest.mark.parametrize("dim", [2, 3])
def test_a_tool_path_is_one_move_a_period(tmp_path, dim):
    sent = path(dim)
    file = nl.export(tmp_path / "path.ngc", sent)
    lines = file.read_text().splitlines()
    assert {"G21", "G90", "G94"} <= set(lines[1].split())  # mm, absolute, feed a minute
    assert lines[-1] == "M2"
    moves = words(file)[2:-1]
    assert [move["G"] for move in moves] == [0, 1, 1, 1, 1, 1]
    points = [[move[letter] for letter in "XYZ"[:dim]] for move in moves]
    np.testing.assert_allclose(points, sent.points, atol=1e-7)
    steps, feed, feeds = np.linalg.norm(np.diff(sent.points, axis=0), axis=1), None, []
    for move in moves[1:]:
        feed = move.get("F", feed)
        feeds.append(feed)
    np.testing.assert_allclose(steps / np.array(feeds) * 60, np.diff(sent.t), rtol=1e-6)


def test_the_suffix_of_a_program_changes_nothing_but_that_h_is_heidenhains(tmp_path):
    def export(name, **more):
        return nl.export(tmp_path / name, nl.paper.CURVE, **PLANE, **more)

    assert len({export(f"a{suffix}").read_bytes() for suffix in (".ngc", ".nc", ".mpf")}) == 1
    with pytest.raises(ValueError, match=r"a \.h file is one of Heidenhain's; give dialect"):
        export("a.h")
    assert nl.read(export("a.h", dialect="heidenhain")).moves[-1].kind == "cut"


def test_a_path_that_waits_takes_its_time(tmp_path):
    """In dwells: two holds, a step below the last digit, and the end. LinuxCNC takes seconds."""
    at = np.array([0.0, 0.0, 1e-9, 1.0, 3.0, 3.0, 3.0, 3.5, 3.5])
    sent = SimpleNamespace(t=0.25 * np.arange(9.0), u=at, points=np.outer(at, [0.6, 0.8]))
    lines = nl.export(tmp_path / "a.ngc", sent).read_text().splitlines()[2:-1]
    assert [line for line in lines if line.startswith("G4 ")] == ["G4 P0.5", "G4 P0.5", "G4 P0.25"]
    time = x = feed = 0.0
    for line in lines[1:]:
        word = dict(re.findall(r"([A-Z])([-\d.]+)", line))
        feed = float(word.get("F", feed))
        time += float(word["P"]) if word["G"] == "4" else 60 * (float(word["X"]) - x) / 0.6 / feed
        x = float(word.get("X", x))
    assert (time, x) == pytest.approx((2.0, 2.1), rel=1e-6)


@pytest.mark.parametrize("tolerance", [1.0, 1e-2, 1e-4])
@pytest.mark.parametrize(
    "one", [nl.paper.CURVE, curve(2, 8, 2, seed=3), curve(3, 9, 3, seed=4), curve(5, 12, 2, seed=5)]
)
def test_chords_and_cubics_keep_any_tolerance(one, tolerance):
    rows = _pieces.bezier_rows(one)
    chords = _pieces.chord_points(one, tolerance)
    middles = (chords[:-1] + chords[1:]) / 2
    assert one.closest_point(middles)[1].max() <= tolerance
    u = one.closest_point(chords)[0]
    assert np.all(np.diff(u) > 0)
    for part in (0.25, 0.5, 0.75):  # points of the curve are as near to their chord
        points = one(u[:-1] + part * np.diff(u))
        assert distances_to(points, chords[:-1], chords[1:]).max() <= tolerance
    cubics = _pieces.cubic_rows(rows, tolerance)
    assert np.all(cubics[1:, 0] == cubics[:-1, -1])
    t = np.linspace(0, 1, 11)
    basis = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    points = np.einsum("kt,mkd->mtd", basis, cubics).reshape(-1, one.dim)
    assert one.closest_point(points)[1].max() <= tolerance


@pytest.mark.parametrize("dialect", ["g1", "arcs", "heidenhain"])
def test_weights_far_apart_hide_nothing_between_the_probes(dialect, tmp_path):
    """Nearly all of a piece may lie within a hundredth of its parameter."""
    rng = np.random.default_rng(1)
    for degree in (2, 3, 4, 5):
        points, weights = 20 * rng.normal(size=(degree + 3, 2)), 10 ** rng.uniform(-3, 3, degree + 3)
        knots = [0.0] * (degree + 1) + [0.5, 0.7] + [1.0] * (degree + 1)
        one = nl.NurbsCurve(degree, knots, points, weights)
        file = tmp_path / ("a.h" if dialect == "heidenhain" else "a.ngc")
        moves = nl.read(nl.export(file, one, dialect=dialect, **{**ASKED, "axes": "XY"})).moves
        places = [m.curve(np.linspace(*m.curve.domain, 60))[:, :2] for m in moves if m.kind == "cut"]
        assert one.closest_point(np.concatenate(places))[1].max() <= 1.01 * ASKED["tolerance"]


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_chords_of_curves_that_turn_back_rest_or_hide_nearly_all_between_two_places(degree):
    """A curve of nearly no width turns where no place need lie; where points repeat, a span has no slope."""
    rng = np.random.default_rng(degree)
    knots = [*[0.0] * (degree + 1), 0.3, 0.5, 0.5000001, *[1.0] * (degree + 1)]
    for thin, weights in itertools.product((1e-9, 1.0), (None, 10 ** rng.uniform(-3, 3, degree + 4))):
        points = 10 * rng.normal(size=(degree + 4, 2)) * [1.0, thin]
        points[:2] = points[0]  # the slope vanishes at the start
        one = nl.NurbsCurve(degree, knots, points, weights)
        chords = _pieces.chord_points(one, 1e-3)
        places = one(np.unique(np.r_[np.linspace(0, 1, 4001), 0.5 + np.linspace(-1e-6, 1e-6, 101)]))
        off = [distances_to(place, chords[:-1], chords[1:]).min() for place in places]
        assert max(off) <= 1e-3


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
def test_a_circle_takes_few_chords(tolerance):
    """Chords between points of a circle are at least as many as their largest angle allows."""
    radius = 30.0
    chords = len(_pieces.chord_points(nl.nurbs.circle(radius), tolerance)) - 1
    least = np.pi / np.arccos(1.0 - tolerance / radius)
    assert least <= chords <= 1.15 * least + 1.0


def distances_to(points, start, end):
    """Of each point to the segment of its own."""
    chord = end - start
    along = np.clip(((points - start) * chord).sum(1) / (chord**2).sum(1), 0, 1)
    return np.linalg.norm(points - start - along[:, None] * chord, axis=1)


def test_orders_of_chords_arcs_and_cubics():
    """Halving the tolerance by a factor of 2^n doubles the pieces: n = 2, 3 and 4."""
    one = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (3, 5), (7, -2), (9, 4)], [1, 2, 1, 2])
    rows = _pieces.bezier_rows(one)
    tolerances = np.geomspace(1e-3, 1e-9, 13)
    for order, count in (
        (2, lambda tolerance: len(_pieces.chord_points(one, 1e2 * tolerance)) - 1),
        (3, lambda tolerance: len(_pieces.biarcs(rows, tolerance)[1])),
        (4, lambda tolerance: len(_pieces.cubic_rows(rows, tolerance))),
    ):
        slope = np.polyfit(np.log(tolerances), np.log([count(t) for t in tolerances]), 1)[0]
        assert slope == pytest.approx(-1 / order, rel=0.1)


def test_a_tolerance_that_cannot_be_kept_is_refused_at_once():
    rows = _pieces.bezier_rows(curve(dim=2))
    for fits in (lambda rows: np.arange(len(rows)) > 0, lambda rows: np.zeros(len(rows), bool)):
        with pytest.raises(ValueError, match=r"^tolerance: it would take more than 1000000 pieces, or"):
            _pieces.split_until(rows, fits)  # a single piece that never fits, and all


def arcs_of(file):
    """Start, end, offset of the centre, and sense of every arc in the plane XY."""
    at, found = {}, []
    for line in words(file):
        if line.get("G") in (2, 3):
            found.append(((at["X"], at["Y"]), (line["X"], line["Y"]), (line["I"], line["J"]), line["G"]))
        if line.get("G") in (0, 1, 2, 3):
            at |= line
    return found


@pytest.mark.parametrize("one", [nl.paper.CURVE, curve(3, 9, 2, seed=4)])
def test_arcs_close_and_keep_the_tolerance(tmp_path, one):
    file = nl.export(tmp_path / "arcs.ngc", one, dialect="arcs", **PLANE)
    found = arcs_of(file)
    assert len(found) > 4
    for start, end, offset, sense in found:
        start, end, centre = np.array(start), np.array(end), np.add(start, offset)
        radii = np.linalg.norm([start - centre, end - centre], axis=1)
        assert abs(radii[0] - radii[1]) < 3e-7
        first, last = (np.arctan2(*(p - centre)[::-1]) for p in (start, end))
        turn = (last - first) % (2 * np.pi) - (0 if sense == 3 else 2 * np.pi)
        assert abs(turn) < np.pi
        angle = first + np.linspace(0, turn, 9)
        points = centre + radii[0] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        assert one.closest_point(points)[1].max() <= ASKED["tolerance"]


def test_arcs_of_other_planes_and_chords_elsewhere(tmp_path):
    lift = {"G18": [(1, 0), (0, 0), (0, 1)], "G19": [(0, 0), (1, 0), (0, 1)], "G17": [(1, 0), (0, 1), (0, 0)]}
    for plane, matrix in lift.items():
        text = nl.export(
            tmp_path / "a.ngc", nl.paper.CURVE.transform(matrix), dialect="arcs", **ASKED
        ).read_text()
        assert re.findall("^G1[789]$", text, re.MULTILINE) == [plane]
        assert len(re.findall("^G[23] ", text, re.MULTILINE)) > 10
    flat = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0), (50, 1e-8), (100, 0)])  # of a radius of 10^11 mm
    for one, options in ((curve(), ASKED), (flat, PLANE)):
        text = nl.export(tmp_path / "a.ngc", one, dialect="arcs", **options).read_text()
        assert not re.search("^G[23] ", text, re.MULTILINE)


def test_heidenhain_pieces_start_where_the_last_one_ends(tmp_path):
    text = nl.export(tmp_path / "a.ngc", curve(dim=3), dialect="heidenhain", **ASKED).read_text()
    blocks = re.findall(r"SPL (.*) ~\n(.*) ~\n(.*) ~\n(.*)", text)
    numbers = [[[float(w) for w in re.findall(r"[-+][\d.]+", line)] for line in block] for block in blocks]
    assert len(numbers) > 20
    for (end, *axes), (end2, *axes2) in itertools.pairwise(numbers):
        powers, after = np.array([k[:3] for k in axes]), np.array([k[:3] for k in axes2])
        assert np.linalg.norm(after.sum(axis=1) + end2 - end) < 1e-6  # t runs from 1 to 0
        out, on = powers[:, 2], after @ [3, 2, 1]
        sine = np.linalg.norm(np.cross(out, on)) / np.linalg.norm(out) / np.linalg.norm(on)
        assert np.degrees(sine) < 0.1
        assert np.abs(powers).max() < 10  # more would need an exponent


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("units", ["mm", "inch"])
def test_every_line_is_short_and_plain(tmp_path, dialect, units):
    one = curve(5, 12, 2, seed=6).scale(10).translate((9e5, -9e5))
    file = nl.export(tmp_path / "a.ngc", one, dialect=dialect, **{**PLANE, "units": units, "tolerance": 1.0})
    lines = file.read_text().splitlines()
    assert max(map(len, lines)) <= 80
    assert not re.search(r"\d[eE][-+]?\d", file.read_text())
    assert not re.search(r"nan|inf\b", file.read_text())


@pytest.mark.parametrize("dialect", ["linuxcnc", "siemens", "fanuc", "heidenhain"])
def test_a_degree_too_high_is_approximated_and_said(tmp_path, dialect):
    high, low = (
        nl.export(tmp_path / f"{p}.ngc", curve(p, 8, 2, rational=False), dialect=dialect, **PLANE)
        for p in (5, 3)
    )
    assert "within 0.01 mm" in high.read_text()
    assert "within" not in low.read_text()
    exact = {name: value for name, value in PLANE.items() if name != "tolerance"}
    assert nl.export(low, curve(3, 8, 2, rational=False), dialect=dialect, **exact)
    with pytest.raises(ValueError, match=r"^tolerance must be given"):
        nl.export(low, curve(5, 8, 2, rational=False), dialect=dialect, **exact)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_program_keeps_its_moves_and_feeds(tmp_path, dialect):
    text = nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, **MOVES).read_text()
    assert len(re.findall("FMAX|^G0 ", text, re.MULTILINE)) == 4
    assert re.findall(r"F(\d+)", text) == ["120", "600", "120", "600"]
    with pytest.raises(ValueError, match=r"^feed = 3\.0: every move of a program has its own feed"):
        nl.export(tmp_path / "b.ngc", milling(), dialect=dialect, **ASKED | {"feed": 3.0})


TO_MILL = milling().moves


@pytest.mark.parametrize(
    ("items", "options", "said"),
    [
        ([path()], {"feed": 3.0}, "^feed, .* in mm .*give a dialect"),  # a tool path alone has its own
        ([curve(dim=2)], {**PLANE, "dialect": "arcs", "tolerance": 1e-18}, "^tolerance must be at least"),
        (
            [curve(dim=2)],
            {**PLANE, "setup": nl.Setup(1, 9, 50.0)},
            "^axes: a setup moves Z.* give a curve in",
        ),
        ([curve()], {**ASKED, "dialect": "linuxcnc"}, r"leaves the plane XY.*dialect='arcs'"),
        (
            [curve(dim=2)],
            {**PLANE, "dialect": "linuxcnc", "axes": "XZ"},
            "^axes: G5.2 moves X and Y, got 'XZ'",
        ),
        (
            [Program((*TO_MILL[:3], *TO_MILL[4:]))],
            MOVES,
            r"moves\[3\] begins .* mm from where moves\[2\] ends",
        ),
        ([Program((Move("rapid", TO_MILL[2].curve, 1.0),))], MOVES, r"moves\[0\] is rapid and curved"),
        ([nl.paper.CURVE] * 2, PLANE, "file holds one curve, path or program"),
        ([nl.paper.CURVE.scale(1e6)], PLANE, "too large to write; shift the part"),
    ],
)
def test_what_no_program_can_be_is_refused(tmp_path, items, options, said):
    with pytest.raises(ValueError, match=said):
        nl.export(tmp_path / "a.ngc", *items, **options)


ROUND = "G21 G90 {plane}\nG0 X0 Y0 Z0\nF600\n{block}\nM2\n"


@pytest.mark.parametrize("dialect", ["arcs", "siemens", "fanuc", "heidenhain"])
@pytest.mark.parametrize(("plane", "letters"), [("G17", "XYZIJ"), ("G18", "ZXYKI"), ("G19", "YZXJK")])
@pytest.mark.parametrize(
    ("block", "turns"),
    [
        *(("G2 I5 J3", 1), ("G3 X7 Y4 R40", 1), ("G2 X7 Y5 Z6 R-9", 1), ("G3 X0 Y0 Z4 I5 J5", 1)),
        *(("G2 X8 Y3 Z5 R12", 1), ("G3 X10 Y0 Z4 I5 J5 P3", 3)),
    ],
)
def test_what_was_read_as_one_arc_is_written_as_one(tmp_path, dialect, plane, letters, block, turns):
    """Circles, arcs of more and of less than half a turn, and helices, of several turns too."""
    block = block.translate(str.maketrans("XYZIJ", letters))
    (tmp_path / "a.ngc").write_text(ROUND.format(plane=plane, block=block))
    one = nl.read(tmp_path / "a.ngc")
    file = nl.export(tmp_path / "b.ngc", one, dialect=dialect, **MOVES)
    assert len(re.findall("^G[23] | DR[-+]", file.read_text(), re.MULTILINE)) == turns
    assert not re.search("^G1 |SPL|BSPLINE|G6.2", file.read_text(), re.MULTILINE)
    moves, (one,) = nl.read(file).moves, one.moves
    points = np.vstack([move.curve(np.linspace(*move.curve.domain, 50)) for move in moves])
    np.testing.assert_allclose(one.curve.closest_point(points)[1], 0, atol=3e-6)
    assert sum(move.curve.length() for move in moves) == pytest.approx(one.curve.length())


@pytest.mark.parametrize("units", ["Millimetres", "in"])
def test_a_program_of_heidenhain_with_few_digits_comes_back(tmp_path, units):
    """Each spline begins at the rounded end of the move before it, be it an arc, a helix or a spline."""
    blocks = (
        "G3 X20 Y0 Z-3 I10 J0\nG5 I1 J2 P-2 Q3 X30.1234 Y5\nG2 X31.2345 Y7.3456 R3\nG5 I1 J2 P-2 Q3 X40 Y5"
    )
    (tmp_path / "a.ngc").write_text(ROUND.format(plane="G17", block=blocks + "\nG2 X43.1234 Y5.7 Z-8 R7"))
    one, setup = nl.read(tmp_path / "a.ngc"), nl.Setup(tool=1, spindle_rpm=9, safe_z_mm=80.0, digits=3)
    options = {**MOVES, "units": units, "tolerance": 0.05, "dialect": "heidenhain", "setup": setup}
    two = nl.read(nl.export(tmp_path / "b.ngc", one, **options))
    points = np.vstack([move.curve(np.linspace(*move.curve.domain, 9)) for move in two.moves[2:-1]])
    assert np.min([move.curve.closest_point(points)[1] for move in one.moves], axis=0).max() < 2e-3


def test_straight_moves_are_written_from_their_table(tmp_path):
    """In as many strokes as the file has kinds and feeds, and as one by one."""
    blocks = "\n".join(f"G{1 - i % 7 // 6} X{i % 5} Y{i / 8} F{600 + i // 50}" for i in range(200))
    (tmp_path / "a.ngc").write_text(ROUND.format(plane="G17", block=blocks + "\nG2 I3\nX9 R8"))
    one = nl.read(tmp_path / "a.ngc")
    files = [tmp_path / name for name in ("b.ngc", "c.ngc")]
    for file, moves in zip(files, (one.moves, tuple(one.moves)), strict=True):
        nl.export(file, Program(moves), dialect="heidenhain", **MOVES)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert len([*one.moves.strokes()]) < len(one.moves) / 2


def test_no_arc_is_too_small_for_linuxcnc(tmp_path):
    """Its interpreter refuses radii of 1 to 2 µm; the turn of this curve has one of 12 nm."""
    turning = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (10, 10), (0, 10), (10, 0.1)])
    file = nl.export(tmp_path / "a.ngc", turning, dialect="arcs", **{**PLANE, "tolerance": 1e-4})
    assert all(np.hypot(*offset) > 2e-3 for _, _, offset, _ in arcs_of(file))
    points = np.concatenate([move.curve(np.linspace(*move.curve.domain, 9)) for move in nl.read(file).moves])
    assert turning.closest_point(points[:, :2])[1].max() <= 1e-4


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5])
def test_a_sharp_place_leaves_arcs_elsewhere(tmp_path, tolerance):
    points = np.random.default_rng(5).normal(size=(8, 3))[:5, :2] * 10
    sharp = nl.NurbsCurve(2, [0, 0, 0, 0.3, 0.6, 1, 1, 1], points)  # its least radius is 0.2 µm
    file = nl.export(tmp_path / "a.ngc", sharp, dialect="arcs", **{**PLANE, "tolerance": tolerance})
    lines = len(re.findall("^G1 ", file.read_text(), re.MULTILINE))
    assert lines <= 16 < 20 < len(arcs_of(file))
    assert min(np.hypot(*offset) for _, _, offset, _ in arcs_of(file)) > 2e-3
    points = np.concatenate([move.curve(np.linspace(*move.curve.domain, 9)) for move in nl.read(file).moves])
    assert sharp.closest_point(points[:, :2])[1].max() <= tolerance


def test_no_power_of_heidenhain_needs_an_exponent(tmp_path):
    large, options = curve(3, 8, 3, rational=False).scale(20), {**ASKED, "dialect": "heidenhain"}
    text = nl.export(tmp_path / "a.ngc", large, **options).read_text()
    assert max(abs(float(k)) for k in re.findall(r"K\d[XYZ](\S+)", text)) <= 9.99999999
    small = nl.export(tmp_path / "b.ngc", large.scale(1e-4), **options).read_text()
    assert small.count("SPL ") == 5 < text.count("SPL ")


SETUP = nl.interchange.Setup(tool=3, spindle_rpm=8000, safe_z_mm=50.0, coolant="flood", number=77)


@pytest.mark.parametrize(("offset", "word"), [(54, "G54"), (57, "G57"), (58, "G505"), (59, "G506")])
def test_siemens_selects_its_own_offsets(tmp_path, recwarn, offset, word):
    """G58 and G59 are shifts that can be programmed there."""
    setup = nl.Setup(tool=1, spindle_rpm=100, safe_z_mm=50.0, offset=offset)
    file = nl.export(tmp_path / "a.ngc", milling(), dialect="siemens", setup=setup, **MOVES)
    assert f"G40 {word}\n" in file.read_text()
    assert len(nl.read(file).moves) > 6
    assert not recwarn
    with pytest.raises(TypeError, match="clockwise must be True or False"):
        replace(setup, clockwise="ccw")


@pytest.mark.parametrize("dialect", [name for name in DIALECTS if name != "linuxcnc"])
@pytest.mark.parametrize("units", ["mm", "inch"])
def test_a_setup_starts_and_ends_a_program(tmp_path, dialect, units):
    options = {**MOVES, "units": units, "dialect": dialect}
    text = nl.export(tmp_path / "a.ngc", milling(), setup=SETUP, **options).read_text()
    if dialect == "heidenhain":
        wanted = ["TOOL CALL 3 Z S8000", "R0 FMAX M3", "M8", "SPL", "M9", "M5", "M30", "END PGM"]
    else:
        first, last = (["%_N_MPF77_MPF"], []) if dialect == "siemens" else (["%", "O77"], ["%"])
        wanted = [*first, "G54", "T3 M6", "S8000 M3", "G0 ", "M8", "M9", "M5", "M", *last]
        assert (dialect == "siemens") != ("G80" in text)
    places = [text.index(wanted[0])]
    for word in wanted[1:]:
        places.append(text.index(word, places[-1] + 1))
    digits = max(len(n.partition(".")[2]) for n in re.findall(r"(?<!\d)[XYZIJ][-+]?([\d.]+)", text))
    assert digits <= (4 if units == "mm" else 5)
    moves = nl.read(tmp_path / "a.ngc").moves
    first, last = moves[0].curve, moves[-1].curve
    assert first(first.domain[0])[2] == last(last.domain[1])[2] == pytest.approx(50.0, abs=1e-3)
    np.testing.assert_allclose(np.diff(first(first.domain), axis=0)[0, :2], 0, atol=1e-9)  # straight down
    assert "moves only" not in text
    assert "moves only" in nl.export(tmp_path / "b.ngc", milling(), **options).read_text()
