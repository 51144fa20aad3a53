"""One static site of all notebooks, from their stored outputs: ``python notebooks/book/build.py FOLDER``."""

import base64
import html
import importlib.util
import io
import json
import re
import shutil
import sys
import tempfile
from pathlib import Path

import nbformat
from PIL import Image
from sphinx.cmd.build import build_main

from nurbs_lab.plotting import dragging
from nurbs_lab.plotting.orbit import MIME
from nurbs_lab.plotting.sliders import label

HERE = Path(__file__).parent
NOTEBOOKS = HERE.parent
BUTTON = '<button type="button">Turn in 3-D</button>'
PLAY = '<button type="button">Play</button>'
PICTURES = {"image/png": ".png", "image/webp": ".webp", "image/gif": ".gif", "image/svg+xml": ".svg"}
MATHJAX = ("tex-chtml.js", "output/chtml/fonts/woff-v2")  # all that MathJax needs for TeX


def frames_of(content, name, static) -> int:
    """Write the frames of an animated PNG to files of their own, numbered from 1; how many they are."""
    animated = Image.open(io.BytesIO(content))
    last = getattr(animated, "n_frames", 1) - 1  # frame 0 is what viewers show that know no animations
    for number in range(1, last + 1):
        animated.seek(number)
        frame = animated.convert("RGB").quantize(64, dither=Image.Dither.NONE)
        frame.save(static / f"{name}-frame-{number}.png", optimize=True)
    return last


def figure(output, name, static) -> str | None:
    """A stored picture as HTML with its words; a slider if it moves, a button if its scene is stored too."""
    data = output.get("data", {})
    kind = next((kind for kind in PICTURES if kind in data), None)
    if kind is None:
        return None
    said = output.metadata.get(kind, {})
    content = data[kind].encode() if kind == "image/svg+xml" else base64.b64decode(data[kind])
    (static / f"{name}{PICTURES[kind]}").write_bytes(content)
    width = f' width="{said["width"]}"' if "width" in said else ""
    picture = f'<img src="_static/{name}{PICTURES[kind]}" alt="{html.escape(said.get("alt", ""))}"{width}>'
    last = frames_of(content, name, static) if kind == "image/png" else 0
    if last:
        place = f'data-frames="_static/{name}-frame-"'
        explored = re.match(r"Explorer: (\w+) from", data["text/plain"])
        named = label(explored[1]) if explored else "Frame"
        first = 1 if explored else last  # a slider begins with the question, a film stops at its end
        slider = f'<label>{named} <input type="range" min="1" max="{last}" value="{first}"></label>'
        return f'<figure class="stored moving" {place}>{picture}{slider}{PLAY}</figure>'
    if dragging.MIME in data:
        return dragging.page(data[dragging.MIME], name, picture=picture)
    if MIME not in data:
        return f'<figure class="stored">{picture}</figure>'
    scene = json.dumps(data[MIME], separators=(",", ":"))
    script = f'(window.nurbsLabScenes ??= {{}})["{name}"] = {scene};'
    (static / f"{name}.js").write_text(script)
    place = f'data-name="{name}" data-scene="_static/{name}.js"'
    return f'<figure class="stored orbit" {place}>{picture}{BUTTON}</figure>'


def stage(file, folder) -> tuple[str, str]:
    """Copy one notebook, its pictures moved to files of their own; its title, and its thumbnail in words."""
    notebook = nbformat.read(file, as_version=4)
    count, words = 0, ""
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            count += 1
            if "thumbnail" in cell.metadata.get("tags", []):
                words = words or output.get("metadata", {}).get("image/png", {}).get("alt", "")
            page = figure(output, f"{file.stem}-{count}", folder / "_static")
            if page:
                output.data = {"text/html": page}
            for kind in {"text/html", "text/markdown"} & set(output.get("data", {})):
                # Sphinx follows the links of the prose, not those of outputs.
                output.data[kind] = re.sub(r"([\w-]+)\.ipynb(?=[)\"])", r"\1.html", output.data[kind])
    nbformat.write(notebook, folder / file.name)
    return notebook.cells[0].source.splitlines()[0].removeprefix("# "), words


def front(titles) -> str:
    """The first page: the gallery, and the list that the side bar follows."""
    cards = "\n".join(
        f'<a href="{stem}.html"><img src="_static/gallery/{stem}.png" alt="{html.escape(words)}">'
        f"{html.escape(title)}</a>"
        for stem, (title, words) in titles.items()
    )
    toc = "\n".join(titles)
    return (
        "# nurbs_lab\n\nA triangle mesh goes in. NURBS curves and surfaces, a feed-controlled tool path "
        "and a cycle-exact hardware run of that same path come out. Every page of this book is a "
        "notebook that you can run and change; every claim is measured in it.\n\n"
        f'```{{raw}} html\n<div class="gallery">\n{cards}\n</div>\n```\n\n'
        f"```{{toctree}}\n:hidden:\n{toc}\n```\n"
    )


def build(target) -> int:
    """Build the site into a folder; Sphinx's exit status, warnings counted as errors."""
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch)
        static = source / "_static"
        for folder in (static, source):  # for the first page, and for the prose of the notebooks
            shutil.copytree(NOTEBOOKS / "gallery", folder / "gallery")
        shutil.copy(HERE / "conf.py", source)
        for file in (HERE / "viewer.js", HERE / "book.css", HERE / "favicon.svg", dragging.SCRIPT):
            shutil.copy(file, static)
        mathjax = Path(importlib.util.find_spec("sphinx-mathjax-offline").origin).parent / "static/mathjax"
        for name in MATHJAX:
            copy = shutil.copytree if (mathjax / name).is_dir() else shutil.copy
            (static / "mathjax" / name).parent.mkdir(parents=True, exist_ok=True)
            copy(mathjax / name, static / "mathjax" / name)
        titles = {file.stem: stage(file, source) for file in sorted(NOTEBOOKS.glob("*.ipynb"))}
        (source / "index.md").write_text(front(titles))
        trees = str(source / "trees")  # Sphinx's own notes, no part of the site
        status = build_main(["-q", "-W", "--keep-going", "-d", trees, str(source), str(target)])
    for file in Path(target).rglob("*.map"):  # of the theme's scripts, for their authors
        file.unlink()
    return status


if __name__ == "__main__":
    sys.exit(build(Path(sys.argv[1])))
