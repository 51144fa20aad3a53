"""Whatever holds the same numbers gives the same bytes; whatever does not is refused by name."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import BALL, CALLS, fingerprint, leaves

ARRAYS = [
    (name, argument)
    for name, (_, good) in CALLS.items()
    for argument, value in good.items()
    if isinstance(value, np.ndarray)
]


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
    "objects": lambda array: array.astype(object),
    "Fortran": np.asfortranarray,
    "strided": strided,
    "backwards": lambda array: array[::-1].copy()[::-1],
    "read-only": locked,
    "nothing masked": np.ma.array,
}


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


@pytest.mark.parametrize("name", CALLS)
def test_arguments_are_left_as_they_were(name):
    call, good = CALLS[name]
    before = [fingerprint(value) for value in good.values()]
    call(**good)
    assert [fingerprint(value) for value in good.values()] == before


@pytest.mark.parametrize(("name", "argument"), ARRAYS)
def test_masked_entries_are_refused(name, argument):
    call, good = CALLS[name]
    masked = np.ma.array(good[argument], mask=False)
    masked[(0,) * masked.ndim] = np.ma.masked
    with pytest.raises(ValueError, match=rf"{argument} has masked entries"):
        call(**{**good, argument: masked})


WORDS = [None, "nonsense", b"x", {}, object(), [], [[]], [[1, 2], [3]], [None], ["a"], np.datetime64("2020")]
NUMBERS = [np.nan, np.inf, -np.inf, 1e300, 10**400, -1, 0, -0.5, 1j, True]
SHAPES = [np.zeros((0, 3)), np.zeros((2, 2, 2, 2)), np.full((5, 3), np.nan), np.full((5, 3), np.inf)]


@st.composite
def spoiled(draw, value):
    """Nonsense, or a good array with one bad number in it or one row less."""
    way = draw(st.integers(0, 3))
    if not isinstance(value, np.ndarray) or way == 0:
        return draw(st.sampled_from([*WORDS, *NUMBERS, *SHAPES]))
    if way == 1:
        return value[:-1]
    value = value.astype(float)
    value.flat[draw(st.integers(0, value.size - 1))] = draw(st.sampled_from([np.nan, np.inf, -np.inf, 1e300]))
    return value


@pytest.mark.parametrize("name", CALLS)
def test_bad_arguments_are_refused_by_name(name):
    call, good = CALLS[name]
    names = re.compile("|".join(argument.removesuffix("s") for argument in good))

    @settings(max_examples=40, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def run(data):
        argument = data.draw(st.sampled_from(list(good)))
        bad = data.draw(spoiled(good[argument]))
        said, result = "", None
        try:
            result = call(**{**good, argument: bad})
        except (ValueError, TypeError, FileNotFoundError) as error:
            said = str(error)
        assert not said or names.search(said)
        assert not any(leaf.dtype.kind == "f" and np.isnan(leaf).any() for leaf in leaves(result))

    run()
