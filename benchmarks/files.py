"""Files larger than the memory: a mesh sliced by workers that each read only their part of it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import trimesh

from benchmarks.harness import Row
from nurbs_lab.mesh import slice_mesh
from nurbs_lab.mesh.slicing import stl_blocks as streaming

#: In GB; a file is left out where the disk has no room for it.
SIZES = (0.5, 2.0, 20.0)
PLANES = 100
CHUNK = 1 << 24  # bytes read at once where nothing is done with them


def rows() -> list[Row]:
    """Every row of the room's table."""
    free = shutil.disk_usage(tempfile.gettempdir()).free
    return [_streaming(int(size * 1e9)) for size in SIZES if 2e9 * size < free]


def _streaming(size):
    """A file read, cut in one process and cut by two workers, in processes that did nothing before."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.stl"
        seconds, figures = {}, {"GB": size / 1e9, "triangles": write_torus(path, size)}
        for readers in (1, 2):
            seconds[f"reading the file, {readers} at once"] = _reading(path, readers)
        for name, workers in (("one process, two threads", 0), ("nurbs_lab", 2)):
            _forget(path)
            command = [sys.executable, "-m", "benchmarks.files", str(path), str(workers)]
            run = subprocess.run(command, capture_output=True, text=True, check=True)
            seconds[name], cpu, here, loops, *others = map(float, run.stdout.split())
            figures |= {f"processor s of {name}": cpu, f"peak memory MB of {name}": here, "loops": loops}
            if workers:
                figures["peak memory MB of a worker"] = max(others[::2])
                figures["% of the file that one worker read"] = 100 * max(others[1::2]) / size
                figures["% of the file read from the disk"] = 100 * sum(others[1::2]) / size
    return Row(
        "files",
        f"{size / 1e9:.2g} GB of binary STL sliced by two workers, {PLANES} planes",
        seconds,
        (),
        notes="the file leaves the page cache before each reading, which the system's count of bytes shows",
        figures=figures,
        most={"peak memory MB of a worker": 400.0},
    )


def write_torus(path, size):
    """Write a wavy torus, tile by tile around it: its number of triangles."""
    n = round((size / streaming.RECORD.itemsize / 2) ** 0.5)
    around = np.arange(n + 1) % n * (2 * np.pi / n)
    record = np.zeros(2 * n, dtype=streaming.RECORD)
    with path.open("wb") as file:
        file.write(bytes(80) + np.uint32(2 * n * n).tobytes())
        two = _ring(around[0], around)
        for angle in around[1:]:
            one, two = two, _ring(angle, around)
            for c, (even, odd) in enumerate(((one[:-1], one[:-1]), (two[:-1], two[1:]), (two[1:], one[1:]))):
                record["corners"][0::2, c], record["corners"][1::2, c] = even, odd
            file.write(record.tobytes())
        file.flush()
        os.fsync(file.fileno())
    return 2 * n * n


def _ring(angle, around):
    minor = 1.0 + 0.1 * np.sin(9 * angle) * np.cos(7 * around)
    reach = 3.0 + minor * np.cos(around)
    return np.column_stack([reach * np.cos(angle), reach * np.sin(angle), minor * np.sin(around)])


def _reading(path, readers):
    """Seconds to read a file that is not in the page cache, in as many parts at once."""
    _forget(path)
    ends = np.linspace(0, path.stat().st_size, readers + 1).astype(int).tolist()

    def read(part):
        with path.open("rb", buffering=0) as file:
            file.seek(ends[part])
            while file.tell() < ends[part + 1] and file.read(CHUNK):
                pass

    start = time.perf_counter()
    with ThreadPoolExecutor(readers) as pool:
        list(pool.map(read, range(readers)))
    return time.perf_counter() - start


def _forget(path):
    """Drop the file from the page cache."""
    with path.open("rb") as file:
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def _slice_once(path, workers):
    """Figures of one slicing: seconds, processor seconds, peak memory here in MB, loops.

    Peak memory and the bytes read from the disk follow for each worker.
    """
    warm_file = Path(path).with_name("warm.stl")
    trimesh.creation.icosphere(subdivisions=1).export(warm_file)
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn")) if workers else None
    slice_mesh(warm_file, [0.0] * 2, executor=pool)
    before = _usages(pool, workers)
    start = time.perf_counter()
    layers = slice_mesh(path, np.linspace(-0.99, 0.99, PLANES), executor=pool)
    seconds, after = time.perf_counter() - start, _usages(pool, workers)
    cpu = sum(after[pid][0] - before[pid][0] for pid in before)
    loops = sum(len(layer.contours) for layer in layers)
    others = [(after[pid][1], after[pid][2] - before[pid][2]) for pid in before if pid != os.getpid()]
    return seconds, cpu, after[os.getpid()][1], loops, *np.ravel(others)


def _usages(pool, workers):
    """Processor seconds, peak memory in MB and bytes read from the disk of this process and every worker."""
    found = dict([_usage()])
    while len(found) <= workers:
        found.update(pool.map(_usage, range(2 * workers)))
    return found


def _usage(_=None):
    time.sleep(0.05)  # so that no worker answers for the other
    status = Path("/proc/self/status").read_text()  # ru_maxrss would include the parent's, from before exec
    peak = int(re.search(r"VmHWM:\s+(\d+) kB", status)[1]) / 1024
    fetched = int(re.search(r"\nread_bytes: (\d+)", Path("/proc/self/io").read_text())[1])
    return os.getpid(), (time.process_time(), peak, fetched)


if __name__ == "__main__":
    print(*_slice_once(sys.argv[1], int(sys.argv[2])))
