"""Ctrl-C stops long work within seconds: no kernel keeps Python waiting, no child goes on, no file stays."""

import gc
import os
import signal
import sys
import tempfile
import threading
import time

import numpy as np
import psutil
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import interruptible
from nurbs_lab.tests.clock import at_once_s

BALL = trimesh.creation.icosphere(subdivisions=4, radius=4.0)
CUTTER = nl.Cutter("ball", diameter=3.0)
STOCK = nl.machining.stock_around(BALL)
MILLING = nl.finish(BALL, CUTTER, scallop=0.5, tolerance=0.2)
LIMITS = {"speed": 4.0, "acceleration": 40.0, "chord_error": 1e-3}


def waves(count):
    x, y = np.meshgrid(np.linspace(0, 3, count), np.linspace(0, 3, count), indexing="ij")
    return np.dstack([x, y, np.sin(3 * x) * np.cos(2 * y)])


def export(count):
    nl.export("part.step", nl.interpolate_surface(waves(count)))


#: Work that grows with a number, a small and a large one.
JOBS = {
    "slice": (lambda n: nl.slice_mesh(BALL, np.linspace(-3.9, 3.9, n)), 4, 10_000),
    "stream": (lambda n: nl.slice_mesh("ball.stl", np.linspace(-3.9, 3.9, n)), 4, 3_000),
    "reconstruct": (lambda n: nl.reconstruct(BALL, tolerance=n), 1, 0.01),
    "interpolate": (lambda n: nl.interpolate_surface(waves(n)), 8, 600),
    "plan": (lambda n: nl.plan_feed(nl.paper.CURVE, period_s=1 / n, **LIMITS), 100, 1_000_000),
    "trace": (lambda n: nl.trace(nl.paper.CURVE, 4.0, period_s=1 / n), 100, 2_000_000),
    "verilog": (lambda n: nl.trace(nl.paper.CURVE, 4.0, stepper="rtl", period_s=1 / n), 500, 20_000),
    "export": (export, 8, 100),
    "finish": (lambda n: nl.finish(BALL, CUTTER, scallop=1 / n, tolerance=0.5 / n), 8, 1000),
    "rough": (lambda n: nl.rough(BALL, STOCK, CUTTER, 8 / n, 0.5), 4, 1000),
    "simulate": (lambda n: nl.simulate(MILLING, STOCK, 8 / n), 8, 800),
}


@pytest.mark.parametrize("name", JOBS)
def test_an_interrupt_is_heard_and_leaves_nothing(name, tmp_path, monkeypatch):
    job, small, large = JOBS[name]
    monkeypatch.chdir(tmp_path)
    BALL.export("ball.stl")
    job(small)  # the compilers, of numba and of Verilog, are not what is measured
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    sent, done = [], threading.Event()

    def interrupt():
        while not done.wait(20.0 if sent else 0.5):
            sent.append(time.process_time())
            os.kill(os.getpid(), signal.SIGINT)

    def work_for_ever():
        while True:
            job(large)

    others = psutil.Process().children()  # a browser that other tests share
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # which a job in the background ignores
    tracer, _ = sys.gettrace(), sys.settrace(None)  # interrupted, coverage would keep its lock
    callbacks, gc.callbacks[:] = gc.callbacks[:], []  # Python drops what is raised there; Hypothesis has one
    try:
        threading.Thread(target=interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            work_for_ever()
        stopped = time.process_time()
    finally:
        done.set()
        signal.signal(signal.SIGINT, before)
        gc.callbacks[:] = callbacks
        sys.settrace(tracer)
    assert stopped - sent[-1] < at_once_s()
    assert len(sent) <= 2  # the first, or a second where Python lost the first one in a finalizer
    left = [child for child in psutil.Process().children() if child not in others]
    assert psutil.wait_procs(left, timeout=60)[1] == []
    whole = {"ball.stl", "part.step"}  # from before, and from the small job
    assert {file.name for file in tmp_path.iterdir()} <= whole


def test_an_interrupt_that_numba_hides_is_found_and_other_errors_are_left_alone():
    def hidden(cause):
        try:
            raise SystemError("a result with an exception set") from cause
        except SystemError as inner:
            raise SystemError("a result with an exception set") from inner

    with pytest.raises(KeyboardInterrupt), interruptible():
        hidden(KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):  # as `plan_feed`, `trace` and all others that take lists
        one_or_many()(hidden)(KeyboardInterrupt())
    with pytest.raises(SystemError), interruptible():
        hidden(MemoryError())
