"""Work in parts on two threads of this process."""

import multiprocessing
import threading

import numpy as np
import pytest

from nurbs_lab.common import threads
from nurbs_lab.common.threads import over_slices


@pytest.fixture(autouse=True)
def two_threads(monkeypatch):
    monkeypatch.setattr(threads, "threads", lambda: 2)  # on any machine


def _sum_of_squares(count=1000):
    parts = np.array_split(np.arange(count), 8)
    return sum(over_slices(lambda part: int((part**2).sum()), parts, "squares"))


def test_results_are_in_order_and_two_threads_work_at_a_time():
    meeting = threading.Barrier(2, timeout=30)  # which one thread alone would never pass
    assert over_slices(lambda i: (meeting.wait(), i)[1], range(4), "meetings") == list(range(4))


def test_nested_calls_do_not_wait_for_each_other():
    meeting = threading.Barrier(2, timeout=60)

    def both(_):
        meeting.wait()
        return _sum_of_squares()

    assert over_slices(both, range(2), "nested") == [sum(i * i for i in range(1000))] * 2


def test_an_error_ends_the_work_when_no_part_runs_any_more():
    meeting, running = threading.Barrier(2, timeout=60), []

    def fail(i):
        running.append(i)
        if i < 2:
            meeting.wait()
        if i == 1:
            raise ValueError("part 1 fails")
        running.remove(i)

    with pytest.raises(ValueError, match="part 1 fails"):
        over_slices(fail, range(100), "parts")
    assert running == [1]
    assert _sum_of_squares() == sum(i * i for i in range(1000))


def test_a_forked_process_has_threads_of_its_own():
    _sum_of_squares()
    several_at_a_time = test_results_are_in_order_and_two_threads_work_at_a_time
    child = multiprocessing.get_context("fork").Process(target=several_at_a_time)
    child.start()
    child.join(60)
    assert child.exitcode == 0
