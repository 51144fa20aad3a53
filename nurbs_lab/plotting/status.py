"""The work of a widget's callbacks, and what the widget says about it."""

import html
import signal
import threading

import ipywidgets
from IPython import get_ipython


class Status(ipywidgets.HTML):
    """A line of text below controls; it shows the errors of their work, which have no cell to be shown in."""

    def __init__(self):
        super().__init__()
        self._waiting = []

    def run(self, work):
        """Do what a control asks for, so that an interrupt of the kernel stops it.

        What ``work`` returns is the new text. JupyterLab lets a kernel answer widgets in a thread of
        their own, which no interrupt reaches. The work is then handed to the main thread. The same work is
        not handed over twice while it waits there, so that of many quick moves the last one counts.
        """
        kernel = getattr(get_ipython(), "kernel", None)
        if kernel is None or threading.current_thread() is threading.main_thread():
            self._run(work)
        elif work not in self._waiting:
            self._waiting.append(work)
            kernel.io_loop.add_callback(self._run_later, work)

    def _run_later(self, work):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored between two cells
        try:
            self._waiting.remove(work)
            self._run(work)
        finally:
            signal.signal(signal.SIGINT, before)

    def _run(self, work):
        """An error or an interrupt becomes the text; what the widget showed before stays."""
        try:
            self.value = work() or ""
        except KeyboardInterrupt:
            self.value = "<b>stopped; what is shown is the last result</b>"
        except Exception as problem:
            self.value = f"<b>{html.escape(str(problem) or type(problem).__name__)}</b>"
