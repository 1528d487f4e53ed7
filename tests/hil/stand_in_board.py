"""A stand-in for a board: a function from sensors to command behind a framing."""

from collections.abc import Callable
from dataclasses import replace

from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings.base import Framing, HelloRequest, SensorsMessage

Controller = Callable[[SensorFrame], CommandFrame]


class StandInBoard:
    """Answers each frame in the same tick, as the firmware does."""

    name = "stand-in board"

    def __init__(self, framing: Framing, controller: Controller, firmware_id: str = "00" * 8) -> None:
        self._framing = framing
        self._controller = controller
        self._hello = HelloFrame(1, firmware_id, 0)
        self._output = b""
        self.boot()

    def boot(self) -> None:
        """Reset the counters, as after a re-boot; the state of the controller stays."""
        self._decoder = self._framing.to_board()
        self._ticks = 0
        self._dropped = 0

    def start_tick(self, tick_s: float) -> float:
        del tick_s
        return 0.0

    def write(self, data: bytes) -> None:
        for message in self._decoder.decode(data):
            if isinstance(message, SensorsMessage):
                self._output += self._answer(message)
            elif isinstance(message, HelloRequest):
                self._output += self._framing.hello_answer(message.seq or 0, self._hello)
            else:
                self._dropped = min(self._dropped + 1, 255)

    def read(self) -> bytes:
        output, self._output = self._output, b""
        return output

    def close(self) -> None:
        self._output = b""

    def _answer(self, message: SensorsMessage) -> bytes:
        self._ticks = min(self._ticks + 1, 65535)
        command = replace(self._controller(message.sensors), ticks=self._ticks, dropped=self._dropped)
        self._dropped = 0
        return self._framing.command(message.seq or 0, command)
