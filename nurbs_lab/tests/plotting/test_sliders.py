"""Pictures with sliders, and what they refuse."""

import warnings

import pytest

import nurbs_lab as nl


def line(height):
    return nl.plotting.lines([0, 1], [0, height], x_label="x", y_label="y")


WRONG = [(5, 1), (1, 5, 0), (1.0, float("nan")), (1,), (1, 2, 3, 4), ("a", "b"), []]


@pytest.mark.parametrize("places", WRONG)
def test_a_slider_that_cannot_be_is_refused(places):
    with pytest.raises(ValueError, match=r"height must be \(first, last\) or .*rising, or a list"):
        nl.plotting.explore(line, height=places)


def test_a_slider_begins_where_it_can_stand():
    browser = nl.plotting.explore(line, height=(5, 15, 2))
    assert browser.values() == {"height": 9}


def test_the_line_below_tells_of_errors_and_warnings():
    def draw(height):
        if height == 4:
            warnings.warn("a steep <line>", stacklevel=1)
        return line(height) if height < 5 else None

    browser = nl.plotting.explore(draw, height=(1, 5))
    height = browser.controls["height"]
    height.value = 4
    assert browser.status.value == "a steep &lt;line&gt;"
    before = browser.picture.value
    height.value = 5
    said = "no Figure, must be a Plotter, got NoneType; what is shown is the last result"
    assert said in browser.status.value
    assert browser.picture.value == before
