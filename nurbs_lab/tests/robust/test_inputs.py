"""Whatever holds the same numbers gives the same bytes; whatever does not is refused by name."""

import re
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.robust import hostile
from nurbs_lab.tests.robust.calls import BALL, fingerprint
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import ARRAYS, CALLS
from nurbs_lab.tests.robust.calls_pictures import PICTURES, TIMED
from nurbs_lab.tests.robust.certificates import wrong
from nurbs_lab.tests.robust.hostile import locked, strided

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


def answer_or_refusal(call, good, argument, bad):
    """The answer, or the words with which a bad argument is refused; a warning is an error."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return call(**{**good, argument: bad}), ""
    except (ValueError, TypeError, OSError) as error:
        return None, str(error)


def names_it(said, argument, good, bad):
    """Whether a refusal has the argument as a whole word, and shows a wrong number where one is wanted.

    Of arrays that have to agree in size, it may name the other one.
    """
    wanted = good[argument]
    resized = isinstance(wanted, np.ndarray) and isinstance(bad, np.ndarray) and wanted.shape != bad.shape
    names = "|".join(good) if resized else argument
    if not re.search(rf"(?<![A-Za-z0-9_])({names})(?![A-Za-z0-9_])", said):
        return False
    if not re.match(rf"{argument}\b", said):
        return True  # where two arguments disagree, the other one may come first
    numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in (wanted, bad))
    if numbers and abs(bad) < 1e50:
        return any(form in said for form in (repr(bad), f"{bad:g}", repr(float(bad))))
    return True


def tried(calls, examples):
    """A test with bad arguments for each of the calls; the same ones on every run."""

    @pytest.mark.parametrize("name", [name for name in calls if calls[name][1]])
    def test(name):
        call, good = calls[name]
        for k in range(examples):
            rng = np.random.default_rng([k, *name.encode()])
            argument = str(rng.choice(list(good)))
            spoil = hostile.array if isinstance(good[argument], np.ndarray) and k % 2 else hostile.nonsense
            bad = spoil(rng, good[argument])
            result, said = answer_or_refusal(call, good, argument, bad)
            assert not said or names_it(said, argument, good, bad), f"{argument} = {bad!r}: {said}"
            assert len(said) < 1000
            assert said or calls is not CALLS or wrong(call, {**good, argument: bad}, result) == ""

    return test


test_bad_arguments_are_refused_by_name = tried(CALLS, 30)
test_bad_arguments_of_the_hardware_are_refused_by_name = tried(HARDWARE, 15)
test_bad_arguments_of_pictures_are_refused_by_name = tried(PICTURES | TIMED, 15)
