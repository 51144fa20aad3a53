"""What host and board say to each other: uart_bridge.v, nurbs_interpolator.v, board_registers.v.

Conversations are written as generators: they yield a request (bytes) and get the answer, or yield a pause
(seconds). So the same code speaks to a port and to the simulated line in the benches.
"""

import binascii
from itertools import cycle
from typing import NamedTuple

from nurbs_lab.common.checks import as_choice
from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.interpolator import (
    CONTROL,
    FAULTS,
    FORGET,
    LOAD_HIGH,
    OVERRIDE,
    SHAPE,
    STATUS,
    batch_writes,
)

from .axes_twin import count_steps, points_checksum

#: Registers of board_registers.v.
IDENTITY, CLOCK, BOARD_CONTROL, BOARD_STATUS, PERIOD, SCALE_X, SCALE_Y, SCALE_Z = range(0x100, 0x120, 4)
POINTS, CHECKSUM, STEPS_X, STEPS_Y, STEPS_Z, LARGEST_X, LARGEST_Y, LARGEST_Z = range(0x120, 0x140, 4)
STEPS = STEPS_X, STEPS_Y, STEPS_Z
#: Those that the board takes while nothing moves.
SIZES = SCALE_X, SCALE_Y, SCALE_Z, LARGEST_X, LARGEST_Y, LARGEST_Z
#: Registers of inputs.v, and the names of its inputs.
LEVELS, WATCH, HIT, *PLACES = range(0x180, 0x198, 4)
INPUTS = ("limit x", "limit y", "limit z", "home x", "home y", "home z", "probe")
#: Outputs of a piece, bit by bit; the last one is on only while the tool moves (axes.v).
OUTPUTS = ("spindle", "coolant", "air", "laser")
#: Orders to BOARD_CONTROL.
ENABLE, DISABLE, ORIGIN = 1, 2, 4
#: What the register IDENTITY must hold: the version of the registers that this host speaks to.
VERSION = 0x4E4C0006
#: What the register SHAPE must hold for exact slopes in space at 35 bits, and the mask of those bits.
BUILT, BUILT_MASK = 1 << 20 | 3 << 8 | 35, 0xF << 20 | 0xFFFF
#: Bits of STATUS and BOARD_STATUS; ON are those of the outputs.
BUSY, ENDED, RESTING, AWAITED, LOADED = 1 << 0, 1 << 1, 1 << 3, 1 << 4, 1 << 5
ENABLED, MOVING, PLACED, ON, PRESSED = 1 << 0, 1 << 1, 1 << 2, 15 << 4, 1 << 8
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
ASK, BLOCK, ANSWER, LENGTH = b"\xa5", b"\xb5", b"\x5a", 9
#: Of a block, which has 5 bytes a write; of the line.
MOST_WRITES, BAUD = 200, 3_000_000
#: How often a request is sent; in s: how long a whole answer may take, how long the host waits between two
#: looks, and how much longer than planned a run may take.
TRIES, PATIENCE_S, PAUSE_S, MARGIN_S = 3, 0.5, 0.02, 2.0


def encode(start: bytes, number: int, middle: int, data: int) -> bytes:
    """A request of one register or an answer, see uart_bridge.v."""
    return sealed(start, bytes((number, middle)) + (data & 0xFFFFFFFF).to_bytes(4, "little"))


def encode_block(number: int, writes) -> bytes:
    """Writes (address, data) as one request."""
    body = b"".join(bytes((at >> 2,)) + data.to_bytes(4, "little") for at, data in writes)
    return sealed(BLOCK, bytes((number, len(writes))) + body)


def sealed(start: bytes, body: bytes) -> bytes:
    return start + body + binascii.crc_hqx(body, 0xFFFF).to_bytes(2, "big")


class Status(NamedTuple):
    """What the board says of itself."""

    busy: bool
    #: The latest run has ended and nothing moves.
    ended: bool
    resting: bool
    #: The next bank is awaited: the host is too slow, the tool slows down.
    awaited: bool
    #: STEPS hold: no stop, no fault since the origin.
    placed: bool
    #: Steps of the three axes from the origin.
    steps: tuple
    flags: tuple
    #: Watched inputs whose edge has come.
    touched: tuple = ()
    #: Outputs that are on.
    outputs: tuple = ()
    #: Of the tool in mm, by `Machine`.
    position: tuple = ()
    #: STATUS as it is.
    register: int = 0


def _writing(address, data):
    return f"writing {data:#x} to register {address:#x}"


class Conversation:
    """Requests and answers, each request carried out exactly once however often it has to be sent."""

    def __init__(self):
        self.numbers = cycle(range(1, 256))
        self.number = 0  # that of the first request, which is always carried out
        self.high = None  # in LOAD_HIGH

    def ask(self, address, data=None):
        """Read a register, or write it; the generator's result is what was read."""
        number, self.number = self.number, next(self.numbers)
        action = f"reading register {address:#x}" if data is None else _writing(address, data)
        request = encode(ASK, number, (data is not None) << 7 | address >> 2, data or 0)
        return (yield from self.send(request, lambda _: action))

    def write(self, writes):
        """Write registers in their order, in blocks of which each is answered once."""
        kept = []
        for address, data in writes:
            if address != LOAD_HIGH or data != self.high:
                kept.append((address, data))
            self.high = data if address == LOAD_HIGH else self.high
        for first in range(0, len(kept), MOST_WRITES):
            part = kept[first : first + MOST_WRITES]
            number, self.number = self.number, next(self.numbers)
            yield from self.send(encode_block(number, part), lambda done, part=part: _writing(*part[done]))

    def send(self, request, what):
        trouble = ""
        for _ in range(TRIES):
            answer = yield request
            whole = answer.ljust(LENGTH)
            number, code, data = *whole[1:3], int.from_bytes(whole[3:7], "little")
            if not answer:
                silent = "the board does not answer: is it powered and programmed, and is this its port?"
                trouble = trouble or silent
            elif answer != encode(ANSWER, number, code, data):
                trouble = f"the board's answers have a wrong checksum, last {answer.hex(' ')}"
            elif code in DAMAGED:
                trouble = f"the board receives requests with {DAMAGED[code]}"
                yield PAUSE_S  # in which the rest of a request that broke off goes by
            elif number != request[1]:
                trouble = f"the board answered request {number}, not {request[1]}"
            elif code:
                why = {REFUSED: "is refused", BUS_SILENT: "is not answered by the bus"}.get(code, "fails")
                raise RuntimeError(f"{what(data)} of the board {why}")
            else:
                return data
        raise RuntimeError(f"{trouble} ({TRIES} tries)")

    def greet(self):
        """Make sure that the design at the other end is the one that this host knows; its clock in Hz."""
        version = yield from self.ask(IDENTITY)
        if version != VERSION:
            raise RuntimeError(
                f"the board has version {version:#010x} of the registers, this nurbs_lab speaks to "
                f"{VERSION:#010x}: program it with the file of `make bitstream`"
            )
        built = yield from self.ask(SHAPE)
        if built & BUILT_MASK != BUILT:
            raise RuntimeError(f"the board's interpolator has shape {built:#010x}, not exact slopes in space")
        clock_hz = yield from self.ask(CLOCK)
        if not 1e6 <= clock_hz <= 1e9:
            raise RuntimeError(
                f"the board says that its clock has {clock_hz} Hz, from 1e6 to 1e9 are possible"
            )
        return clock_hz

    def look(self):
        """The `Status` of the board."""
        path = yield from self.ask(STATUS)
        board = yield from self.ask(BOARD_STATUS)
        steps = yield from self.ask_steps(STEPS)
        hit = yield from self.ask(HIT)
        flags = [name for bit, name in FAULTS.items() if path >> bit & 1]
        flags += [name for bit, name in BOARD_FAULTS.items() if board >> bit & 1]
        busy, resting, awaited = (bool(path & bit) for bit in (BUSY, RESTING, AWAITED))
        ended, placed = bool(path & ENDED and not busy and not board & MOVING), bool(board & PLACED)
        touched, on = names_in(hit, INPUTS), names_in(board >> 4, OUTPUTS)
        return Status(busy, ended, resting, awaited, placed, steps, tuple(flags), touched, on, (), path)

    def ask_steps(self, registers):
        """Signed numbers of steps."""
        steps = []
        for address in registers:
            steps.append(((yield from self.ask(address)) ^ 1 << 31) - (1 << 31))
        return tuple(steps)

    def load(self, program, scales, period_cycles, largest):
        """Load the first banks and enable the drivers; those of an enabled board keep their current."""
        self.batches, self.bank, self.high = batch_writes(program), 0, None
        if (yield from self.ask(BOARD_STATUS)) & PRESSED:
            raise RuntimeError(f"the board stopped: {BOARD_FAULTS[8]}")
        if (yield from self.ask(PERIOD)) != period_cycles:  # which the board takes without an origin only
            yield from self.ask(BOARD_CONTROL, DISABLE)
            yield from self.ask(PERIOD, period_cycles)
        sizes = zip(SIZES, (*scales, *largest), strict=True)
        yield from self.write([(CONTROL, FORGET), *sizes])
        for _ in range(2):
            yield from self.refill()
        yield from self.ask(OVERRIDE, 256)  # which a silence may have made 0
        yield from self.ask(BOARD_CONTROL, ENABLE)

    def refill(self, status=0):
        """Load the next bank if it is open; whether it was."""
        if opened := bool(self.batches) and not status & LOADED << self.bank:
            yield from self.write(self.batches.pop(0))
            self.bank ^= 1
        return opened

    def compare(self, twin, scales, status):
        """Make sure that the board ran the points of the twin."""
        sums = []
        for address in (POINTS, CHECKSUM):
            sums.append((yield from self.ask(address)))
        expected = len(twin.u), points_checksum(twin.u, twin.points), count_steps(twin.points, scales)[-1]
        if (*sums, status.steps) != expected:
            raise RuntimeError(
                "the board did not run the twin's path: points, checksum and steps are "
                f"{(*sums, status.steps)}, expected {expected}"
            )


def outputs(*names) -> int:
    """The bits of these outputs, for `build_exact_program`."""
    return bits_of("outputs", names, OUTPUTS)


def edges(names, level) -> int:
    """What the register WATCH holds for the coming of these inputs to a level."""
    if level not in (0, 1):
        raise ValueError(f"watch takes level 0 or 1, got {level}")
    bits = bits_of("names", names, INPUTS)
    return level * bits << 16 | bits


def bits_of(kind, names, known) -> int:
    return sum({1 << known.index(as_choice(kind, name, known)) for name in names})


def names_in(bits, known) -> tuple:
    return tuple(name for bit, name in enumerate(known) if bits >> bit & 1)


def twin_of(program):
    """What the program makes in the twin, without a fault."""
    twin = run_exact(program)
    if twin.flags:
        raise ValueError(
            f"the hardware would stop after {len(twin.u)} points with {', '.join(twin.flags)}: a step that "
            "turns or moves too much asks for a shorter period or a slower feed, one beyond for wider limits"
        )
    return twin
