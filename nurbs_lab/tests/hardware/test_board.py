"""The stepper 'board': a twin behind a pseudo-terminal, and every way in which the line can fail."""

import os
import threading
import tty

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import axes, board, run_exact
from nurbs_lab.hardware.interpolator import CONTROL, GO, LOAD_AT, LOAD_HIGH, LOAD_LOW, SHAPE, STATUS

CURVE, PERIOD_S = nl.paper.CURVE, 1e-3
FEED = nl.plan_feed(CURVE, speed=40.0, acceleration=4000.0, period_s=PERIOD_S)


class Board:
    """A twin of the board behind a pseudo-terminal; ``spoil(answer, count)`` may change what it says."""

    def __init__(self, monkeypatch, spoil=lambda answer, count: answer, **registers):
        self.near, far = os.openpty()
        tty.setraw(far)
        self.far, self.port = far, os.ttyname(far)
        self.registers = {board.IDENTITY: board.VERSION, board.CLOCK: 50_000_000, SHAPE: board.BUILT}
        self.registers |= {getattr(board, name): value for name, value in registers.items()}
        self.loaded, self.spoil, self.requests = [], spoil, 0
        self.program = self.number = None
        run = board.Conversation.run
        monkeypatch.setattr(board, "PATIENCE_S", 0.15)
        monkeypatch.setattr(board.Conversation, "run", lambda talk, *job: run(talk, *self.remember(*job)))
        threading.Thread(target=self.serve, daemon=True).start()

    def remember(self, *job):
        self.program = job[0]
        return job

    def serve(self):
        while True:
            try:
                request = os.read(self.near, 9)
                while len(request) < 9:
                    request += os.read(self.near, 9 - len(request))
            except OSError:
                return
            self.requests += 1
            number, order, address = request[1], request[2] >> 7, (request[2] & 127) << 2
            data = int.from_bytes(request[3:7], "little")
            assert request == board.encode(board.ASK, number, request[2], data)
            if number == 0 or number != self.number:  # else it is asked again
                code = self.write(address, data) if order else 0
                found = 0 if order else self.registers.get(address, 0)
                self.answer = board.encode(board.ANSWER, number, code, found)
            self.number = number
            os.write(self.near, self.spoil(self.answer, self.requests))

    def write(self, address, data):
        self.registers[address] = data
        if address == LOAD_AT:
            self.loaded.append(
                (data >> 10, data & 1023, self.registers[LOAD_HIGH] << 32 | self.registers[LOAD_LOW])
            )
        if (address, data) == (CONTROL, GO):
            mask = (1 << 64) - 1
            assert self.loaded[:-1] == [(s, i, value & mask) for s, i, value in self.program.batches()[0]]
            run = run_exact(self.program)
            scales = [self.registers[board.SCALE_X + 4 * i] for i in range(3)]
            steps = axes.count_steps(run.points, scales)[-1]
            self.registers |= {
                board.POINTS: len(run.u),
                board.CHECKSUM: axes.points_checksum(run.u, run.points),
            }
            self.registers |= {board.STEPS_X + 4 * i: n & 0xFFFFFFFF for i, n in enumerate(steps)}
            self.registers[STATUS] = board.ENDED
        return board.REFUSED if address == board.BOARD_STATUS else 0

    def trace(self, **options):
        return nl.trace(CURVE, FEED, stepper="board", port=self.port, **options)


def test_a_path_is_that_of_the_exact_twin(monkeypatch):
    """In a plane it has no height; its steps are those of its length to a fraction of one."""
    path = Board(monkeypatch).trace(steps_per_mm=200.0)
    same = nl.trace(CURVE, FEED, stepper="exact")
    assert np.abs(path.points - same.points).max() < 2e-6  # mm
    moved = (path.points[-1] - path.points[0]) * 200.0
    assert np.abs(np.array(path.details["feed_table"]) - [*moved, 0.0]).max() <= 0.51


def test_requests_and_answers_that_get_lost_come_again(monkeypatch):
    """Some are lost, one in eleven is damaged, one in thirteen tells of a damaged request."""

    def spoil(answer, count):
        if count % 97 == 0:  # costs the whole patience of the host
            return b""
        if count % 11 == 0:
            return answer[:5] + bytes((answer[5] ^ 4,)) + answer[6:]
        return board.encode(board.ANSWER, 0, 0x10 + count % 5, 0) if count % 13 == 0 else answer

    assert Board(monkeypatch, spoil).trace().details["feed_table"][0] != 0


@pytest.mark.parametrize(
    ("spoil", "registers", "message"),
    [
        (lambda answer, count: b"", {}, r"does not answer.*\(3 tries\)"),
        (lambda answer, count: answer[:8] + b"?", {}, "answers have a wrong checksum"),
        (lambda answer, count: board.encode(board.ANSWER, 0, 0x11, 0), {}, "with a wrong stop bit"),
        (lambda answer, count: board.encode(board.ANSWER, 77, 0, 0), {}, "answered request 77, not 0"),
        (lambda answer, count: board.encode(board.ANSWER, answer[1], 0x15, 0), {}, "not answered by the bus"),
        (
            lambda answer, count: answer,
            {"IDENTITY": 0x4E4C0099},
            "has version 0x4e4c0099 .* `make bitstream`",
        ),
        (lambda answer, count: answer, {"SHAPE": 35}, "not exact slopes in space"),
        (lambda answer, count: answer, {"BOARD_STATUS": 1 << 8}, "the emergency stop is pressed"),
        (lambda answer, count: answer, {"STEPS_X": 0}, "did not run the twin's path"),
    ],
)
def test_what_goes_wrong_is_named(monkeypatch, spoil, registers, message):
    twin = Board(
        monkeypatch, spoil, **{name: value for name, value in registers.items() if name != "STEPS_X"}
    )
    if "STEPS_X" in registers:
        monkeypatch.setattr(axes, "points_checksum", lambda *_: 1)
    with pytest.raises(RuntimeError, match=message):
        twin.trace()


def test_ports_and_options_are_checked(monkeypatch, tmp_path):
    plain = tmp_path / "plain"
    plain.touch()
    for port, message in (
        ("", "port is missing"),
        ("/dev/no-such", "cannot be opened"),
        (str(plain), "no serial port"),
    ):
        with pytest.raises(ValueError, match=message):
            nl.trace(CURVE, FEED, stepper="board", port=port)
    with pytest.raises(ValueError, match=r"steps_per_mm must be from .* got 1e\+09"):
        nl.trace(CURVE, FEED, stepper="board", port="x", steps_per_mm=1e9)
    with pytest.raises(ValueError, match=r"an axis would make .* steps a second"):
        Board(monkeypatch).trace(steps_per_mm=40_000.0)
    odd = nl.plan_feed(CURVE, speed=40.0, acceleration=4000.0, period_s=1.00000123e-3)
    with pytest.raises(ValueError, match="period_s must be a whole number of 2e-08 s"):
        nl.trace(CURVE, odd, stepper="board", port=Board(monkeypatch).port)
