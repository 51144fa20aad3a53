"""Independent items of work, in this process or on the workers of an executor.

The one interface is `concurrent.futures.Executor`: thread and process pools, ``client.get_executor()`` of
Dask, and ``MPIPoolExecutor`` of mpi4py fit it. Nothing here starts a worker.
"""

import inspect
import pickle
import re
import sys
from concurrent.futures import CancelledError, Executor, ThreadPoolExecutor, as_completed
from functools import partial, wraps

from threadpoolctl import threadpool_limits

from nurbs_lab.common.checks import shown
from nurbs_lab.common.progress import bar, interruptible
from nurbs_lab.common.threads import single_thread

CHUNKS = 48  # in which items are sent; notebook 12 measures what a chunk costs
_EXECUTOR = """
executor : concurrent.futures.Executor, optional
    Workers for a list; this process by default. The results are equal bit for bit.
"""


class WorkLost(RuntimeError):
    """The executor failed before all work was done."""


def as_executor(executor):
    """The executor, or None for this process."""
    if executor is None or isinstance(executor, Executor):
        return executor
    hint = "; a Dask client has one: client.get_executor()" if hasattr(executor, "get_executor") else ""
    raise TypeError(f"executor must be a concurrent.futures.Executor or None, got {shown(executor)}{hint}")


def one_or_many(*also, ndim=0, send=None):
    """Decorate a function so that its first argument may be a list, for which it returns a list of results.

    The decorated function has one more argument, ``executor``, as in `map_items`, also in its docstring.

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
            given = dict(signature.bind(*args, **options).arguments)
            for other in others:
                if other.kind is inspect.Parameter.VAR_KEYWORD:
                    given |= given.pop(other.name, {})
            columns = {first.name: given.pop(first.name) if several else [given.pop(first.name)]}
            for name in also:
                if several and isinstance(given.get(name), (list, tuple)):
                    columns[name] = given.pop(name)
                    if len(columns[name]) != len(entries):
                        raise ValueError(
                            f"{name} has {len(columns[name])} entries, {first.name} has {len(entries)}"
                        )
            items = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
            if executor is not None and send is not None:
                given, *items = [{k: send(value) for k, value in row.items()} for row in (given, *items)]
            results = map_items(partial(_call, call, given), items, executor, what=first.name)
            return results if several else results[0]

        added = inspect.Parameter("executor", inspect.Parameter.KEYWORD_ONLY, default=None)
        before_results = r"\n(?=\n(Returns|Raises)\n)"
        call.__doc__ = re.sub(before_results, _EXECUTOR, inspect.cleandoc(function.__doc__ or ""), count=1)
        call.__signature__ = signature.replace(
            parameters=sorted([first, *others, added], key=lambda parameter: parameter.kind)
        )
        return call

    return decorate


def _call(decorated, given, item):
    return decorated.__wrapped__(**given, **item)


@interruptible()
def map_items(function, items, executor=None, *, what="item") -> list:
    """Results of ``function(item)`` for every item, in order; public as ``nurbs_lab.map``.

    A chunk of items computes on one thread, and so does linear algebra everywhere, so that the bits do
    not depend on where they were computed.

    Parameters
    ----------
    function : callable
        For processes and machines it must be picklable: a function of a module, or a `functools.partial`.
    items : iterable
    executor : concurrent.futures.Executor, optional
        It stays the caller's and is not shut down. Without it the work is done in this process.
    what : str
        What an item is: for the progress bar and for errors.

    Raises
    ------
    WorkLost
        If workers or the scheduler are lost.
    Exception
        Whatever ``function`` raises; the message begins with ``what`` and the number of the item.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> nl.map(abs, [-1, 2, -3])
    [1, 2, 3]
    """
    executor, items = as_executor(executor), list(items)
    with threadpool_limits(1):
        if executor is None:
            return [_named(function, *row, what) for row in bar(enumerate(items), len(items), what)]
        chunks = [range(i, len(items), CHUNKS) for i in range(min(CHUNKS, len(items)))]
        futures, results, wrong = {}, [None] * len(items), None
        try:
            for chunk in chunks:
                work = _Work((function, [(i, items[i]) for i in chunk], what))
                futures[_submit(executor, work)] = chunk
            for future in bar(as_completed(futures), len(futures), what):
                found, wrong = future.result()
                if wrong is not None:
                    break
                results[futures[future].start :: CHUNKS] = found
        except (Exception, CancelledError) as error:
            raise WorkLost(f"executor failed during {len(items)} {what}s: {_why(error)}") from error
        finally:
            for future in futures:
                future.cancel()
    if wrong is not None:
        raise wrong
    return results


class _Work(tuple):
    """A function, numbered items, and what they are; to unpickle it is to do it."""

    def __reduce__(self):
        return _results, tuple(self)


def _submit(executor, work):
    """The future of some work.

    `pickle.loads` and bytes are sent. If a worker does not have the package, that raises an error which
    comes back; a worker of Dask that cannot read a task stops, and its client waits for ever.
    """
    if isinstance(executor, ThreadPoolExecutor):
        return executor.submit(_results, *work)
    dumps = getattr(sys.modules.get("cloudpickle"), "dumps", pickle.dumps)  # for functions of notebooks
    return executor.submit(pickle.loads, dumps(work))


def _results(function, numbered, what):
    """The results of a chunk and None, or an empty list and the first error."""
    with single_thread(), threadpool_limits(1):
        try:
            return [_named(function, number, item, what) for number, item in numbered], None
        except Exception as error:
            return [], error


def _named(function, number, item, what):
    """The result for one item; an error says which item it was."""
    try:
        return function(item)
    except Exception as error:
        if error.args and isinstance(error.args[0], str):
            error.args = (f"{what} {number}: {error.args[0]}", *error.args[1:])
        else:
            error.add_note(f"{what} {number}")
        raise


def _why(error):
    """Why an executor failed, in a few words."""
    cause = error
    while cause is not None:
        if isinstance(cause, ModuleNotFoundError):
            return f"a worker has no module {cause.name!r}, install the same nurbs_lab on every worker"
        cause = cause.__cause__ or cause.__context__
    return str(error) or type(error).__name__
