"""Work in chunks: here, in threads, in processes and on a Dask cluster of two processes."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import cache, partial
from multiprocessing import get_context

import numba
import numpy as np
import pytest
import trimesh
from distributed import Client, LocalCluster

import nurbs_lab as nl
from nurbs_lab.common.executor import WorkLost, map_items
from nurbs_lab.tests.common import work
from nurbs_lab.tests.robust.calls import fingerprint


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        yield cluster


@pytest.fixture(scope="module")
def executors(cluster):
    with (
        ThreadPoolExecutor(2) as several_threads,
        ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes,
        Client(cluster) as client,
    ):
        yield {"threads": several_threads, "processes": processes, "dask": client.get_executor()}


def test_bits_are_equal_everywhere_and_workers_use_one_thread(executors):
    here = map_items(work.products, range(12))
    assert here[0][2] == numba.get_num_threads()
    for executor in executors.values():
        there = map_items(work.products, range(12), executor)
        for (solved, length, _), (solved_there, length_there, count) in zip(here, there, strict=True):
            np.testing.assert_array_equal(solved, solved_there)
            assert (length, 1) == (length_there, count)


CURVES = [known.curve for known in nl.motion.benchmark_curves().values()]
LIMITS = {"speed": 20.0, "acceleration": 200.0, "chord_error": 1e-3, "period_s": 2e-3}
FEEDS = nl.plan_feed(CURVES, **LIMITS)
GRIDS = [np.random.default_rng(seed).random((4 + seed, 6, 3)) for seed in range(3)]
BALLS = [trimesh.creation.icosphere(subdivisions=2, radius=radius) for radius in (2.0, 3.0)]
STOCKS = [nl.machining.stock_around(ball) for ball in BALLS]
ROUGHING = BALLS, STOCKS, nl.Cutter("flat", diameter=2.0), 1.5, 0.3
roughed = cache(lambda: nl.rough(*ROUGHING))
STUDIES = {
    "plan_feed": lambda executor: nl.plan_feed(CURVES, **LIMITS, executor=executor),
    "trace": lambda executor: nl.trace(CURVES, FEEDS, stepper="taylor2", executor=executor),
    "interpolate_curve": lambda executor: nl.interpolate_curve(
        [grid[:, 0] for grid in GRIDS], executor=executor
    ),
    "approximate_curve": lambda executor: nl.approximate_curve(
        [grid[:, 0] for grid in GRIDS], tolerance=0.2, executor=executor
    ),
    "interpolate_surface": lambda executor: nl.interpolate_surface(GRIDS, executor=executor),
    "reconstruct": lambda executor: [
        (built.surfaces, built.volume)
        for built in nl.reconstruct(BALLS, tolerance=0.5, executor=executor)
    ],
    "finish": lambda executor: [
        [move.curve for move in program.moves]
        for program in nl.finish(
            BALLS, nl.Cutter("ball", 2.0, length=50.0), scallop=0.3, tolerance=0.05, executor=executor
        )
    ],
    "rough": lambda executor: nl.rough(*ROUGHING, executor=executor),
    "verify": lambda executor: nl.verify(roughed(), BALLS, spacing=1.0, executor=executor),
    "simulate": lambda executor: nl.simulate(roughed(), STOCKS, 0.5, executor=executor),
    "leaderboard": lambda executor: [
        replace(score, ns_per_step=0.0)
        for score in nl.motion.leaderboard(
            {"paper": CURVES[0]}, steppers=["adams", "rk4"], repeats=1, executor=executor
        )
    ],
    "word_length_study": lambda executor: nl.hardware.word_length_study(
        CURVES[0], nl.plan_feed(CURVES[0], speed=4.0, acceleration=40.0, period_s=1e-3), 1e-3, (25, 35),
        executor=executor,
    ),
}  # fmt: skip


@pytest.mark.parametrize("study", STUDIES)
def test_public_functions_give_equal_bits_on_any_workers(study, executors):
    here = fingerprint(STUDIES[study](None))
    for name, executor in executors.items():
        assert fingerprint(STUDIES[study](executor)) == here, name


def test_workers_that_read_a_file_give_equal_bits(executors, tmp_path):
    BALLS[0].export(tmp_path / "ball.stl")
    heights = np.linspace(-1.9, 1.9, 9)
    here = nl.slice_mesh(tmp_path / "ball.stl", heights)
    for name, executor in executors.items():
        layers = nl.slice_mesh(tmp_path / "ball.stl", heights, executor=executor)
        assert layers == here, name
        assert [*map(hash, layers)] == [*map(hash, here)], name
        assert not layers[4].contours[0].points.flags.writeable


def test_a_list_gives_what_its_entries_give_and_errors_name_the_entry(executors):
    assert [nl.plan_feed(curve, **LIMITS) for curve in CURVES] == FEEDS
    assert nl.plan_feed(CURVES[0], **LIMITS, executor=executors["threads"]) == FEEDS[0]
    assert nl.plan_feed([], **LIMITS) == []
    for executor in (None, executors["processes"]):
        with pytest.raises(TypeError, match=r"^curve 1: curve must be a NurbsCurve, got int$"):
            nl.plan_feed([CURVES[0], 3], **LIMITS, executor=executor)
    with pytest.raises(ValueError, match=r"feed has 2 entries, curve has 5"):
        nl.trace(CURVES, FEEDS[:2])
    (path,) = nl.trace([CURVES[0]], FEEDS[:1], executor=executors["processes"])
    assert not path.u.flags.writeable


def test_a_killed_worker_loses_nothing(executors, tmp_path):
    assert map_items(partial(work.die_once, tmp_path / "a"), range(20), executors["dask"]) == list(range(20))
    assert (tmp_path / "a").exists()
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as broken,
        pytest.raises(WorkLost, match=r"executor failed during 20 items"),
    ):
        map_items(partial(work.die_once, tmp_path / "b"), range(20), broken)


def test_an_interrupt_cancels_what_has_not_begun():
    def interrupted(number):
        begun.append(number)
        raise KeyboardInterrupt

    begun = []
    with ThreadPoolExecutor(1) as executor, pytest.raises(KeyboardInterrupt):
        map_items(interrupted, range(50), executor)
    assert len(begun) < 50
