"""Long work in blocks: between two of them Python looks for Ctrl-C, and the progress bar moves."""

from tqdm.auto import tqdm

from nurbs_lab.common.progress import hidden

#: Steps in a block, some hundredths of a second of work.
BLOCK = 250_000


def blocks(count, what):
    """(start, stop) of every block of 0 ... count, behind a progress bar if there is more than one."""
    if count <= BLOCK:
        yield 0, count
        return
    with tqdm(total=count, desc=what, unit=" steps", unit_scale=True, leave=False, disable=hidden()) as bar:
        for start in range(0, count, BLOCK):
            stop = min(start + BLOCK, count)
            yield start, stop
            bar.update(stop - start)
