"""Independent items of work, in this process or on the workers of an executor.

The one interface is `concurrent.futures.Executor`: thread and process pools, ``client.get_executor()`` of
Dask, and ``MPIPoolExecutor`` of mpi4py fit it. Nothing here starts a worker.
"""

import ctypes
import inspect
import os
import pickle
import sys
from concurrent.futures import CancelledError, Executor, as_completed
from contextlib import suppress
from functools import lru_cache, partial, wraps
from uuid import uuid4

import numpy as np
from threadpoolctl import threadpool_limits

from nurbs_lab.common.checks import shown
from nurbs_lab.common.progress import bar, interruptible
from nurbs_lab.common.threads import single_thread

_KEPT_BYTES = 2**26  # of freed memory, and half of it for one array
_SMALLEST = 1 / 64  # of the cost: small enough for tens of workers to finish together


class WorkLost(RuntimeError):
    """The executor failed before all work was done.

    Attributes
    ----------
    finished : dict
        Results of the items that were done, by number.
    """

    def __init__(self, message, finished=None):
        super().__init__(message)
        self.finished = finished or {}


def as_executor(executor):
    """The executor, or None for this process."""
    if executor is None or isinstance(executor, Executor):
        return executor
    hint = "; a Dask client has one: client.get_executor()" if hasattr(executor, "get_executor") else ""
    raise TypeError(f"executor must be a concurrent.futures.Executor or None, got {shown(executor)}{hint}")


def one_or_many(*also, ndim=0, send=None):
    """Decorate a function so that its first argument may be a list, for which it returns a list of results.

    The decorated function has one more argument, ``executor``, as in `map_chunks`.

    Parameters
    ----------
    *also : str
        Names of arguments that may be lists too, with one entry for each entry of the first argument.
    ndim : int
        Dimensions of the first argument if it is an array; only a list of such arrays is taken for several.
    send : callable, optional
        What is sent to a worker for an argument or an entry of a list; the value itself by default.
    """

    def decorate(function):
        signature = inspect.signature(function)
        first, *others = signature.parameters.values()

        @wraps(function)
        @interruptible()
        def call(*args, executor=None, **options):
            entries = args[0] if args else options.get(first.name)
            several = isinstance(entries, (list, tuple))
            if several and ndim:
                several = entries != [] and all(getattr(entry, "ndim", 0) == ndim for entry in entries)
            if not several and executor is None:
                return function(*args, **options)
            signature.bind(*args, **options)
            given = dict(zip(signature.parameters, args, strict=False)) | options
            columns = {first.name: entries if several else [entries]}
            if several:
                columns |= {name: given[name] for name in also if isinstance(given.get(name), (list, tuple))}
            for name, column in columns.items():
                if several and len(column) != len(entries):
                    raise ValueError(f"{name} has {len(column)} entries, {first.name} has {len(entries)}")
            given = {name: value for name, value in given.items() if name not in columns}
            items = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
            cost = None
            if executor is not None:
                if send is not None:
                    given, *items = [{k: send(value) for k, value in row.items()} for row in (given, *items)]
                cost = [len(pickle.dumps(item)) for item in items]
            results = map_chunks(partial(_call, call, given), items, executor, cost=cost, what=first.name)
            return results if several else results[0]

        added = inspect.Parameter("executor", inspect.Parameter.KEYWORD_ONLY, default=None)
        call.__signature__ = signature.replace(
            parameters=sorted([first, *others, added], key=lambda parameter: parameter.kind)
        )
        return call

    return decorate


def _call(function, given, item):
    return function(**given, **item)


@interruptible()
def map_chunks(function, items, executor=None, *, cost=None, what="items") -> list:
    """Results of ``function(item)`` for every item, in order.

    Items are sent in at most 48 chunks, the costly items first: 16 chunks share the first half of the cost,
    32 the second. A chunk computes on one thread. Linear algebra uses one thread everywhere, so the bits do
    not depend on where they were computed.

    Parameters
    ----------
    function : callable
        For processes and machines it must be picklable: a function of a module, or a `functools.partial`.
    items : sequence
    executor : concurrent.futures.Executor, optional
        It stays the caller's and is not shut down. Without it the work is done in this process.
    cost : sequence of float, optional
        Expected cost of every item, in any unit. Without it all cost the same.
    what : str
        What the items are: for the progress bar and for errors.

    Raises
    ------
    WorkLost
        If workers or the scheduler are lost. It holds what was finished.
    Exception
        Whatever ``function`` raises; the message begins with ``what`` and the number of the item.
    """
    executor, items = as_executor(executor), list(items)
    with threadpool_limits(1):
        if executor is None:
            numbered = enumerate(bar(items, len(items), what))
            return [_named(function, item, number, what) for number, item in numbered]
        chunks = _chunks(np.ones(len(items)) if cost is None else np.asarray(cost, dtype=float))
        return _collected(partial(_Chunk, function, what), items, chunks, executor, what)


def _chunks(cost):
    """Numbers of the items of every chunk; those of the first half of the cost are twice as large."""
    order = np.argsort(-cost, kind="stable")
    filled = (np.cumsum(cost[order]) - cost[order]) / max(cost.sum(), 1e-300)
    number = np.maximum(filled / 2, filled - 0.25) // _SMALLEST
    return np.split(order, np.flatnonzero(np.diff(number)) + 1)


def _collected(chunk, items, chunks, executor, what):
    finished, futures, wrong = {}, {}, None
    try:
        for numbers in chunks:
            futures[executor.submit(chunk(numbers.tolist(), [items[i] for i in numbers]))] = numbers
        for future in bar(as_completed(futures), len(futures), what):
            results, wrong = future.result()
            finished.update(zip(futures[future].tolist(), results, strict=False))
            if wrong is not None:
                break
    except (Exception, CancelledError) as error:
        raise WorkLost(_why(error, what, len(finished), len(items)), finished) from error
    finally:
        for future in futures:
            future.cancel()
    if wrong is not None:
        raise wrong
    return [finished[i] for i in range(len(items))]


class _Chunk:
    """Some of the items, to be sent to a worker; a call returns the results, and an error or None.

    It is sent as bytes that the worker unpickles when it begins. If the worker does not have the package,
    that raises an error, which comes back; a worker of Dask that cannot read a task stops, and its client
    waits for ever.
    """

    def __init__(self, *work):
        self.work = work  # function, what, numbers, items

    def __call__(self):
        return _results(*self.work)

    def __reduce__(self):
        dumps = getattr(sys.modules.get("cloudpickle"), "dumps", pickle.dumps)  # for functions of notebooks
        return partial, (pickle.loads, dumps(_Begun((os.getpid(), *self.work))))

    def __repr__(self):
        return f"chunk of {self.work[1]}"  # Dask's pictures show it

    def __dask_tokenize__(self):
        return uuid4().hex  # a name for Dask, which would otherwise make one of the content of every item


class _Begun(tuple):
    """Work that is done when it is unpickled; the results are in its place."""

    def __reduce__(self):
        return _results_in_worker, tuple(self)


def _results_in_worker(home, *work):
    if os.getpid() != home:
        _settle(len(sys.modules))
    return _results(*work)


def _results(function, what, numbers, items):
    results = []
    with single_thread():
        for number, item in zip(numbers, items, strict=True):
            try:
                results.append(_named(function, item, number, what))
            except Exception as error:
                return results, error
    return results, None


@lru_cache(1)
def _settle(_modules):
    """Set the threads and the memory of a worker process once, and again when it has loaded more modules.

    Dask starts its workers with ``MALLOC_TRIM_THRESHOLD_=65536``, so that memory goes back to the system at
    once and every large array costs a page fault for each 4 kB: a feed plan takes 1.6 times as long. Here
    glibc keeps freed memory for the next array, as it does by default.
    """
    threadpool_limits(1)
    with suppress(AttributeError, OSError, TypeError):  # another C library
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(-3, _KEPT_BYTES // 2)  # M_MMAP_THRESHOLD
        mallopt(-1, _KEPT_BYTES)  # M_TRIM_THRESHOLD


def _named(function, item, number, what):
    """The result for one item; an error says which item it was."""
    try:
        return function(item)
    except Exception as error:
        if error.args and isinstance(error.args[0], str):
            error.args = (f"{what} {number}: {error.args[0]}", *error.args[1:])
        else:
            error.add_note(f"{what} {number}")
        raise


def _why(error, what, finished, count):
    """Error message that says why the executor failed."""
    cause, missing = error, None
    while cause is not None and missing is None:
        missing = cause.name if isinstance(cause, ModuleNotFoundError) else None
        cause = cause.__cause__ or cause.__context__
    reason = str(error) or type(error).__name__
    if missing:
        reason = f"a worker has no module {missing!r}, install the same nurbs_lab on every worker"
    return f"executor failed after {finished} of {count} {what}: {reason}; the error's .finished holds them"
