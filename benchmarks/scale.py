"""Beyond one core and beyond one curve: studies on workers, and long programs planned in windows."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import cache, partial
from multiprocessing import get_context

import numpy as np
from distributed import Client, LocalCluster

import nurbs_lab as nl
from benchmarks.harness import Bar, Row, medians
from nurbs_lab.common.executor import map_items
from nurbs_lab.common.threads import single_thread
from nurbs_lab.mesh import samples

ORGANS = ("spleen", "eye_white", "heart", "l_intestine")
WORKERS = (1, 2)


def rows() -> list[Row]:
    """Every row of the room's table."""
    return [*_workers(), *map(_windows, (13, 131, 1310))]


def _workers():
    """A study and a batch of organs in one process on one core, on a pool and on Dask."""
    with ExitStack() as stack:
        executors = {"one process": None}
        executors["a pool of two"] = stack.enter_context(ProcessPoolExecutor(2, get_context("spawn")))
        cluster = stack.enter_context(LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None))
        client = stack.enter_context(Client(cluster))
        workers = list(client.scheduler_info()["workers"])
        for count in WORKERS:
            executors[f"Dask {count}"] = client.get_executor(workers=workers[:count])
        for work, study in STUDIES.items():
            calls = {name: partial(_on_one_core, study, executor) for name, executor in executors.items()}
            seconds, _ = medians(calls, repeats=3, budget_s=60.0)
            others = {name: seconds[name] for name in ("one process", "a pool of two")}
            for count in WORKERS:
                yield Row(
                    "scale",
                    f"{work} on Dask, workers: {count}",
                    {"nurbs_lab": seconds[f"Dask {count}"]} | others,
                    (Bar("one process", 1.7),) if count == 2 else (),
                    notes="one process on one core; a local cluster, its scheduler in the caller's process",
                    figures={"workers": count},
                )


def _on_one_core(study, executor):
    with single_thread():
        return study(executor)


@cache
def _contours():
    organ = samples.frog_organ("liver")
    low, high = organ.bounds[:, 2]
    layers = nl.slice_mesh(organ, low + (high - low) * (np.arange(200) + 0.5) / 200)
    return [c.points for layer in layers for c in layer.contours if len(c.points) > 8]


def _curves(executor):
    study = partial(nl.approximate_curve, tolerance=0.05, closed=True)
    return map_items(study, _contours(), executor)


@cache
def _meshes():
    """Organs of two frogs, the second a tenth larger than the first."""
    meshes = [samples.frog_organ(name, blur_mm=2.0) for name in ORGANS]
    return [*meshes, *(mesh.copy().apply_scale(1.1) for mesh in meshes)]


def _organs(executor):
    return nl.reconstruct(_meshes(), tolerance=2.0, executor=executor)


STUDIES = {"curves through 358 contours": _curves, "eight frog organs rebuilt as solids": _organs}


def _windows(count):
    """A long program with limits of jerk and axes, planned in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.long_program", str(count)]
    kept = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}  # Dask's
    run = subprocess.run(command, capture_output=True, text=True, check=True, env=kept)
    periods, seconds, first, peak, longer = map(float, run.stdout.split())
    return Row(
        "scale",
        f"plan of {periods:,.0f} periods in windows, jerk and axes limited",
        {"nurbs_lab": seconds},
        notes="the making of the curves included",
        figures={
            "periods": periods,
            "µs a period": 1e6 * seconds / periods,
            "first window ms": 1e3 * first,
            "peak memory MB": peak,
            "longer than one plan by %": 100 * longer,
        },
        most={
            "µs a period": 10.0, "first window ms": 100.0, "peak memory MB": 300.0,
            "longer than one plan by %": 0.5,
        },
    )  # fmt: skip
