"""Plane pictures in words: what a notebook stores as alternative text."""

import base64

import nurbs_lab as nl
from nurbs_lab.plotting.picture import words

plot = nl.plotting


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
