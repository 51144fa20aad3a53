"""The host of the board: loads and streams paths over a serial line, and steers them while they run.

    import nurbs_lab as nl
    from nurbs_lab.hardware import build_exact_program, load_host

    host = load_host()
    with host.Machine("/dev/ttyACM0", steps_per_mm=400.0) as machine:
        machine.locate((0.0, 0.0, 0.0))           # where the tool stands, in mm
        for status in machine.run(program, period_s):
            print(status.position)
            machine.override(0.5)                  # or hold(), resume(), abort()

The body of the loop has to end within half a second, or the watchdog of the board lets the tool slow down
and rest. A job of any length streams: banks are loaded while others run. Every wait is bounded. `Simulation`
stands in for a port.
"""

import numpy as np

from nurbs_lab.hardware.exact_program import ExactProgram, build_exact_program
from nurbs_lab.hardware.interpolator import ABORT, CONTROL, FAULTS, GO, OVERRIDE
from nurbs_lab.motion import plan_feed
from nurbs_lab.nurbs import NurbsCurve

from . import axes_twin
from . import conversation as say
from .axes_twin import SPACING, STEP_BITS, largest_moves, load_scale
from .port import Port
from .simulated import Simulation

__all__ = ["Machine", "Port", "Simulation", "axes_twin", "say"]

#: Least and most cycles of a period (board_registers.v).
LEAST, MOST = 1500, (1 << 20) - 1


class Machine:
    """A machine of three axes behind a port; lengths in mm, of the machine's coordinates unless said.

    Parameters
    ----------
    port : str or Simulation
    steps_per_mm : float

    Raises
    ------
    ValueError
        If the port cannot be opened.
    RuntimeError
        If the board does not answer or is another version.
    """

    def __init__(self, port, *, steps_per_mm=400.0):
        self.port = Port(port) if isinstance(port, str) else port
        self.steps_per_mm, self.talk = steps_per_mm, say.Conversation()
        #: Added to the coordinates of a program; steps of the origin, or None where that is not known.
        self.offset, self.origin, self.rate = np.zeros(3), None, 256
        #: The board has taken the origin; it has lost it since; its latest run was steered.
        self.taken, self.lost, self.steered, self.running = False, False, False, False
        try:
            self.clock_hz = self.converse(self.talk.greet())
        except BaseException:
            self.port.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.release()
        finally:
            self.port.close()

    def converse(self, steps):
        """Run a generator of a conversation; its result."""
        answer = None
        while True:
            try:
                wish = steps.send(answer)
            except StopIteration as end:
                return end.value
            answer = self.port.sleep(wish) if isinstance(wish, float) else self.port.exchange(wish)

    # Steering, at any time.

    def override(self, part):
        """Follow the feed at this part of it, 0 to 1: it acts within two periods."""
        if not 0.0 <= part <= 1.0:
            raise ValueError(f"part must be from 0 (hold) to 1 (as planned), got {part:g}")
        self.rate, self.steered = round(256 * part), True
        self.converse(self.talk.ask(OVERRIDE, self.rate))

    def hold(self):
        """Slow down on the path and rest."""
        self.override(0.0)

    def resume(self):
        """Go on as planned."""
        self.override(1.0)

    def abort(self):
        """Slow down on the path, rest, and end the run there."""
        self.converse(self.talk.ask(CONTROL, ABORT))

    def release(self):
        """Disable the drivers."""
        self.converse(self.talk.ask(say.BOARD_CONTROL, say.DISABLE))

    def status(self) -> say.Status:
        """What the board says now."""
        status = self.converse(self.talk.look())
        self.lost |= self.taken and not status.placed
        at = (np.nan,) * 3 if self.origin is None else np.add(self.origin, status.steps) / self.steps_per_mm
        return status._replace(position=tuple(map(float, at)))

    @property
    def position(self) -> tuple:
        """Where the tool stands, after a stop the motors' last place; not a number before it is known."""
        return self.status().position

    def locate(self, position=(0.0, 0.0, 0.0)):
        """Say where the tool stands: before the first run, and after a stop, a fault or `release`."""
        steps = self.converse(self.talk.look()).steps
        self.taken = self.lost = False
        self.origin = np.rint(np.multiply(position, self.steps_per_mm)).astype(int) - steps

    # Inputs: limit, home, probe.

    def watch(self, *names, level=0):
        """Let the tool slow down and rest when one of these inputs comes to this level; forget earlier ones.

        Of no name: watch none. A contact that closes to ground comes to 0.
        """
        if level not in (0, 1) or not set(names) <= set(say.INPUTS):
            raise ValueError(f"watch takes level 0 or 1 and {', '.join(say.INPUTS)}; got {level}, {names}")
        bits = sum(1 << say.INPUTS.index(name) for name in names)
        self.converse(self.talk.ask(say.WATCH, bits * level << 16 | bits))

    def touched_at(self) -> tuple:
        """Where the tool stood at the edge, in mm."""
        steps = self.converse(self.talk.ask_steps(say.PLACES))
        return tuple(map(float, np.add(self.origin, steps) / self.steps_per_mm))

    def probe(self, to, *, name="probe", level=0, **feed):
        """Move straight until an input comes to a level, and rest; where it was, None if it did not come."""
        self.watch(name, level=level)
        *_, status = self.jog(to, **feed)
        found = self.touched_at() if status.touched else None
        self.watch()
        return found

    # Motion.

    def run(self, program: ExactProgram, period_s: float):
        """Run a program of `build_exact_program` in space; a generator that yields a `Status` at each look.

        A place that nobody has told is taken to be the start of the program. Closing the generator early lets
        the tool slow down on its path and rest.

        Raises
        ------
        ValueError
            If the program begins elsewhere or is not in space, an axis would be too fast, or the period is
            another than the program's or not possible.
        RuntimeError
            If a run is under way, if the board does not answer, stops, does not end in time or does something
            else than the twin.
        """
        if self.running:
            raise RuntimeError("a run is under way: let it end, or close its generator")
        if program.dim != 3 or abs(period_s - program.period_s) > 1e-9 * period_s:
            raise ValueError(
                f"program must be in space and have the period_s of the run, {period_s:g} s; "
                f"it has {program.dim} coordinates and {program.period_s:g} s"
            )
        scales = (load_scale(self.steps_per_mm, program.point_fraction),) * 3
        cycles, twin = self._cycles(period_s), say.twin_of(program)
        largest = largest_moves(twin.points, scales)
        if max(largest) * SPACING > cycles << STEP_BITS:
            raise ValueError(
                f"steps_per_mm = {self.steps_per_mm:g}: an axis would make "
                f"{max(largest) / period_s / 1024:.6g} steps a second, the board makes "
                f"{self.clock_hz / SPACING:.6g}; lower the speed or steps_per_mm"
            )
        before = self.status()
        here = self._stands_at(before, twin.points[0], program)
        if hasattr(self.port, "insert"):
            self.port.insert(program)
        self.converse(self.talk.load(program, scales, cycles, largest))
        self.origin = None  # should the board not answer
        self.converse(self.talk.ask(say.BOARD_CONTROL, say.ORIGIN))
        self.origin, self.taken = here, True
        self.converse(self.talk.ask(CONTROL, GO))
        self.rate, self.steered, self.running = 256, False, True
        left_s, status = len(twin.u) * period_s, None
        try:
            while not (status and status.ended):
                self.port.sleep(say.PAUSE_S)
                status = self.status()
                if not status.placed:
                    raise RuntimeError(
                        f"the board stopped: {', '.join(status.flags) or 'the drivers are disabled'}"
                    )
                self.converse(self.talk.refill(status.register))
                left_s -= say.PAUSE_S * self.rate / 256
                if left_s < -say.MARGIN_S and self.rate and not status.awaited:
                    raise RuntimeError(f"the board does not end: {len(twin.u) * period_s:.3g} s were planned")
                yield status
            stopped = [flag for flag in status.flags if flag in FAULTS.values() and flag != "aborted"]
            if stopped:
                raise RuntimeError(f"the board stopped with {', '.join(stopped)}")
            silent = say.BOARD_FAULTS[13]
            slowed = "aborted" in status.flags or (silent in status.flags and silent not in before.flags)
            if not (slowed or self.steered):
                self.converse(self.talk.compare(twin, scales, status))
        finally:
            self._end(status)

    def jog(self, to, *, speed, acceleration, outputs=(), period_s=1e-3):
        """Move straight to a position, with these outputs on; a generator as `run`."""
        start = np.array(self.position)
        if np.isnan(start).any():
            raise RuntimeError("nobody has told where the tool stands: tell its place by locate()")
        line = NurbsCurve(1, [0, 0, 1, 1], np.array([start, to]) - self.offset)
        feed = plan_feed(line, speed=speed, acceleration=acceleration, period_s=period_s)
        program = build_exact_program(line, feed, period_s, outputs=say.outputs(*outputs))
        return self.run(program, period_s)

    def _cycles(self, period_s):
        cycles = round(period_s * self.clock_hz)
        if not LEAST <= cycles <= MOST or abs(cycles - period_s * self.clock_hz) > 1e-6 * cycles:
            raise ValueError(
                f"period_s must be a whole number of {1 / self.clock_hz:g} s, from {LEAST} to {MOST} of "
                f"them, got {period_s:g} s"
            )
        return cycles

    def _stands_at(self, status, point, program):
        """The place of the tool in steps, within a step of the point at which the program begins."""
        if self.lost:
            raise RuntimeError(
                f"the tool may have moved since the board stopped at {status.position}: "
                "tell its place by locate()"
            )
        begin = np.ldexp(np.array(point, float), -program.point_fraction) + self.offset
        if self.origin is None:
            return np.rint(begin * self.steps_per_mm).astype(int)
        here = np.add(self.origin, status.steps)
        away = np.abs(begin * self.steps_per_mm - here).max()
        if away > 1.0:
            raise ValueError(
                f"the program begins {away / self.steps_per_mm:.6g} mm from where the tool stands: jog there"
            )
        return here

    def _end(self, status):
        """Whatever ended the run: the tool rests, and the place is kept if it holds."""
        self.running = False
        if status is None or not status.ended:
            self.abort()
            for _ in range(round(say.MARGIN_S / say.PAUSE_S)):
                self.port.sleep(say.PAUSE_S)
                status = self.status()
                if status.ended or not status.busy:
                    break
