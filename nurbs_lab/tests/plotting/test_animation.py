"""What a notebook stores: animations with every frame, pictures with their words."""

import base64
import io
import itertools

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image

import nurbs_lab as nl
from nurbs_lab.plotting import style


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


def test_two_pale_areas_keep_their_colours_among_many_others():
    """The shades of two limits differ by sixteen of 255 levels; not every pixel keeps its colour."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (20, 0)])

    def s_curve(jerk):
        limits = {"speed": 40, "acceleration": 200, "jerk": jerk}
        return nl.plotting.feed(nl.plan_feed(line, **limits, period_s=1e-3), limits=limits)

    moving = nl.plotting.animation(s_curve, [500, 1000, 4000], alt="an S-curve")
    colours = Image.open(io.BytesIO(moving.data)).convert("RGB").getcolors(1 << 20)
    stored = {colour for _, colour in colours}
    assert max(colours) == (max(colours)[0], (255, 255, 255))
    for limit in ("speed", "acceleration", "jerk"):
        tint = 0.75 + 0.25 * np.array(to_rgb(style.LIMITS[limit][0]))
        assert tuple(np.round(255 * tint).astype(int).tolist()) in stored, limit


def test_a_notebook_is_given_the_picture_and_its_words(monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda data, **more: shown.append((data, more)))
    draw(1.0)._ipython_display_()
    [(data, more)] = shown
    assert base64.b64decode(data["image/png"]).startswith(b"\x89PNG")
    assert more["metadata"] == {"image/png": {"alt": "y [mm] over x [mm]"}}
    of_now, told = draw(1.0).stored()._repr_mimebundle_()
    assert (of_now["image/png"], told) == (data["image/png"], more["metadata"])
