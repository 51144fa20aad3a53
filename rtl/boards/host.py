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

from nurbs_lab.common.checks import as_kind, as_positive, as_vector
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
        self.steps_per_mm = as_positive("steps_per_mm", steps_per_mm)
        self.port, self.talk = port if hasattr(port, "exchange") else Port(port), say.Conversation()
        #: Added to the coordinates of a program; steps of the origin, or None where that is not known.
        self.offset, self.origin, self.rate = np.zeros(3), None, 256
        #: The board has taken the origin; it has lost it since; its latest run was steered.
        self.taken, self.lost, self.steered, self.running = False, False, False, False
        try:
            self.clock_hz = self.converse(self.talk.greet())
            self.running = self.status().busy  # with a host before this one
            self._end()
        except BaseException:
            self.port.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._end()
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
        return status._replace(position=self._in_mm(status.steps))

    @property
    def position(self) -> tuple:
        """Where the tool stands, after a stop the motors' last place; not a number before it is known."""
        return self.status().position

    def locate(self, position=(0.0, 0.0, 0.0)):
        """Say where the tool stands: before the first run, and after a stop, a fault or `release`."""
        self._needs_rest()
        place = np.rint(as_vector("position", position, 3) * self.steps_per_mm).astype(int)
        self.origin = place - self.converse(self.talk.look()).steps
        self.taken = self.lost = False

    # Inputs: limit, home, probe.

    def watch(self, *names, level=0):
        """Let the tool slow down and rest when one of these inputs comes to this level; forget earlier ones.

        Of no name: watch none. A contact that closes to ground comes to 0. One that stands at the level
        already has no edge to come, and is refused.
        """
        self._watch(say.edges(names, level))

    def _watch(self, edges):
        self.converse(self.talk.ask(say.WATCH, edges))
        away = self.converse(self.talk.ask(say.LEVELS)) ^ edges >> 16
        if stuck := say.names_in(edges & ~away, say.INPUTS):
            self.converse(self.talk.ask(say.WATCH, 0))
            raise RuntimeError(
                f"{' and '.join(stuck)} would not stop the tool, being at the level already: move away from "
                "it, or mend the contact; until then watch the others"
            )

    def touched_at(self) -> tuple:
        """Where the tool stood at the edge, in mm."""
        return self._in_mm(self.converse(self.talk.ask_steps(say.PLACES)))

    def probe(self, to, *, name="probe", level=0, **feed):
        """Move straight until an input comes to a level, and rest; where it was, None if it did not come.

        What is watched besides stays watched; if that stopped the tool, no run begins before `watch`.
        """
        edge, way = say.edges([name], level), self.jog(to, **feed)
        others = self.converse(self.talk.ask(say.WATCH)) & ~say.edges([name], 1)
        self._watch(others | edge)
        *_, status = way
        found = self.touched_at() if name in status.touched else None
        if not {*status.touched} - {name}:
            self._watch(others)
        return found

    # Motion.

    def run(self, program: ExactProgram, period_s: float):
        """Run a program of `build_exact_program` in space; a generator that yields a `Status` at each look.

        A place that nobody has told is taken to be the start of the program. Closing the generator early lets
        the tool slow down on its path and rest.

        Raises
        ------
        ValueError
            If the program begins elsewhere, is not in space or does not begin and end at rest, an axis would
            be too fast, or the period is another than the program's or not possible.
        RuntimeError
            If a run is under way, if the board does not answer, stops, does not end in time or does something
            else than the twin.
        """
        self._needs_rest()
        if as_kind("program", program, ExactProgram).dim != 3:
            raise ValueError("program must be in space: give its curves a third coordinate, such as 0")
        if abs(as_positive("period_s", period_s) - program.period_s) > 1e-9 * period_s:
            raise ValueError(
                f"program must have the period_s of the run, {period_s:g} s; it has {program.period_s:g} s"
            )
        if max(program.end_speeds) > 0.0:
            raise ValueError(
                "program must begin and end at rest, as motors do, but does so at {:g} and {:g} mm/s: "
                "plan its feed without start_speed and end_speed".format(*program.end_speeds)
            )
        scales = (load_scale(self.steps_per_mm, program.point_fraction),) * 3
        cycles, twin = self._cycles(period_s), say.twin_of(program)
        largest = largest_moves(program, scales)
        if max(largest) * SPACING > cycles << STEP_BITS:
            raise ValueError(
                f"steps_per_mm = {self.steps_per_mm:g}: an axis may have to make "
                f"{max(largest) / period_s / 1024:.6g} steps a second, the board makes "
                f"{self.clock_hz / SPACING:.6g}; lower the speed or steps_per_mm"
            )
        before = self.status()
        if before.touched:
            raise RuntimeError(
                f"a run is refused since {' and '.join(before.touched)} stopped the tool: call watch() first"
            )
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
                begun_s = self.port.time_s
                self.port.sleep(say.PAUSE_S)
                late = left_s < -say.PATIENCE_S  # when it is asked; a look may take longer than the margin
                status = self.status()
                left_s -= (self.port.time_s - begun_s) * self.rate / 256
                if not status.placed:
                    raise RuntimeError(
                        f"the board stopped: {', '.join(status.flags) or 'the drivers are disabled'}"
                    )
                if self.converse(self.talk.refill(status.register)) and status.awaited:
                    left_s += say.MARGIN_S  # the tool had slowed down
                if late and left_s < -say.MARGIN_S and self.rate and not status.ended:
                    raise RuntimeError(f"the board does not end: {len(twin.u) * period_s:.3g} s were planned")
                yield status
            stopped = [flag for flag in status.flags if flag in FAULTS.values() and flag != "aborted"]
            if stopped:
                raise RuntimeError(f"the board stopped with {', '.join(stopped)}")
            slowed = {"aborted", say.BOARD_FAULTS[13]}.intersection(status.flags)
            if not (slowed or self.steered):
                self.converse(self.talk.compare(twin, scales, status))
        finally:
            self._end()

    def jog(self, to, *, speed, acceleration, outputs=(), period_s=1e-3):
        """Move straight to a position, with these outputs on; a generator as `run`.

        Where the tool stands within half a step of it nothing moves.
        """
        status, to = self.status(), as_vector("to", to, 3)
        start = np.array(status.position)
        if np.isnan(start).any():
            raise RuntimeError("nobody has told where the tool stands: tell its place by locate()")
        if np.abs(to - start).max() * self.steps_per_mm <= 0.5:
            return iter([status])
        line = NurbsCurve(1, [0, 0, 1, 1], np.array([start, to]) - self.offset)
        feed = plan_feed(line, speed=speed, acceleration=acceleration, period_s=period_s)
        program = build_exact_program(line, feed, period_s, outputs=say.outputs(*outputs))
        return self.run(program, period_s)

    def _needs_rest(self):
        if self.running:
            raise RuntimeError("a run is under way: let it end, or close its generator")

    def _in_mm(self, steps):
        at = (np.nan,) * 3 if self.origin is None else np.add(self.origin, steps) / self.steps_per_mm
        return tuple(map(float, at))

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
        offset = as_vector("offset", self.offset, 3)
        begin = np.ldexp(np.array(point, float), -program.point_fraction) + offset
        if self.origin is None:
            return np.rint(begin * self.steps_per_mm).astype(int)
        here = np.add(self.origin, status.steps)
        away = np.abs(begin * self.steps_per_mm - here).max()
        if away > 1.0:
            raise ValueError(
                f"the program begins {away / self.steps_per_mm:.6g} mm from where the tool stands: jog there"
            )
        return here

    def _end(self):
        """Whatever ended the run: the tool rests, and the place is kept if it holds."""
        running, self.running = self.running, False
        if running and not self.status().ended:
            self.abort()
            until_s = self.port.time_s + say.MARGIN_S
            while self.port.time_s < until_s:
                self.port.sleep(say.PAUSE_S)
                status = self.status()
                if status.ended or not status.busy:
                    break
