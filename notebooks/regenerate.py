"""Run notebooks in place, store outputs that a second run repeats: ``python notebooks/regenerate.py``.

For each notebook it says how long the run took and whether any text is other than before; pictures may hold
measured times, text may not.
"""

import resource
import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from tqdm.auto import tqdm

HERE = Path(__file__).parent


def run(notebook) -> None:
    """Execute all cells; slow prints are joined, however they arrived."""
    client = NotebookClient(
        notebook,
        timeout=900,
        coalesce_streams=True,
        resources={"metadata": {"path": str(HERE)}},
        extra_arguments=["--IPKernelApp.log_level=40"],  # no warning about a kernel of this machine's own
    )
    client.execute()


def drop_noise(notebook) -> None:
    """Remove what differs from run to run or belongs to one machine: stderr, times, names of widgets."""
    notebook.metadata.pop("widgets", None)
    notebook.metadata["language_info"] = {"name": "python"}
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
            for output in cell.outputs:
                output.get("data", {}).pop("application/vnd.jupyter.widget-view+json", None)


def texts(notebook) -> list[list[str]]:
    """What a second run must repeat, cell by cell: the source, everything printed, the words of pictures."""
    return [[cell.source, *(_text(output) for output in cell.get("outputs", []))] for cell in notebook.cells]


def _text(output) -> str:
    words = output.get("metadata", {}).get("image/png", {}).get("alt", "")
    return output.get("text", "") + output.get("data", {}).get("text/plain", "") + words


def processor_s() -> float:
    """Processor time of all kernels that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def regenerate(file) -> str:
    """Run one notebook in place; what it took, and what came out other than before."""
    notebook = nbformat.read(file, as_version=4)
    before, wall, processor = texts(notebook), time.monotonic(), processor_s()
    run(notebook)
    drop_noise(notebook)
    nbformat.write(notebook, file)
    wall, processor = time.monotonic() - wall, processor_s() - processor
    pairs = zip(before, texts(notebook), strict=True)
    new = [number for number, (old, now) in enumerate(pairs) if old != now]
    cost = f"{wall:3.0f} s ({processor:3.0f} s of processor), {file.stat().st_size // 1000:3} kB"
    return f"{file.stem:28} {cost}, " + (f"new text in cells {new}" if new else "text as before")


def main(files) -> None:
    """Regenerate the named notebooks, or all."""
    for file in tqdm(sorted(map(Path, files)) or sorted(HERE.glob("*.ipynb"))):
        tqdm.write(regenerate(file))


if __name__ == "__main__":
    main(sys.argv[1:])
