"""The stepper 'board': a path run by the Verilog of rtl/boards/colorlight_i5.v, over a serial line.

The conversation is written as generators: they yield a request (bytes) and get the answer, or yield a pause
(seconds). So the same code speaks to a port here and to the simulated line in the benches.
"""

import binascii
import os
import select
import time
from itertools import cycle
from typing import NamedTuple

import numpy as np

from nurbs_lab.hardware.axes import SPACING, count_steps, largest_move, load_scale, place_of, points_checksum
from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.exact_program import ExactProgram, build_exact_program
from nurbs_lab.hardware.interpolator import FAULTS, SHAPE, STATUS, exact_steps, register_writes
from nurbs_lab.motion import Option, Stepper, register
from nurbs_lab.nurbs import NurbsCurve

#: Registers of rtl/boards/board_registers.v.
IDENTITY, CLOCK, BOARD_CONTROL, BOARD_STATUS, PERIOD, SCALE_X, SCALE_Y, SCALE_Z = range(0x100, 0x120, 4)
POINTS, CHECKSUM, STEPS_X, STEPS_Y, STEPS_Z, LARGEST_X, LARGEST_Y, LARGEST_Z = range(0x120, 0x140, 4)
#: Fewest cycles of a period.
LEAST_PERIOD = 1500
#: Feed override of rtl/nurbs_interpolator.v.
OVERRIDE = 0x20
#: Orders to BOARD_CONTROL.
ENABLE, DISABLE, ORIGIN = 1, 2, 4
#: What the register IDENTITY must hold: the version of the registers this module speaks to.
VERSION = 0x4E4C0002
#: What the register SHAPE must hold for exact slopes in space at 35 bits, and the mask of those bits.
BUILT, BUILT_MASK = 2 << 20 | 3 << 8 | 35, 0xF << 20 | 0xFFFF
#: Bits of STATUS and BOARD_STATUS.
ENDED, MOVING = 1 << 1, 1 << 1
#: Bit of BOARD_STATUS -> what went wrong.
BOARD_FAULTS = {
    8: "the emergency stop is pressed",
    9: "the emergency stop was pressed",
    10: "an axis is too fast",
    11: "a point came late",
    12: "steps were lost",
    13: "the host was silent",
    14: "the run begins elsewhere",
    15: "it was cut while the tool moved",
}
#: Code of an answer -> why the board did not carry out the request, which may be repeated.
DAMAGED = {
    0x10: "a wrong checksum",
    0x11: "a wrong stop bit",
    0x12: "an end in its middle",
    0x13: "no start byte",
    0x14: "bytes behind it",
}
REFUSED, BUS_SILENT = 0x02, 0x15
ASK, ANSWER, LENGTH = b"\xa5", b"\x5a", 9
#: How often a request is sent, how long its answer may take, and how long the host waits between two looks.
TRIES, PATIENCE_S, PAUSE_S = 3, 0.5, 0.02


class BoardRun(NamedTuple):
    """What the board did; its points are those of the twin, as their checksum says."""

    #: Position and points in integers, as from ``run_exact``.
    u: list
    points: list
    #: Steps of the three axes from the first point.
    steps: tuple


def encode(start: bytes, number: int, middle: int, data: int) -> bytes:
    """A request or an answer, see rtl/boards/uart_bridge.v."""
    body = bytes((number, middle)) + (data & 0xFFFFFFFF).to_bytes(4, "little")
    return start + body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")


class Conversation:
    """Requests and answers, each request carried out exactly once however often it has to be sent."""

    def __init__(self):
        self.numbers = cycle(range(1, 256))
        self.number = 0  # that of the first request, which is always carried out

    def ask(self, address, data=None):
        """Read a register, or write it; the generator's result is what was read."""
        number, self.number = self.number, next(self.numbers)
        request = encode(ASK, number, (data is not None) << 7 | address >> 2, data or 0)
        trouble = ""
        for _ in range(TRIES):
            answer = yield request
            if not answer:
                trouble = trouble or (
                    "the board does not answer: is it powered and programmed, and is this its port?"
                )
            elif len(answer) != LENGTH or answer != encode(
                ANSWER, *answer[1:3], int.from_bytes(answer[3:7], "little")
            ):
                trouble = f"the board's answers have a wrong checksum, last {answer.hex(' ')}"
            elif answer[2] in DAMAGED:
                trouble = f"the board receives requests with {DAMAGED[answer[2]]}"
            elif answer[1] != number:
                trouble = f"the board answered request {answer[1]}, not {number}"
            elif answer[2]:
                why = {REFUSED: "is refused", BUS_SILENT: "is not answered by the bus"}.get(
                    answer[2], "fails"
                )
                action = "reading" if data is None else f"writing {data:#x} to"
                raise RuntimeError(f"{action} register {address:#x} of the board {why}")
            else:
                return int.from_bytes(answer[3:7], "little")
        raise RuntimeError(f"{trouble} ({TRIES} tries)")

    def greet(self):
        """Make sure that the design at the other end is the one this module knows; its clock in Hz."""
        version = yield from self.ask(IDENTITY)
        if version != VERSION:
            raise RuntimeError(
                f"the board has version {version:#010x} of the registers, this nurbs_lab speaks to "
                f"{VERSION:#010x}: program it with the file of `make bitstream`"
            )
        built = yield from self.ask(SHAPE)
        if built & BUILT_MASK != BUILT:
            raise RuntimeError(f"the board's interpolator has shape {built:#010x}, not exact slopes in space")
        return (yield from self.ask(CLOCK))

    def run(self, program, scales, period_cycles):
        """Load a program, run it, and compare what the board did with the twin."""
        if len(program.cuts()) > 1:
            raise ValueError(
                f"the host loads one bank of 32 pieces and 128 records of the feed, the program needs "
                f"{len(program.cuts())}: split the curve"
            )
        twin = run_exact(program)
        if twin.flags:
            raise ValueError(
                f"the hardware would stop after {len(twin.u)} points with {', '.join(twin.flags)}"
            )
        yield from self.ask(BOARD_CONTROL, DISABLE)
        *load, go = register_writes(program)
        for address, data in load:
            yield from self.ask(address, data)
        largest = [place_of(program.largest_step, scale) + 1 for scale in scales]
        settings = dict(zip((PERIOD, SCALE_X, SCALE_Y, SCALE_Z), (period_cycles, *scales), strict=True))
        settings |= dict(zip((LARGEST_X, LARGEST_Y, LARGEST_Z), largest, strict=True))
        for address, data in settings.items():
            yield from self.ask(address, data)
        yield from self.refuse_faults(1 << 8)
        yield from self.ask(BOARD_CONTROL, ENABLE)
        yield from self.ask(BOARD_CONTROL, ORIGIN)
        yield from self.ask(*go)
        while True:
            path = yield from self.ask(STATUS)
            board = yield from self.refuse_faults()
            if path & ENDED and not board & MOVING:
                break
            yield PAUSE_S
        flags = [name for bit, name in FAULTS.items() if path >> bit & 1]
        if flags:
            raise RuntimeError(f"the board stopped with {', '.join(flags)}")
        found = []
        for address in (POINTS, CHECKSUM, STEPS_X, STEPS_Y, STEPS_Z):
            found.append((yield from self.ask(address)))
        steps = tuple((x ^ 1 << 31) - (1 << 31) for x in found[2:])
        expected = len(twin.u), points_checksum(twin.u, twin.points), count_steps(twin.points, scales)[-1]
        if (*found[:2], steps) != expected:
            raise RuntimeError(
                "the board did not run the twin's path: points, checksum and steps are "
                f"{(*found[:2], steps)}, expected {expected}"
            )
        yield from self.ask(BOARD_CONTROL, DISABLE)
        return BoardRun(twin.u, twin.points, steps)

    def refuse_faults(self, bits=0xFF00):
        """The board's status, if none of these fault bits is set."""
        status = yield from self.ask(BOARD_STATUS)
        faults = [name for bit, name in BOARD_FAULTS.items() if status & bits & 1 << bit]
        if faults:
            raise RuntimeError(f"the board stopped: {', '.join(faults)}")
        return status


class Port:
    """A serial port at 115,200 baud, by the terminal interface of POSIX."""

    def __init__(self, name: str):
        try:
            import termios
            import tty
        except ImportError:  # Windows
            raise ValueError("port: serial ports are opened on Linux and macOS only") from None
        try:
            self.file = os.open(name, os.O_RDWR | os.O_NOCTTY)
        except OSError as error:
            raise ValueError(
                f"port {name!r} cannot be opened: {error.strerror}; "
                "is the board plugged in, and may you use it?"
            ) from None
        self.flush = lambda: termios.tcflush(self.file, termios.TCIFLUSH)
        try:
            tty.setraw(self.file)
            settings = termios.tcgetattr(self.file)
            settings[4] = settings[5] = termios.B115200
            termios.tcsetattr(self.file, termios.TCSANOW, settings)
        except termios.error:
            self.close()
            raise ValueError(f"port {name!r} is no serial port") from None

    def close(self):
        os.close(self.file)

    def exchange(self, request: bytes) -> bytes:
        """Send a request; what comes back in time."""
        self.flush()
        os.write(self.file, request)
        answer = b""
        while len(answer) < LENGTH and select.select([self.file], [], [], PATIENCE_S)[0]:
            answer += os.read(self.file, LENGTH - len(answer))
        return answer

    def converse(self, steps):
        """Run a generator of a conversation; its result. Whatever breaks it off, the tool is told to rest."""
        answer = None
        try:
            while True:
                wish = steps.send(answer)
                answer = time.sleep(wish) if isinstance(wish, float) else self.exchange(wish)
        except StopIteration as end:
            return end.value
        except OSError as error:
            raise RuntimeError(f"the port failed: {error.strerror}") from None
        except BaseException:
            self.exchange(encode(ASK, 0, 1 << 7 | OVERRIDE >> 2, 0))
            raise


def run_board(program: ExactProgram, period_s: float, *, port: str, steps_per_mm: float) -> BoardRun:
    """Run a program in space on the board at a port; see ``trace`` with the stepper 'board'.

    Raises
    ------
    ValueError
        If the port cannot be opened, an axis would be too fast, or the period is no whole number of cycles.
    RuntimeError
        If the board does not answer, is another version, is stopped or does not do what the twin does.
    """
    scales = (load_scale(steps_per_mm, program.point_fraction),) * 3
    if not port:
        raise ValueError("port is missing: name the serial port of the board, such as port='/dev/ttyACM0'")
    line = Port(port)
    try:
        talk = Conversation()
        clock_hz = line.converse(talk.greet())
        cycles = round(period_s * clock_hz)
        if not LEAST_PERIOD <= cycles < 1 << 20 or abs(cycles - period_s * clock_hz) > 1e-6 * cycles:
            raise ValueError(
                f"period_s must be a whole number of {1 / clock_hz:g} s, from {LEAST_PERIOD} to "
                f"{(1 << 20) - 1} of them, got {period_s:g} s"
            )
        most = largest_move(run_exact(program).points, scales)
        if most * SPACING > cycles:
            raise ValueError(
                f"steps_per_mm = {steps_per_mm:g}: an axis would make {most / period_s:.6g} steps a second, "
                f"the board makes {clock_hz / SPACING:.6g}; lower the speed or steps_per_mm"
            )
        return line.converse(talk.run(program, scales, cycles))
    finally:
        line.close()


def _run(job, *, port="", steps_per_mm=400.0):
    curve = job.curve
    points = np.zeros((len(curve.control_points), 3))
    points[:, : curve.dim] = curve.control_points
    space = NurbsCurve(curve.degree, curve.knots, points, curve.weights)
    program = build_exact_program(space, job.feed, job.period_s)
    run = run_board(program, job.period_s, port=port, steps_per_mm=steps_per_mm)
    return exact_steps(program, curve, run, {"feed_table": run.steps})


register(
    Stepper(
        "board",
        "exact slopes on a Colorlight i5, behind a serial port",
        (1, 1, 0, 0),
        _run,
        options=(
            Option("port", str, "", (), "serial port of the board, such as '/dev/ttyACM0'"),
            Option("steps_per_mm", float, 400.0, (1e-6, 1e9), "steps of each axis per mm"),
        ),
    )
)
