"""A number is a number in any dress: each argument in every kind of NumPy's, each array in every form."""

import contextlib
import re
from types import SimpleNamespace

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange import shapes
from nurbs_lab.tests.robust.calls import BALL, QUICK, fingerprint
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import ARRAYS, CALLS

KINDS = "int8 uint8 int16 uint16 int32 int64 uint64 float16 float32 float64 longdouble".split()  # noqa: SIM905


def strided(array):
    wide = np.full([2 * n for n in array.shape], np.nan)
    every_second = wide[(slice(None, None, 2),) * array.ndim]
    every_second[...] = array
    return every_second


def locked(array):
    array = array.copy()
    array.setflags(write=False)
    return array


FORMS = {
    "list": np.ndarray.tolist,
    "float32": lambda array: array.astype(np.float32),
    "big-endian": lambda array: array.astype(">f8"),
    "Fortran": np.asfortranarray,
    "strided": strided,
    "backwards": lambda array: array[::-1].copy()[::-1],
    "read-only": locked,
}


def dresses(value):
    """A number in each kind of NumPy's that holds it exactly; counts stay integers."""
    for kind in KINDS:
        with np.errstate(over="ignore", invalid="ignore"):
            dressed = np.asarray(value).astype(kind)[()]
        if float(dressed) == value and (isinstance(value, float) or np.issubdtype(kind, np.integer)):
            yield dressed


def numbers(good):
    return [name for name, value in good.items() if type(value) in (int, float) and value >= 0]


@pytest.mark.parametrize("name", [name for name, (_, good) in (CALLS | HARDWARE).items() if numbers(good)])
def test_the_kind_of_a_number_does_not_matter(name):
    """Each kind in turn for all arguments at once; a wrong answer shows whichever it came from."""
    call, good = (CALLS | HARDWARE)[name]
    expected = fingerprint(call(**good))
    dressed = {argument: list(dresses(good[argument])) for argument in numbers(good)}
    for k in range(max(map(len, dressed.values()))):
        given = {argument: found[k % len(found)] for argument, found in dressed.items() if found}
        assert fingerprint(call(**{**good, **given})) == expected, given


def outcome(call, given):
    """The answer's fingerprint, or the words of its refusal, without the name of a kind."""
    try:
        return fingerprint(call(**given))
    except Exception as error:
        return re.sub(r"np\.int8\((\d+)\)", r"\1", f"{type(error).__name__}: {error}")


COUNTS = [
    (name, argument)
    for name, (_, good) in (QUICK | HARDWARE).items()
    for argument in numbers(good)
    if type(good[argument]) is int
]


@pytest.mark.parametrize(("name", "argument"), COUNTS)
def test_nothing_is_added_up_in_the_kind_of_a_small_count(name, argument):
    call, good = (QUICK | HARDWARE)[name]
    small, plain = ({**good, argument: kind(100)} for kind in (np.int8, int))
    assert outcome(call, small) == outcome(call, plain)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("name", QUICK | HARDWARE)
def test_tiny_and_huge_numbers_are_answered_or_refused_without_warnings_of_numpy(name):
    call, good = (QUICK | HARDWARE)[name]
    for argument in numbers(good):
        for value in (1e-300, 1e96):
            with contextlib.suppress(ValueError, TypeError):
                call(**{**good, argument: value})


@pytest.mark.parametrize("dialect", nl.interchange.DIALECTS)
def test_the_kind_of_a_number_does_not_matter_in_a_program(dialect, tmp_path):
    asked = {"dialect": dialect, "tolerance": 0.5, "units": "mm", "axes": "XY"}
    for feed in (100.0, 2000.0):
        good = nl.export(tmp_path / "good.ngc", shapes.curve(dim=2), feed=feed, **asked).read_bytes()
        for dressed in dresses(feed):
            file = nl.export(tmp_path / "dressed.ngc", shapes.curve(dim=2), feed=dressed, **asked)
            assert file.read_bytes() == good, repr(dressed)


@pytest.mark.parametrize(("name", "argument"), ARRAYS)
def test_the_form_of_an_array_does_not_matter(name, argument):
    call, good = CALLS[name]
    expected = fingerprint(call(**good))
    for form, make in FORMS.items():
        given = make(good[argument])
        before = np.array(given)
        assert fingerprint(call(**{**good, argument: given})) == expected, form
        np.testing.assert_array_equal(given, before, err_msg=f"{form} was modified")


def test_the_form_of_a_mesh_does_not_matter():
    vertices = np.asarray(BALL.vertices).astype(np.float32).astype(float)
    faces = np.asarray(BALL.faces)
    expected = fingerprint(nl.slice_mesh(SimpleNamespace(vertices=vertices, faces=faces), [0.25]))
    for form, make in FORMS.items():
        mesh = SimpleNamespace(vertices=make(vertices), faces=faces.tolist() if form == "list" else faces)
        assert fingerprint(nl.slice_mesh(mesh, [0.25])) == expected, form
    for kind in ("int32", "uint16", ">i8"):
        mesh = SimpleNamespace(vertices=vertices, faces=np.asfortranarray(faces.astype(kind)))
        assert fingerprint(nl.slice_mesh(mesh, [0.25])) == expected, kind
