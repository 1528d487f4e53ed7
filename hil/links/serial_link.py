"""A board at a serial port or pty in real time, through pyserial."""

import errno
import importlib
import os
import select
import time
from typing import Any

from hil.errors import BoardLost
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.extras import how_to_install

INSTALL = how_to_install("generate")
_WRITE_S = 1.0
_WHY = {
    errno.ENOENT: ("there is no such port", "`ls /dev/ttyACM* /dev/ttyUSB*` lists the boards that are plugged in"),
    errno.EACCES: ("you may not open the port", "run `usermod -a -G dialout USER` as root, and log in again"),
    errno.EBUSY: ("another program has the port", "close its serial monitor"),
    errno.EAGAIN: ("another program has the port", "close its serial monitor"),
    errno.ENODEV: ("there is no device behind the port", "plug the board in"),
    errno.ENXIO: ("there is no device behind the port", "plug the board in"),
    errno.EIO: ("there is no device behind the port", "plug the board in"),
    errno.ENOTTY: ("this is no serial port", "name one, such as /dev/ttyACM0"),
    errno.EISDIR: ("this is no serial port", "name one, such as /dev/ttyACM0"),
}


class SerialLink:
    """Sends at the beginning of each tick and accepts answers during a share of it; the simulation needs the rest."""

    def __init__(self, port: str, baud: int, *, answer_within: float = 0.5) -> None:
        """Open a port, which resets an Arduino that is plugged in.

        Args:
            port: Path of the device.
            baud: Bits per second.
            answer_within: Share of a tick in which answers are accepted.

        Raises:
            EnvironmentLacking: pyserial is not installed.
            InputError: The port is not there, not free or not permitted.
        """
        self.name = port
        self._answer_within = answer_within
        self._serial = _open(port, baud)
        self._due_s: float | None = None
        self._answer_by_s = 0.0
        self._is_over = False
        """Whether the time for answers of this tick has ended."""

    def start_tick(self, tick_s: float) -> float:
        """Sleep until the next tick is due. A tick that is late by more than a tick shifts all later ones."""
        now_s = time.monotonic()
        self._due_s = now_s if self._due_s is None else self._due_s + tick_s
        if self._due_s > now_s:
            time.sleep(self._due_s - now_s)
        begins_s = time.monotonic()
        late_s = max(0.0, begins_s - self._due_s)
        if late_s > tick_s:
            self._due_s = begins_s
        self._answer_by_s = begins_s + self._answer_within * tick_s
        self._is_over = False
        return late_s

    def write(self, data: bytes) -> None:
        try:
            self._serial.write(data)
        except OSError as error:
            raise self._gone(error) from None

    def read(self) -> bytes:
        if self._is_over:  # a board that floods the line would keep its reader busy for ever
            return b""
        try:
            left_s = max(0.0, self._answer_by_s - time.monotonic())
            self._is_over = not left_s  # what has come by now is read once
            ready, _, _ = select.select([self._serial.fileno()], [], [], left_s)
            return self._serial.read(max(1, self._serial.in_waiting)) if ready else b""
        except OSError as error:
            raise self._gone(error) from None

    def close(self) -> None:
        self._serial.close()

    def _gone(self, error: OSError) -> BoardLost:
        return BoardLost(f"the board at {self.name} is gone: {_reason(error)}")


def _open(port: str, baud: int) -> Any:  # noqa: ANN401 - of a package that need not be there
    try:
        serial = importlib.import_module("serial")
    except ImportError:
        raise EnvironmentLacking(
            f"a board at a serial port needs pyserial, which is not installed; {INSTALL}"
        ) from None
    try:
        return serial.Serial(port, baud, timeout=0, write_timeout=_WRITE_S, exclusive=True)
    except (OSError, ValueError) as error:
        what, cure = _WHY.get(_number(error) or 0, (_reason(error), ""))
        raise InputError(what, where=f"--port {port}", cure=cure) from None


def _number(error: BaseException) -> int | None:
    """Return the system's error number, which pyserial leaves in the error that it caught if that is one of termios."""
    caught = error.__context__
    number = getattr(error, "errno", None) or (caught.args[0] if caught is not None and caught.args else None)
    return number if isinstance(number, int) else None


def _reason(error: BaseException) -> str:
    number = _number(error)
    return str(error) if number is None else os.strerror(number)
