"""Work in chunks: here, in threads, in processes and on a Dask cluster of two processes."""

import contextlib
import os
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context

import numba
import numpy as np
import pytest
from distributed import Client, LocalCluster

import nurbs_lab as nl
from nurbs_lab.common.executor import WorkLost, as_executor, map_chunks
from nurbs_lab.common.threads import threads


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


def products(seed):
    """Work whose last bits tell how many threads and which order the linear algebra used."""
    matrix = np.random.default_rng(seed).random((200, 200))
    return np.linalg.solve(matrix, matrix @ matrix.T), nl.paper.CURVE.length(0.0, 1.0 / (1 + seed)), threads()


def seven_is_wrong(number):
    if number == 7:
        raise ValueError("this one is wrong")
    return number


def die_once(file, number):
    if number == 5 and not file.exists():
        file.write_text("died")
        os._exit(1)
    return number


def slow(number):
    time.sleep(0.2)
    return number


def missing_package(_):
    raise ModuleNotFoundError("No module named 'nurbs_lab'", name="nurbs_lab")


def test_bits_are_equal_everywhere_and_workers_use_one_thread(executors):
    here = map_chunks(products, range(12))
    assert here[0][2] == numba.get_num_threads()
    for executor in executors.values():
        there = map_chunks(products, range(12), executor, cost=np.arange(12.0))
        for (solved, length, _), (solved_there, length_there, count) in zip(here, there, strict=True):
            np.testing.assert_array_equal(solved, solved_there)
            assert (length, 1) == (length_there, count)


def test_an_error_names_the_item_and_keeps_its_kind(executors):
    for executor in (None, *executors.values()):
        with pytest.raises(ValueError, match=r"^number 7: this one is wrong$"):
            map_chunks(seven_is_wrong, range(20), executor, what="number")


def test_a_killed_worker_loses_nothing(executors, tmp_path):
    assert map_chunks(partial(die_once, tmp_path / "a"), range(20), executors["dask"]) == list(range(20))
    assert (tmp_path / "a").exists()
    with (
        ProcessPoolExecutor(2, mp_context=get_context("spawn")) as broken,
        pytest.raises(WorkLost, match=r"executor failed after .* of 20 items") as lost,
    ):
        map_chunks(partial(die_once, tmp_path / "b"), range(20), broken)
    assert all(lost.value.finished[number] == number for number in lost.value.finished)


def test_a_lost_scheduler_is_an_error_that_holds_what_was_finished():
    cluster = LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0")
    client = Client(cluster)
    cluster.loop.call_later(1.0, cluster.loop.add_callback, cluster.scheduler.close)
    with pytest.raises(WorkLost, match=r"executor failed after .* of 40 steps") as lost:
        map_chunks(slow, range(40), client.get_executor(), what="steps")
    assert 0 < len(lost.value.finished) < 40
    client.close(timeout=1)
    with contextlib.suppress(TimeoutError):  # its worker waits for the scheduler
        cluster.close(timeout=1)


class Elsewhere(ThreadPoolExecutor):
    """Workers on which the package is not installed."""

    def submit(self, *_):
        return super().submit(missing_package, None)


def test_a_worker_without_the_package_says_so():
    with (
        Elsewhere(1) as executor,
        pytest.raises(WorkLost, match="a worker has no module 'nurbs_lab', install"),
    ):
        map_chunks(seven_is_wrong, range(3), executor)


def test_an_interrupt_cancels_what_has_not_begun():
    def interrupted(number):
        begun.append(number)
        raise KeyboardInterrupt

    begun = []
    with ThreadPoolExecutor(1) as executor, pytest.raises(KeyboardInterrupt):
        map_chunks(interrupted, range(50), executor)
    assert len(begun) < 50


def test_what_is_no_executor_is_refused(cluster):
    assert as_executor(None) is None
    with pytest.raises(TypeError, match=r"executor must be a concurrent.futures.Executor or None, got 3"):
        as_executor(3)
    with Client(cluster) as client, pytest.raises(TypeError, match=r"client\.get_executor\(\)"):
        as_executor(client)
