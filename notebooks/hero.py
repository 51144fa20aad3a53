"""The moving picture of the front page, from scan to waveform: ``python notebooks/hero.py``."""

import io
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import nurbs_lab as nl
from nurbs_lab import hardware, plotting
from nurbs_lab.mesh import samples
from nurbs_lab.plotting.picture import png_of
from nurbs_lab.plotting.stage import FONT, image

FILE = Path(__file__).parent / "gallery" / "hero.png"
SIZE = (640, 440)
TURN, FRAMES = 2.5, 9  # degrees a frame, frames a scene
COLOURS, FRAME_MS, HOLD_MS = 48, 110, 900


def turning(draw) -> list[Image.Image]:
    """Pictures of a scene that turns slowly."""
    pictures = []
    for k in range(FRAMES):
        stage = draw()
        stage.window_size = SIZE
        stage.camera.azimuth = TURN * k
        pictures.append(image(stage))
    return pictures


def filling(animation) -> list[Image.Image]:
    """The frames of an animation of `plotting`."""
    moving = Image.open(io.BytesIO(animation.data))
    pictures = []
    for k in range(1, moving.n_frames):
        moving.seek(k)
        pictures.append(moving.convert("RGB"))
    return pictures


def waveforms() -> list[Image.Image]:
    """The signals of the module cu, appearing from the left."""
    signals = hardware.watch_cu(nl.paper.CURVE, 0.3)
    signals = {name: signals[name] for name in ("start", "state", "product", "x", "y", "done")}
    count, pictures = len(signals["start"]), []
    for shown in np.linspace(2, count, FRAMES).astype(int):
        figure = plotting.waveform(signals, clock_hz=nl.paper.CLOCK_HZ)
        figure.set_size_inches(7.2, 3.6)
        figure.axes[0].axvspan(shown, count, color="white", zorder=10)
        pictures.append(Image.open(io.BytesIO(png_of(figure, tight=False))).convert("RGB"))
    return pictures


def framed(picture, said) -> Image.Image:
    """A picture fitted on white, with a line of text below."""
    picture.thumbnail((SIZE[0], SIZE[1] - 40), Image.Resampling.LANCZOS)
    sheet = Image.new("RGB", SIZE, "white")
    sheet.paste(picture, ((SIZE[0] - picture.width) // 2, (SIZE[1] - 40 - picture.height) // 2))
    font = ImageFont.truetype(FONT, 17)
    ImageDraw.Draw(sheet).text((SIZE[0] / 2, SIZE[1] - 22), said, "#202020", font, anchor="mm")
    return sheet


def scenes():
    """Text and pictures of each scene."""
    scan = samples.frog_organ("spleen", blur_mm=2.0)
    low, high = scan.bounds[:, 2]
    layers = nl.slice_mesh(scan, np.linspace(low, high, 26)[1:-1])
    solid = nl.reconstruct(scan, tolerance=0.5)
    stock = nl.machining.stock_around(scan)
    program = nl.finish(scan, nl.Cutter("ball", diameter=6.0, length=35.0), scallop=0.05, tolerance=0.01)
    yield f"1 · a scan: {len(scan.faces):,} triangles", turning(lambda: plotting.mesh(scan, edges=True))
    yield f"2 · {len(layers)} layers of ordered contours", turning(lambda: plotting.layers(layers))
    yield (
        "3 · one closed solid of NURBS faces",
        turning(lambda: plotting.surface(solid, isocurves=True)),
    )
    moving = plotting.milling(program, stock, alt="a cutter at work", frames=14, resolution=0.5)
    yield "4 · milled by a ball-end cutter on a virtual machine", filling(moving)
    yield "5 · a point of a curve, cycle by cycle in the Verilog", waveforms()


def main() -> None:
    """Write the picture."""
    frames, milliseconds = [], []
    for said, pictures in scenes():
        frames += [framed(picture, said) for picture in pictures]
        milliseconds += [FRAME_MS] * (len(pictures) - 1) + [HOLD_MS]
    strip = Image.new("RGB", (SIZE[0], 5 * SIZE[1]))
    for k, at in enumerate(np.linspace(0, len(frames) - 1, 5).astype(int)):
        strip.paste(frames[at], (0, k * SIZE[1]))
    palette = strip.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=2)
    frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    frames[0].save(
        FILE, "png", save_all=True, append_images=frames[1:], duration=milliseconds, loop=0, optimize=True
    )


if __name__ == "__main__":
    main()
