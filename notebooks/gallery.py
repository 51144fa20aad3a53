"""Thumbnails of the front page, cut from the notebooks' stored outputs: ``python notebooks/gallery.py``.

The picture is that of the cell tagged ``thumbnail``.
"""

import base64
import io
import json
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
SIZE = (480, 320)


def thumbnail(notebook: dict) -> Image.Image:
    """The tagged cell's picture, fitted on white into ``SIZE``."""
    cells = [cell for cell in notebook["cells"] if "thumbnail" in cell["metadata"].get("tags", [])]
    data = [output.get("data", {}) for cell in cells for output in cell["outputs"]]
    pictures = [mime["image/png"] for mime in data if "image/png" in mime]
    if len(pictures) != 1:
        raise ValueError(f"tag one cell with one picture as 'thumbnail'; found {len(pictures)} pictures")
    picture = Image.open(io.BytesIO(base64.b64decode(pictures[0]))).convert("RGB")
    picture.thumbnail(SIZE, Image.Resampling.LANCZOS)
    sheet = Image.new("RGB", SIZE, "white")
    sheet.paste(picture, ((SIZE[0] - picture.width) // 2, (SIZE[1] - picture.height) // 2))
    return sheet


def main() -> None:
    """Write ``gallery/<notebook>.png`` for every notebook."""
    for file in sorted(HERE.glob("*.ipynb")):
        sheet = thumbnail(json.loads(file.read_text()))
        sheet.save(HERE / "gallery" / f"{file.stem}.png", optimize=True)


if __name__ == "__main__":
    main()
