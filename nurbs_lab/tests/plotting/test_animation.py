"""What a notebook stores: animations with every frame, pictures with their words."""

import base64
import io
import itertools

import numpy as np
from PIL import Image

import nurbs_lab as nl


def draw(height):
    return nl.plotting.lines([0, 1], [0, height], x_label="x [mm]", y_label="y [mm]")


def test_every_frame_is_stored_with_its_time_and_the_words():
    moving = nl.plotting.animation(draw, [1.0, 2.0, 4.0], alt="a line that rises", frame_s=0.2)
    stored = Image.open(io.BytesIO(moving.data))
    assert (stored.format, stored.n_frames, stored.default_image) == ("PNG", 4, True)
    still = np.asarray(stored.convert("RGB"), dtype=int)
    frames = []
    for k in range(1, 4):
        stored.seek(k)
        frames.append(np.asarray(stored.convert("RGB"), dtype=int))
    assert all(np.abs(a - b).max() > 100 for a, b in itertools.pairwise(frames))
    assert np.array_equal(still, frames[-1])
    assert stored.info["duration"] > 0.2
    data, told = moving._repr_mimebundle_()
    assert told["image/png"]["alt"] == moving.alt == "a line that rises"
    assert data["text/plain"] == "<animation of 3 frames: a line that rises>"


def test_a_notebook_is_given_the_picture_and_its_words(monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda data, **more: shown.append((data, more)))
    draw(1.0)._ipython_display_()
    [(data, more)] = shown
    assert base64.b64decode(data["image/png"]).startswith(b"\x89PNG")
    assert more["metadata"] == {"image/png": {"alt": "y [mm] over x [mm]"}}
    of_now, told = draw(1.0).stored()._repr_mimebundle_()
    assert (of_now["image/png"], told) == (data["image/png"], more["metadata"])
