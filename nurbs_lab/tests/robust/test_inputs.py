"""Whatever holds the same numbers gives the same bytes; whatever does not is refused by name."""

import re
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import BALL, fingerprint, leaves
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import ARRAYS, CALLS
from nurbs_lab.tests.robust.calls_pictures import PICTURES, TIMED
from nurbs_lab.tests.robust.hostile import SPOILS, WORDS, locked, strided

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


@pytest.mark.parametrize(("name", "argument"), ARRAYS)
def test_masked_entries_are_refused(name, argument):
    call, good = CALLS[name]
    masked = np.ma.array(good[argument], mask=False)
    masked[(0,) * masked.ndim] = np.ma.masked
    with pytest.raises(ValueError, match=rf"{argument} has masked entries"):
        call(**{**good, argument: masked})


SCALES = [1e-300, 1e-160, 1e-50, 1e50, 1e99, 1e300, -1.0, 0.0]


@st.composite
def spoiled(draw, value):
    """Nonsense; or a good array with one bad number, one row less or more, another order, another scale."""
    way = draw(st.integers(0, 6))
    if not isinstance(value, np.ndarray) or way <= 1:
        return draw(st.sampled_from(WORDS))
    if way == 2:
        return draw(
            st.sampled_from([value[:-1], value[:1], value[::-1], value[None], np.repeat(value, 2, axis=0)])
        )
    with np.errstate(all="ignore"):  # of single precision
        if way == 3:
            return value * draw(st.sampled_from(SCALES))
        if way == 4:
            return value + draw(st.sampled_from([1e10, -1e17, 1e99]))
    if way == 5:
        return value.astype(draw(st.sampled_from([complex, str, bool, object, "S", np.longdouble])))
    value = value.astype(float)
    value.flat[draw(st.integers(0, value.size - 1))] = draw(st.sampled_from(SPOILS))
    return value


def answer_or_refusal(call, good, argument, bad):
    """The answer, or the words with which a bad argument is refused; a warning is an error."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return call(**{**good, argument: bad}), ""
    except (ValueError, TypeError, OSError) as error:
        return None, str(error)


def names_it(said, argument, good, bad):
    """Whether a refusal has the argument as a whole word, and shows a wrong number where one is wanted."""
    if not re.search(rf"(?<![A-Za-z0-9_]){argument}(?![A-Za-z0-9_])", said):
        return False
    if not re.match(rf"{argument}\b", said):
        return True  # where two arguments disagree, the other one may come first
    numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in (good, bad))
    if numbers and abs(bad) < 1e50:
        return any(form in said for form in (repr(bad), f"{bad:g}", repr(float(bad))))
    return True


def tried(calls, examples):
    """A test with bad arguments for each of the calls."""

    @pytest.mark.parametrize("name", calls)
    def test(name):
        call, good = calls[name]

        @settings(
            max_examples=examples, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck)
        )
        @given(st.data())
        def run(data):
            argument = data.draw(st.sampled_from(list(good)))
            bad = data.draw(
                spoiled(good[argument]).filter(lambda bad: not callable(good[argument]) or not callable(bad))
            )
            result, said = answer_or_refusal(call, good, argument, bad)
            assert not said or names_it(said, argument, good[argument], bad), f"{argument} = {bad!r}: {said}"
            assert len(said) < 1000
            if calls is CALLS:
                assert not any(leaf.dtype.kind == "f" and np.isnan(leaf).any() for leaf in leaves(result))

        if good:
            run()

    return test


test_bad_arguments_are_refused_by_name = tried(CALLS, 30)
test_bad_arguments_of_the_hardware_are_refused_by_name = tried(HARDWARE, 15)
test_bad_arguments_of_pictures_are_refused_by_name = tried(PICTURES | TIMED, 15)
