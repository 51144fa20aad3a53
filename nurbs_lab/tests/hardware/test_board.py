"""The stepper 'board' and the host of rtl/boards: a simulated board, also behind a terminal that fails."""

import os
import termios
import threading
import time
import tty
from itertools import groupby

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, load_host, run_exact

CURVE, PERIOD_S = nl.paper.CURVE, 1e-3
FEED = nl.plan_feed(CURVE, speed=40.0, acceleration=4000.0, period_s=PERIOD_S)
host = load_host()
say, axes = host.say, host.axes_twin


def line_program(count=1, length=4.0, speed=40.0, **options):
    """Straight pieces in space, one after the other."""
    ends = np.cumsum(
        [[0.0, 0.0, 0.0], *[[length * (-1) ** (n // 50), 0.2, 0.01] for n in range(count)]], axis=0
    )
    curves = [nl.NurbsCurve(1, [0, 0, 1, 1], ends[n : n + 2]) for n in range(count)]
    feeds = [
        feed
        for _, feed in nl.motion.plan_windows(curves, speed=speed, acceleration=2000.0, period_s=PERIOD_S)
    ]
    return build_exact_program(curves, nl.motion.feed.concatenate(feeds), PERIOD_S, **options)


class Board:
    """A simulated board behind a pseudo-terminal; ``spoil(answer, count)`` may change what it says."""

    def __init__(self, monkeypatch, spoil=lambda answer, count: answer, drip_s=0.0, **registers):
        self.near, far = os.openpty()
        tty.setraw(far)
        self.far, self.port = far, os.ttyname(far)
        self.board, self.spoil, self.requests, self.drip_s = host.Simulation(), spoil, 0, drip_s
        self.board.registers |= {getattr(say, name): value for name, value in registers.items()}
        monkeypatch.setattr(say, "MARGIN_S", 0.3)
        monkeypatch.setattr("nurbs_lab_board.port.PATIENCE_S", 0.15)
        monkeypatch.setattr(
            host.Port, "insert", lambda port, program: self.board.insert(program), raising=False
        )
        threading.Thread(target=self.serve, daemon=True).start()

    def read(self, count):
        found = b""
        while len(found) < count:
            found += os.read(self.near, count - len(found))
        return found

    def serve(self):
        while True:
            try:
                request = self.read(9)
                if request[:1] == say.BLOCK:
                    request += self.read(5 * request[2] + 5 - 9)
                self.requests += 1
                self.board.sleep(0.02)
                answer = self.spoil(self.board.exchange(request), self.requests)
                if answer is None:
                    os.close(self.near)
                    return
                for at in range(0, len(answer), 1 if self.drip_s else 9):
                    os.write(self.near, answer[at:][: 1 if self.drip_s else 9])
                    time.sleep(self.drip_s)
            except OSError:
                return

    def trace(self, **options):
        return nl.trace(CURVE, FEED, stepper="board", port=self.port, **options)


def test_a_path_is_that_of_the_exact_twin(monkeypatch):
    """In a plane it has no height; its steps are those of its length to a fraction of one."""
    path = Board(monkeypatch).trace(steps_per_mm=200.0)
    same = nl.trace(CURVE, FEED, stepper="exact")
    assert np.abs(path.points - same.points).max() < 2e-6  # mm
    moved = (path.points[-1] - path.points[0]) * 200.0
    assert np.abs(np.array(path.details["steps"]) - [*moved, 0.0]).max() <= 0.51


def test_requests_and_answers_that_get_lost_come_again(monkeypatch):
    """Some are lost, one in eleven is damaged, one in thirteen tells of a damaged request."""

    def spoil(answer, count):
        if count % 29 == 0:  # costs the whole patience of the host
            return b""
        if count % 11 == 0:
            return answer[:5] + bytes((answer[5] ^ 4,)) + answer[6:]
        return say.encode(say.ANSWER, 0, 0x10 + count % 5, 0) if count % 13 == 0 else answer

    assert Board(monkeypatch, spoil).trace().details["steps"][0] != 0


@pytest.mark.parametrize(
    ("spoil", "registers", "message"),
    [
        (lambda answer, count: b"", {}, r"does not answer.*\(3 tries\)"),
        (lambda answer, count: answer[:8] + b"?", {}, "answers have a wrong checksum"),
        (lambda answer, count: say.encode(say.ANSWER, 0, 0x11, 0), {}, "with a wrong stop bit"),
        (lambda answer, count: say.encode(say.ANSWER, 77, 0, 0), {}, "answered request 77, not 0"),
        (lambda answer, count: say.encode(say.ANSWER, answer[1], 0x15, 0), {}, "not answered by the bus"),
        (lambda answer, count: answer if count < 9 else None, {}, "the port (failed|hung up)"),
        (
            lambda answer, count: answer,
            {"IDENTITY": 0x4E4C0099},
            "has version 0x4e4c0099 .* `make bitstream`",
        ),
        (lambda answer, count: answer, {"SHAPE": 35}, "not exact slopes in space"),
        (lambda answer, count: answer, {"CLOCK": 0}, "its clock has 0 Hz"),
        (lambda answer, count: answer, {"BOARD_STATUS": 1 << 8}, "the emergency stop is pressed"),
    ],
)
def test_what_goes_wrong_is_named_in_time(monkeypatch, spoil, registers, message):
    board = Board(monkeypatch, spoil, **registers)
    begun = time.monotonic()
    with pytest.raises(RuntimeError, match=message):
        board.trace()
    assert time.monotonic() - begun < 5.0


def test_a_port_that_drips_is_given_up(monkeypatch):
    """A byte in 0.1 s: no answer is whole within the patience, whatever comes."""
    begun = time.monotonic()
    with pytest.raises(RuntimeError, match="wrong checksum"):
        Board(monkeypatch, drip_s=0.1).trace()
    assert time.monotonic() - begun < 3.0


def test_a_port_is_bare_and_of_one_program(monkeypatch):
    """Whatever another program has left on it: flow control would take bytes out of the requests."""
    board = Board(monkeypatch)
    settings = termios.tcgetattr(board.far)
    settings[0] |= termios.IXON | termios.IXOFF | termios.INLCR
    settings[2] |= termios.CRTSCTS | termios.CSTOPB
    termios.tcsetattr(board.far, termios.TCSANOW, settings)
    host.Port(board.port)
    assert termios.tcgetattr(board.far)[:2] == [0, 0]
    assert not termios.tcgetattr(board.far)[2] & (termios.CRTSCTS | termios.CSTOPB)
    with pytest.raises(ValueError, match="in use by another program"):
        host.Port(board.port)


def test_a_board_that_never_ends_is_given_up_and_another_path_is_noticed(monkeypatch):
    """In the simulation's own time, which has to be little more than the planned one."""
    program = line_program()
    waits = say.BUSY | say.AWAITED | say.LOADED | say.LOADED << 1  # for a bank, with both banks full

    def late(request):
        board.sleep(0.2)
        return host.Simulation.exchange(board, request)

    still = {"period": lambda: None}
    for faults in (still, {"status": lambda: waits}, still | {"exchange": late}):
        board = host.Simulation()
        for name, fault in faults.items():
            monkeypatch.setattr(board, name, fault)
        with pytest.raises(RuntimeError, match="does not end"), host.Machine(board) as machine:
            list(machine.run(program, PERIOD_S))
        assert board.time_s < len(run_exact(program).u) * PERIOD_S + 6 * say.MARGIN_S
    board = host.Simulation()
    monkeypatch.setattr(board, "exchange", late)
    monkeypatch.setattr(say, "MARGIN_S", 0.3)  # less than a look takes
    with host.Machine(board) as machine:
        assert [*machine.run(program, PERIOD_S)][-1].ended
    board = host.Simulation()
    monkeypatch.setattr("nurbs_lab_board.simulated.points_checksum", lambda *_: 1)
    with pytest.raises(RuntimeError, match="did not run the twin's path"), host.Machine(board) as machine:
        list(machine.run(program, PERIOD_S))


def test_a_job_of_any_length_streams():
    """300 pieces of 1 mm at 40 mm/s, ten banks: none is awaited, and every point is the twin's."""
    program = line_program(300, 1.0)
    assert len(program.cuts()) > 9
    with host.Machine(host.Simulation(), steps_per_mm=800.0) as machine:
        seen = list(machine.run(program, PERIOD_S))
        assert not any(status.awaited for status in seen)
        end = np.ldexp(np.array(program.end, float), -program.point_fraction)
        assert np.abs(np.subtract(machine.position, end)).max() <= 1 / 800.0


def test_the_machine_is_steered_while_it_runs():
    """Hold, slow, resume, abort as calls; the place is kept, over a jog and over a run that is left."""
    program, board = line_program(), host.Simulation()
    with host.Machine(board) as machine:
        machine.locate((10.0, 20.0, 5.0))
        with pytest.raises(ValueError, match="begins 20 mm from where the tool stands"):
            next(machine.run(program, PERIOD_S))
        machine.offset = np.array([10.0, 20.0, 5.0])
        rested = 0
        for n, status in enumerate(machine.run(program, PERIOD_S)):
            if n == 2:
                machine.hold()
            rested += status.resting
            if n == 12:
                held = status.position
                machine.override(0.5)
        assert rested >= 5
        assert 10.0 < held[0] < 14.0
        assert np.allclose(machine.position, (14.0, 20.2, 5.01), atol=1 / 400)
        for _ in range(2):  # there, and where it stands already
            *_, status = machine.jog((10.0, 20.0, 5.0), speed=30.0, acceleration=500.0)
            assert np.allclose(status.position, (10.0, 20.0, 5.0), atol=1 / 400)
        for n, _ in enumerate(machine.run(program, PERIOD_S)):
            if n == 2:
                machine.abort()
        status = machine.status()
        assert "aborted" in status.flags
        assert 10.0 < status.position[0] < 14.0
        for _ in machine.jog((10.0, 20.0, 5.0), speed=30.0, acceleration=500.0):
            break  # whoever leaves the loop leaves the tool at rest
        status = machine.status()
        assert not status.busy
        assert status.placed
        for part in (-0.1, 1.1, np.nan):
            with pytest.raises(ValueError, match="part must be from 0"):
                machine.override(part)
        machine.offset = np.array(status.position)
        run = machine.run(program, PERIOD_S)
        next(run)
    assert board.points[-1] == board.points[-2]  # at rest before the drivers go
    run = host.Machine(board).run(program, PERIOD_S)
    next(run)
    host.Machine(board)  # and so does whoever comes while it moves
    assert board.ended
    assert board.aborted


def test_no_axis_is_too_fast_for_its_register_after_a_hold():
    """The periods then lie elsewhere on the path, and some move by a little more than any did as planned."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [[0.0, 0.0, 0.0], [10.0, 5.0, 1.0]])
    feed = nl.plan_feed(line, speed=40.0, acceleration=400.0, period_s=PERIOD_S)
    program = build_exact_program(line, feed, PERIOD_S)
    with host.Machine(host.Simulation()) as machine:
        for n, _ in enumerate(machine.run(program, PERIOD_S)):
            if n in (1, 4):
                machine.override(float(n > 1))


def test_outputs_come_and_go_with_the_motion():
    """Each curve has its own; a laser is off in a hold, all are off after the run and under the stop."""
    board, program = host.Simulation(), line_program(3, outputs=[say.outputs("coolant", "laser"), 0, 1])
    with host.Machine(board) as machine:
        seen = []
        for n, status in enumerate(machine.run(program, PERIOD_S)):
            seen.append(status.outputs)
            if n == 1:
                machine.hold()
            if n == 15:
                machine.resume()
        first = ("coolant", "laser")
        assert [on for on, _ in groupby(seen)] == [first, ("coolant",), first, (), ("spindle",), ()]
        run = machine.jog((0.0, 0.0, 0.0), speed=30.0, acceleration=500.0, outputs=("air",))
        assert next(run).outputs == ("air",)
        board.press()
        assert machine.status().outputs == ()


def test_a_stop_keeps_the_last_place_and_asks_for_it():
    """So do disabling and a stop between two runs: the tool may have been pushed."""
    program, board = line_program(), host.Simulation()
    with host.Machine(board) as machine:
        assert np.isnan(machine.position).all()
        run = machine.run(program, PERIOD_S)
        last = [next(run).position for _ in range(3)][-1]
        board.press()
        with pytest.raises(RuntimeError, match="emergency stop is pressed"):
            next(run)
        assert np.allclose(machine.position, last, atol=0.1)
        board.release()
        for disturb in (board.press, machine.release):
            with pytest.raises(RuntimeError, match=r"may have moved .* locate\(\)"):
                next(machine.run(program, PERIOD_S))
            machine.locate()
            list(machine.run(program, PERIOD_S))
            disturb()
            board.release()
        assert np.allclose(machine.position, (4.0, 0.2, 0.01), atol=1 / 400)


def test_a_position_is_of_one_moment():
    """While the tool moves along a line every look lies on it, though its three words come one by one."""
    seen = set()
    with host.Machine(host.Simulation(), steps_per_mm=1000.0) as machine:
        machine.locate((0.0, 0.0, 0.0))
        for status in machine.jog((40.0, -40.0, 20.0), speed=80.0, acceleration=4000.0):
            seen.add(status.steps)
    x, y, z = np.array(list(seen)).T
    assert len(x) > 30
    assert np.abs(x + y).max() <= 1
    assert np.abs(x - 2 * z).max() <= 2


def test_the_motors_keep_their_current_between_runs(monkeypatch):
    """But not where the period is another; a hold and its end within one look are no error."""
    board, orders, write = host.Simulation(), [], host.Simulation.write
    monkeypatch.setattr(
        board, "write", lambda at, data: orders.append((at, data)) or write(board, at, data), raising=False
    )
    there, disable = line_program(), (say.BOARD_CONTROL, say.DISABLE)
    with host.Machine(board) as machine:
        for n, _ in enumerate(machine.run(there, PERIOD_S)):
            if n == 1:
                machine.hold()
                board.sleep(0.1)
                machine.resume()
        del orders[:]
        move = {"speed": 30.0, "acceleration": 500.0}
        list(machine.jog((0.0, 0.0, 0.0), **move))
        assert disable not in orders
        list(machine.jog((1.0, 0.0, 0.0), **move, period_s=2e-3))
        assert orders.count(disable) == 1


def test_an_input_stops_the_tool_and_keeps_the_place_of_its_edge():
    board = host.Simulation()
    with host.Machine(board, steps_per_mm=400.0) as machine:
        machine.locate((0.0, 0.0, 0.0))
        jog = {"speed": 40.0, "acceleration": 400.0}
        machine.watch("limit x", "probe")
        seen = []
        for status in machine.jog((10.0, 5.0, 0.0), **jog):
            seen.append(status)
            if len(seen) == 6:
                board.touch("home x")  # not watched
                before = np.array(machine.position)
                board.touch("probe")
        assert seen[-1].touched == ("probe",)
        assert "aborted" in seen[-1].flags
        assert np.allclose(machine.touched_at(), before, atol=0.1)
        # Braking from 40 mm/s takes 2 mm; what stays is on the line, and the place is known.
        after = np.array(machine.position)
        assert 0.5 < np.linalg.norm(after - before) < 3.0
        assert np.allclose(after[1], after[0] / 2, atol=2 / 400)
        with pytest.raises(RuntimeError, match="is refused"):
            list(machine.jog((0.0, 0.0, 0.0), **jog))
        assert machine.position == tuple(after)
        with pytest.raises(RuntimeError, match="probe would not stop the tool, being at the level already"):
            machine.probe((0.0, 0.0, -1.0), **jog)
        assert machine.position == tuple(after)
        board.touch("probe", level=1)
        machine.watch("limit z")
        assert machine.probe(tuple(np.append(after[:2], 1.0)), **jog) is None
        next(machine.jog(tuple(after), **jog))
        board.touch("limit z")  # which a probe leaves watched
        assert machine.status().touched == ("limit z",)


def test_what_no_board_could_do_is_refused_before_it_moves():
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
    for options in ({"start_speed": 9.0}, {"end_speed": 9.0}):
        feed = nl.plan_feed(line, speed=40.0, acceleration=2000.0, period_s=PERIOD_S, **options)
        with (
            host.Machine(host.Simulation()) as machine,
            pytest.raises(ValueError, match="begin and end at rest"),
        ):
            next(machine.run(build_exact_program(line, feed, PERIOD_S), PERIOD_S))
    with pytest.raises(ValueError, match="steps_per_mm is nan"):
        host.Machine(host.Simulation(), steps_per_mm=np.nan)
    with host.Machine(host.Simulation()) as machine:
        with pytest.raises(ValueError, match="have the period_s of the run"):
            next(machine.run(line_program(), 2 * PERIOD_S))
        with pytest.raises(ValueError, match="must be in space"):
            next(machine.run(build_exact_program(CURVE, FEED, PERIOD_S), PERIOD_S))
        with pytest.raises(ValueError, match=r"position\[1\] is nan"):
            machine.locate((0.0, np.nan, 0.0))
        with pytest.raises(ValueError, match="watch takes level 0 or 1"):
            machine.watch("limit x", level=2)
        with pytest.raises(RuntimeError, match=r"nobody has told .* locate\(\)"):
            machine.jog((1.0, 0.0, 0.0), speed=1.0, acceleration=10.0)
        for _ in machine.run(line_program(), PERIOD_S):
            with pytest.raises(RuntimeError, match="a run is under way"):
                next(machine.jog((0.0, 0.0, 1.0), speed=1.0, acceleration=10.0))
            with pytest.raises(RuntimeError, match="a run is under way"):
                machine.locate()
