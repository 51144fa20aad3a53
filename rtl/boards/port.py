"""A serial port by the terminal interface of POSIX. Every wait ends."""

import os
import select
import time

from .conversation import BAUD, LENGTH, PATIENCE_S


class Port:
    """A serial port at 3,000,000 baud, by the terminal interface of POSIX. Every wait ends."""

    def __init__(self, name: str):
        if not name:
            raise ValueError(
                "port is missing: name the serial port of the board, such as port='/dev/ttyACM0'"
            )
        try:
            import termios
            import tty
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
        try:
            tty.setraw(self.file)
            settings = termios.tcgetattr(self.file)
            settings[4] = settings[5] = getattr(termios, f"B{BAUD}", BAUD)
            termios.tcsetattr(self.file, termios.TCSANOW, settings)
        except termios.error:
            self.close()
            raise ValueError(f"port {name!r} is no serial port") from None

    def close(self):
        os.close(self.file)

    def sleep(self, seconds):
        time.sleep(seconds)

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
