"""A board that is none: a function from sensors to command behind a framing, for tests and for trying things out."""

from collections.abc import Callable
from dataclasses import replace

from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings.base import Framing, HelloRequest, SensorsMessage

Controller = Callable[[SensorFrame], CommandFrame]


class StandInBoard:
    """Answers each frame in the tick in which it comes, as firmware does."""

    name = "stand-in board"

    def __init__(self, framing: Framing, controller: Controller, firmware_id: str = "00" * 8) -> None:
        self._framing = framing
        self._controller = controller
        self._hello = HelloFrame(1, firmware_id, 0)
        self._said = b""
        self.boot()

    def boot(self) -> None:
        """Start afresh, as after a reset; the controller's state is its own affair."""
        self._ears = self._framing.to_board()
        self._ticks = 0
        self._dropped = 0

    def start_tick(self, tick_s: float) -> float:
        del tick_s
        return 0.0

    def write(self, data: bytes) -> None:
        for heard in self._ears.feed(data):
            if isinstance(heard, SensorsMessage):
                self._said += self._answer(heard)
            elif isinstance(heard, HelloRequest):
                self._said += self._framing.hello_answer(heard.seq or 0, self._hello)
            else:
                self._dropped = min(self._dropped + 1, 255)

    def read(self) -> bytes:
        said, self._said = self._said, b""
        return said

    def close(self) -> None:
        self._said = b""

    def _answer(self, asked: SensorsMessage) -> bytes:
        self._ticks = min(self._ticks + 1, 65535)
        command = replace(self._controller(asked.sensors), ticks=self._ticks, dropped=self._dropped)
        self._dropped = 0
        return self._framing.command(asked.seq or 0, command)
