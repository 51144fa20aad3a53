"""Run notebooks in place, store outputs that a second run repeats: ``python notebooks/regenerate.py``."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from tqdm.auto import tqdm

HERE = Path(__file__).parent


def run(notebook) -> None:
    """Execute all cells; slow prints are joined, however they arrived."""
    client = NotebookClient(
        notebook, timeout=600, coalesce_streams=True, resources={"metadata": {"path": str(HERE)}}
    )
    client.execute()


def drop_noise(notebook) -> None:
    """Remove what differs from run to run or belongs to one machine: stderr, time stamps, widget states."""
    notebook.metadata.pop("widgets", None)
    notebook.metadata["language_info"] = {"name": "python"}
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]


def main(files) -> None:
    """Regenerate the named notebooks, or all."""
    for file in tqdm(sorted(map(Path, files)) or sorted(HERE.glob("*.ipynb"))):
        notebook = nbformat.read(file, as_version=4)
        run(notebook)
        drop_noise(notebook)
        nbformat.write(notebook, file)


if __name__ == "__main__":
    main(sys.argv[1:])
