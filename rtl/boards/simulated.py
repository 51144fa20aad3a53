"""A board that is not there."""

from nurbs_lab.hardware.exact import walk
from nurbs_lab.hardware.feed import distances
from nurbs_lab.hardware.feed_override import FeedOverride
from nurbs_lab.hardware.interpolator import (
    ABORT,
    CLOSE,
    CONTROL,
    FORGET,
    GO,
    LOAD_AT,
    LOAD_HIGH,
    LOAD_LOW,
    OVERRIDE,
    SHAPE,
    STATUS,
)

from . import conversation as say
from .axes_twin import count_steps, outputs_on, places_of, points_checksum


class Simulation:
    """A board that is not there: answers as the chip does, moves as the twin; its time passes only in here.

    It is told each program, and makes sure that the numbers that the host loads are those of the program.
    """

    def __init__(self, clock_hz=50_000_000):
        self.registers = {
            say.IDENTITY: say.VERSION,
            say.CLOCK: clock_hz,
            SHAPE: say.BUILT,
            OVERRIDE: 256,
            say.BOARD_STATUS: 0,
            say.PERIOD: 50_000,
            say.HIT: 0,
            say.LEVELS: (1 << len(say.INPUTS)) - 1,
        }
        self.clock_hz, self.time_s, self.owed_s, self.number, self.answer = clock_hz, 0.0, 0.0, None, b""
        self.path, self.stopped, self.seen = None, False, {}
        self.forget()

    def close(self):
        pass

    def insert(self, program):
        """Say what is loaded next."""
        self.program, self.batches = program, program.batches()

    def sleep(self, seconds):
        self.time_s += seconds
        self.owed_s += seconds
        period_s = self.registers[say.PERIOD] / self.clock_hz
        while self.owed_s >= period_s:
            self.owed_s -= period_s
            self.period()

    def exchange(self, request: bytes) -> bytes:
        self.sleep((len(request) + say.LENGTH) * 10 / say.BAUD)
        assert request == say.sealed(request[:1], request[1:-2])
        number, code, found = request[1], 0, 0
        if number and number == self.number:
            return self.answer
        if request[:1] == say.BLOCK:
            parts = [request[i : i + 5] for i in range(3, len(request) - 2, 5)]
            while found < len(parts) and not code:
                part = parts[found]
                code = self.write(part[0] << 2, int.from_bytes(part[1:], "little"))
                found += not code
        else:
            address = (request[2] & 127) << 2
            if request[2] >> 7:
                code = self.write(address, int.from_bytes(request[3:7], "little"))
            else:
                if address == say.STEPS_X:  # y and z of the same moment
                    self.seen = {at: self.registers.get(at, 0) for at in say.STEPS}
                known = self.registers | self.seen
                found = self.status() if address == STATUS else known.get(address, 0)
        self.number, self.answer = number, say.encode(say.ANSWER, number, code, found)
        return self.answer

    def set(self, register, bits, value=0):
        self.registers[register] = self.registers[register] & ~bits | value

    def write(self, address, data):
        held, state = self.registers, self.registers[say.BOARD_STATUS]
        moving, placed = state & say.MOVING, state & say.PLACED
        refused = {
            (say.BOARD_CONTROL, say.ENABLE): self.stopped,
            (say.BOARD_CONTROL, say.ORIGIN): moving or not state & say.ENABLED,
            (CONTROL, GO): held[say.HIT] or not placed or self.path is not None,
            (LOAD_AT, data): data >> 13,
            (say.PERIOD, data): placed or not 1500 <= data < 1 << 20,
            **{(size, data): moving for size in say.SIZES},
        }
        orders = {say.BOARD_CONTROL: (say.ENABLE, say.DISABLE, say.ORIGIN), CONTROL: (GO, FORGET, ABORT)}
        if refused.get((address, data)) or data not in orders.get(address, (data,)):
            return say.REFUSED
        if address == say.BOARD_CONTROL:
            held[say.BOARD_STATUS] = {
                say.ENABLE: placed | say.ENABLED,
                say.DISABLE: say.PRESSED * self.stopped,
                say.ORIGIN: say.ENABLED | say.PLACED,
            }[data]
            if data == say.ORIGIN:
                self.scales = [held.get(scale, 0) for scale in say.SIZES[:3]]
                self.u, self.points = [], []
                held |= dict.fromkeys((say.CHECKSUM, *say.STEPS), 0)
            if data == say.DISABLE and placed:
                self.forget()
        elif address == CONTROL and data == GO:
            self.begin()
        elif address == CONTROL and data == ABORT:
            self.aborted |= self.path is not None
        elif address == CONTROL:
            self.forget()
        else:
            held[address] = min(data, 256) if address == OVERRIDE else data
            if address == say.WATCH:
                held[say.HIT] = 0
            if address == LOAD_AT:
                self.load(data)
        return 0

    def load(self, where):
        number = self.registers[LOAD_HIGH] << 32 | self.registers[LOAD_LOW]
        if where >> 10 != CLOSE:
            self.loads.append((where >> 10, where & 1023, number))
            return
        expected = self.batches[self.closed]
        assert self.loads == [(space, index, data & (1 << 64) - 1) for space, index, data in expected]
        self.loads, self.closed = [], self.closed + 1

    def begin(self):
        if not self.closed:  # a bad curve
            self.refused = self.ended = True
            return
        program = self.program
        self.override = FeedOverride([*distances(program.feed)], program.override, program.format.word)
        self.starts = [period for _, period in program.cuts()]
        self.aborted = self.ended = False
        self.path = walk(program, self.override, self.commands())

    def commands(self):
        while True:
            yield None if self.aborted else 0 if self.awaited() else min(self.registers[OVERRIDE], 256)

    def awaited(self):
        known = self.starts[min(self.closed, len(self.starts) - 1)] - self.override.number
        return self.closed + 1 < len(self.starts) and known < self.program.override.reserve

    def status(self):
        """The register STATUS."""
        found, left = say.ENDED * self.ended | self.refused << 11 | self.aborted << 14, 0
        if self.path is not None:
            found |= say.BUSY | say.AWAITED * self.awaited() | say.RESTING * (self.override.rate == 0)
            # Banks that opened again.
            left = sum(start <= self.override.number for start in self.starts[1:-1])
        return found | sum({say.LOADED << (n & 1) for n in range(left, self.closed)})

    def forget(self):
        self.path, self.loads, self.closed, self.registers[OVERRIDE] = None, [], 0, 256
        self.ended = self.aborted = self.refused = False

    def period(self):
        """What happens in a period."""
        if self.path is None:
            self.set(say.BOARD_STATUS, say.MOVING | say.ON)
            return
        position, point, outputs = next(self.path, (None, None, 0))
        if point is None:
            self.path, self.ended = None, True
            return
        self.u.append(position)
        scales, largest = self.scales, [self.registers[size] for size in say.SIZES[3:]]
        moves = [(self.points or [point])[-1], point]
        places = zip(*(places_of(end, scales) for end in moves), largest, strict=True)
        if any(abs(there - here) > most for here, there, most in places):
            self.cut(1 << 10)
            return
        _, on = outputs_on([0, outputs], moves, scales)
        self.points.append(point)
        made = count_steps([self.points[0], point], scales)[-1]
        self.registers |= {at: n & 0xFFFFFFFF for at, n in zip(say.STEPS, made, strict=True)}
        checksum = points_checksum([position], [point], self.registers[say.CHECKSUM])
        self.registers |= {say.POINTS: len(self.u), say.CHECKSUM: checksum}
        self.set(say.BOARD_STATUS, say.MOVING | say.ON, say.MOVING | on << 4)

    def touch(self, name, level=0):
        """An input comes to a level."""
        bit, watch = 1 << say.INPUTS.index(name), self.registers.get(say.WATCH, 0)
        self.set(say.LEVELS, bit, bit * level)
        if watch & bit and (watch >> 16 & bit > 0) == level:
            places = [self.registers.get(register, 0) for register in say.STEPS]
            self.registers |= dict(zip(say.PLACES, places, strict=True)) | {say.HIT: bit}
            self.aborted |= self.path is not None

    def press(self):
        """The emergency stop."""
        self.stopped = True
        self.set(say.BOARD_STATUS, say.ENABLED)
        self.cut(say.PRESSED | 1 << 9)

    def cut(self, faults):
        """A fault, or the stop: the board forgets the path."""
        self.set(say.BOARD_STATUS, say.MOVING | say.PLACED | say.ON | faults, faults)
        self.forget()

    def release(self):
        self.stopped = False
        self.set(say.BOARD_STATUS, say.PRESSED)
