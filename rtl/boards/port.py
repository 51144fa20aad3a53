"""A serial port by the terminal interface of POSIX. Every wait ends."""

import os
import select
import time

from nurbs_lab.common.checks import as_path

from .conversation import BAUD, LENGTH, PATIENCE_S


class Port:
    """A serial port at 3,000,000 baud, by the terminal interface of POSIX. Every wait ends."""

    def __init__(self, name: str):
        if not name:
            raise ValueError(
                "port is missing: name the serial port of the board, such as port='/dev/ttyACM0'"
            )
        name = str(as_path("port", name))
        try:
            import fcntl
            import termios
        except ImportError:  # Windows
            raise ValueError("port: serial ports are opened on Linux and macOS only") from None
        self.trouble = (OSError, termios.error)
        try:
            self.file = os.open(name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError as error:
            raise ValueError(
                f"port {name!r} cannot be opened: {error.strerror}; "
                "is the board plugged in, and may you use it?"
            ) from None
        self.flush = lambda: termios.tcflush(self.file, termios.TCIFLUSH)
        trouble = f"port {name!r} is no serial port, or not of {BAUD} baud"
        try:
            speeds = [getattr(termios, f"B{BAUD}", BAUD)] * 2
            # Bytes of 8 bits as they are, whatever the program before has left; no handshake.
            bare = [0, 0, termios.CS8 | termios.CREAD | termios.CLOCAL, 0, *speeds]
            termios.tcsetattr(self.file, termios.TCSANOW, [*bare, termios.tcgetattr(self.file)[6]])
            if termios.tcgetattr(self.file)[4:6] != speeds:
                raise ValueError(trouble)
            trouble = f"port {name!r} is in use by another program"
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (*self.trouble, ValueError):
            self.close()
            raise ValueError(trouble) from None

    def close(self):
        os.close(self.file)

    def sleep(self, seconds):
        time.sleep(seconds)

    @property
    def time_s(self):
        return time.monotonic()

    def exchange(self, request: bytes) -> bytes:
        """Send a request; what comes back within `PATIENCE_S`, however slowly it drips."""
        try:
            self.flush()
            end = time.monotonic() + PATIENCE_S
            while request and (left := end - time.monotonic()) > 0:
                if select.select([], [self.file], [], left)[1]:
                    request = request[os.write(self.file, request) :]
            answer = b""
            while len(answer) < LENGTH and (left := end - time.monotonic()) > 0:
                if select.select([self.file], [], [], left)[0]:
                    some = os.read(self.file, LENGTH - len(answer))
                    if not some:
                        raise RuntimeError("the port hung up: is the board still plugged in?")
                    answer += some
        except self.trouble as error:
            raise RuntimeError(f"the port failed: {error.args[-1]}") from None
        return answer
