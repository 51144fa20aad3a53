"""A file with a part missing is refused, or warned of by its name; it is never read short without a word."""

import random
import warnings

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.interchange import _opencascade
from nurbs_lab.tests.interchange.shapes import curve, path, surface

BALL = trimesh.creation.icosphere(subdivisions=2)
ASKED = {"feed": 10.0, "tolerance": 0.1, "units": "mm", "axes": "XY"}
#: End of a file's name -> what writes it.
TEXTS = {
    ".obj": BALL.export,
    ".ply": BALL.export,
    ".stl": BALL.export,
    ".off": BALL.export,
    ".txt.ply": lambda file: BALL.export(file, encoding="ascii"),
    ".txt.stl": lambda file: BALL.export(file, file_type="stl_ascii"),
    ".cloud.ply": lambda file: trimesh.PointCloud(BALL.vertices).export(file, encoding="ascii"),
    ".json": lambda file: nl.export(file, curve(), curve()),
    **{
        f".{dialect}.ngc": lambda file, dialect=dialect: nl.export(
            file, nl.paper.CURVE, dialect=dialect, **ASKED
        )
        for dialect in ("g1", "arcs", "linuxcnc", "heidenhain", "fanuc")
    },
}


def pieces_missing(whole, rounds, seed):
    """The file cut off, with a stretch of bytes lost, and with a line lost."""
    rng = random.Random(seed)
    for _ in range(rounds):
        a, b = sorted(rng.randrange(len(whole)) for _ in range(2))
        yield whole[:b]
        yield whole[:a] + whole[b:]
        lines = whole.splitlines(keepends=True)
        yield b"".join(line for i, line in enumerate(lines) if i != rng.randrange(len(lines)))


def is_said(file):
    """Whether reading the file is refused, or warned of, by its name."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        try:
            nl.read(file)
        except (ValueError, UserWarning) as said:
            return file.name in str(said)
    return False


@pytest.mark.parametrize("suffix", [".step", ".igs"])
def test_lost_pieces_of_cad_files(suffix, tmp_path, monkeypatch):
    monkeypatch.setattr(_opencascade, "PATIENCE_S", 20)  # a library may hang on a damaged file
    whole = nl.export(tmp_path / f"whole{suffix}", curve(), surface()).read_bytes()
    file = tmp_path / f"bad{suffix}"
    for content in (b"", bytes(range(256)), *pieces_missing(whole, 3, seed=5)):
        file.write_bytes(content)
        if not is_said(file):  # what was lost says nothing of the shapes, such as the program's name
            assert len(nl.read(file)) == 2


@pytest.mark.parametrize("root", [r"SHAPE_DEFINITION_REPRESENTATION", "CARTESIAN_POINT", "END-ISO"])
def test_a_step_file_without_one_of_its_lines(root, tmp_path):
    file = nl.export(tmp_path / "part.step", curve(), surface())
    statements = file.read_text().split(";\n")
    lost = max(i for i, statement in enumerate(statements) if root in statement)
    file.write_text(";\n".join(statements[:lost] + statements[lost + 1 :]))
    with pytest.raises(ValueError, match=r"missing|Unresolved Reference"):
        nl.read(file)


@pytest.mark.filterwarnings("error::UserWarning")
@pytest.mark.parametrize(
    ("suffix", "whole", "damaged", "said"),
    [
        (".step", "(1.,0.,", "(1.,0..5,", r"its '0\.\.5' is no number"),
        (".step", "= CARTESIAN_POINT(", "= CARTESIAN_P:INT(", "it is damaged"),
        (".step", "= GEOMETRIC_CURVE_SET(", "= GEOETRIC_CURVE_SET(", "not know, such as 'Parameter"),
        (".igs", "0.000000000000000E+00,", "0.0\x7f0000000000000E+00,", r"its field '0\.0.*' is damaged"),
        (".igs", "     126       0", "     126    x  0", "its entry '126    x  0"),
    ],
)
def test_a_damaged_number_or_word_of_a_cad_file_is_said(suffix, whole, damaged, said, tmp_path):
    file = nl.export(tmp_path / f"part{suffix}", curve())
    text = file.read_text()
    assert whole in text
    file.write_text(text.replace(whole, damaged, 1))
    with pytest.raises((ValueError, UserWarning), match=said):
        nl.read(file)


def test_faces_that_are_named_and_not_found_are_warned_of(tmp_path):
    file = nl.export(tmp_path / "part.step", surface(), surface(seed=3))
    text = file.read_text()
    file.write_text(text.replace("OPEN_SHELL('',", "OPEN_SHELL_OF_TOMORROW('',", 1))
    with pytest.warns(UserWarning, match="part.step names 2 faces, and OpenCASCADE reads only 1"):
        assert len(nl.read(file)) == 1


@pytest.mark.parametrize("suffix", TEXTS)
def test_files_cut_in_the_middle(suffix, tmp_path):
    file = tmp_path / f"part{suffix}"
    TEXTS[suffix](file)
    whole = file.read_bytes()
    assert not is_said(file)
    for part in np.linspace(0.05, 0.95, 23):
        file.write_bytes(whole[: int(part * len(whole))])
        assert is_said(file)


@pytest.mark.parametrize(
    ("suffix", "lost"),
    [
        (".txt.stl", (1, 3, 7, -1)),
        (".txt.ply", (12, 50, -1)),
        (".off", (1, 2, 50, 200, -1)),
        (".cloud.ply", (9, 50, -1)),
        (".csv", (0, 1, 5)),
        (".heidenhain.ngc", (2, 3, 4, 8)),
        (".fanuc.ngc", (4, 5, 6, -3, -4)),
    ],
)
def test_a_text_with_a_line_lost_or_doubled(suffix, lost, tmp_path):
    file = tmp_path / f"part{suffix}"
    TEXTS[suffix](file) if suffix in TEXTS else nl.export(file, path())
    lines = file.read_bytes().splitlines(keepends=True)
    for i in lost:
        for found in ([], 2 * [lines[i]]):
            file.write_bytes(b"".join(lines[:i] + found + lines[i:][1:]))
            assert is_said(file), (lines[i], found)


def test_json_that_holds_fewer_shapes_than_it_promises(tmp_path):
    file = nl.export(tmp_path / "part.json", curve(), curve())
    file.write_text(file.read_text().replace('"count": 2', '"count": 3'))
    with pytest.raises(ValueError, match="promises 3 shapes and holds 2"):
        nl.read(file)


CURVE_OF_JSON = """{"shape": {"type": "curve", "data": [{"degree": 1, "knotvector": [0, 0, 1, 1],
"control_points": {"points": [[0, 0], [1, 1]], "weIghts": [1, 2]}}]}}"""


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.json", '{"a": 1}', "missing, or of another kind: 'shape'; a file of geomdl is"),
        ("a.json", "[1]", "missing, or of another kind: .*; a file of geomdl is"),
        ("a.json", '{"shape": {"type": "volume"}}', "missing, or of another kind: 'volume'; a file"),
        ("a.json", '{"shape": {"type": "curve", "data": [{"degree": 2}]}}', "missing.*: 'knotvector'; a"),
        ("a.json", CURVE_OF_JSON, "missing, or of another kind: .*'weIghts'"),
        ("a.csv", "x,y\n1,2#5\n", "a number of it goes on with '#'"),
        ("a.csv", "nan,0\n1,2\n", r"the table\[0, 0\] is nan"),
        ("a.csv", "0,0,0,0,0\n1,0,3,4,5\n3,1,0,0,2.5\n", "a line is missing"),
        ("a.csv", "1,0,3,4,5\n3,1,0,0,2.5\n", "a line is missing"),
        (
            "a.txt",
            "0 l.5\n1 2\n",
            "could not convert string 'l.5' of line 1; make it 2 numbers separated by bl",
        ),
        ("a.csv", "# A\nx,y\n1\t2\n", r"could not convert string '1.t2' of line 3; .* by commas"),
        ("a.csv", "1,2,3\n4,5\n", "could not convert string '4,5' of line 2; make it 3 numbers"),
        (
            "a.csv",
            "id,x,y\n1,2,3\n",
            "its first line 'id,x,y' is neither .* names .*; name columns x, y and z",
        ),
        ("a.txt", "1 2 3 255 0 0\n", "its rows have 6 numbers; name x, y and z of them in a first line"),
        ("a.csv", "x;y\n1,5;2.5\n", "its numbers have points and decimal commas; write all of them with"),
        ("a.csv", "i,x,y,z\n1,2,3,4\n2,3,4\n", "could not convert string '2,3,4' of line 3; make it 4 numb"),
        ("a.csv", '"1,5","2,5"\n"3","4"\n', "its first line .* is neither numbers nor names"),
        ("a.csv", "x,y[acre]\n1,2\n", "its first line .* is neither numbers nor names"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "it has lines and no face; give it faces, or points alone"),
        ("a.stl", "version of a file " * 9, "it is neither text .*; it begins with 'version of a file"),
        ("a.stl", "", "it is neither text that begins with 'solid' nor binary: 0 bytes"),
    ],
)
def test_a_file_of_something_else_is_refused_once_and_says_what_is_wanted(tmp_path, name, content, said):
    (tmp_path / name).write_text(content)
    with pytest.raises(ValueError, match=rf"^path: '.*{name}' cannot be read: {said}"):
        nl.read(tmp_path / name)


def test_a_reader_without_end_is_stopped(tmp_path, monkeypatch):
    program, file = tmp_path / "reader.py", nl.export(tmp_path / "part.step", curve())
    monkeypatch.setattr(_opencascade, "MEMORY_BYTES", 10**8)
    with pytest.raises(ValueError, match=r"more than 0\.1 GB|crashed on it"):
        nl.read(file)
    program.write_text("import time\ntime.sleep(60)")
    monkeypatch.setattr(_opencascade, "READER", program)
    file.write_bytes(b"x" * 10**6)
    monkeypatch.setattr(_opencascade, "PATIENCE_S", 0.2)
    monkeypatch.setattr(_opencascade, "PATIENCE_S_PER_MB", 0.3)  # the limit of time grows with the file
    with pytest.raises(ValueError, match=r"OpenCASCADE found no end of it in 0\.5 s"):
        _opencascade.found_by_reader(file, "STEP")
