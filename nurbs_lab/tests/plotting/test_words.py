"""Plane pictures in words: what a notebook stores as alternative text."""

import base64

import nurbs_lab as nl
from nurbs_lab.plotting.picture import words

plot = nl.plotting


def test_labels_and_legend_are_told():
    figure = plot.lines(
        [1, 4], {"a": [2, 3], "b": [1, 10]}, x_label="t [s]", y_label="y [mm]", log="y", title="T"
    )
    assert words(figure) == "T: y [mm] over t [s], showing a, b"


def test_the_authors_words_come_first():
    figure = plot.show(plot.curve(nl.paper.CURVE), alt="a curve like a hill")
    assert words(figure) == "a curve like a hill"


def test_a_notebook_is_given_the_picture_and_its_words(monkeypatch):
    shown = []
    monkeypatch.setattr(
        "IPython.display.display", lambda data, **more: shown.append((data, more["metadata"]))
    )
    figure = plot.curve(nl.paper.CURVE)
    figure._ipython_display_()
    [(data, metadata)] = shown
    assert base64.b64decode(data["image/png"]).startswith(b"\x89PNG")
    assert metadata == {"image/png": {"alt": words(figure)}}
