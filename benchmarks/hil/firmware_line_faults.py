"""The firmware's decoder, compiled for this machine, beside the one in Python on the same damaged bytes.

Both must decode the same frames; the firmware answers each of them once, with its number. Where they disagree, one
of them is wrong.

    python benchmarks/hil/firmware_line_faults.py [--frames 1000000] [--robot nominal] [--seed 1]
"""

import argparse
import ctypes
import tempfile
from pathlib import Path

import numpy as np
from line_faults import KINDS, damaged, drawn_sensors

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from hil.build import build_native
from hil.frames import HelloFrame
from hil.framings import FRAMINGS
from hil.framings.base import CommandMessage, Framing, HelloRequest, SensorsMessage

MAX_BYTES = 65536
"""Largest length of an answer."""
TICK_MS = 50


class NativeFirmware:
    """The firmware as a shared library: bytes in, bytes out."""

    def __init__(self, robot: RobotConfig, framing: Framing, folder: Path) -> None:
        self._library = ctypes.CDLL(str(build_native(robot, folder, framing.name)))
        self._answer = ctypes.create_string_buffer(MAX_BYTES)
        self._library.native_begin()

    def exchange(self, data: bytes) -> bytes:
        length = self._library.native_exchange(TICK_MS, data, len(data), self._answer)
        return self._answer.raw[:length]


def disagreements(firmware: NativeFirmware, framing: Framing, pieces: list[bytes]) -> int:
    """Return the number of pieces of a stream in which the two decode different frames."""
    decoder, back = framing.to_board(), framing.from_board()
    different = 0
    firmware.exchange(b"\0")  # ends a frame that it may have received in part
    for piece in pieces:
        received = [message for message in decoder.decode(piece) if isinstance(message, SensorsMessage | HelloRequest)]
        answers = [
            message
            for message in back.decode(firmware.exchange(piece))
            if isinstance(message, CommandMessage | HelloFrame)
        ]
        requested = [message.seq if isinstance(message, SensorsMessage) else None for message in received]
        answered = [message.seq if isinstance(message, CommandMessage) else None for message in answers]
        different += requested != answered
    return different


def damaged_stream(framing: Framing, kind: str, count: int, draw: np.random.Generator) -> list[bytes]:
    """Return frames of which every second one is damaged."""
    older, pieces = [b"\0"] * 4, []
    for number in range(2 * count):
        data = framing.sensors(number & 0xFF, drawn_sensors(draw))
        pieces.append(damaged(data, older, kind, draw) if number % 2 else data)
        older = [data, *older[:-1]]
    return pieces


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=1_000_000, help="damaged ones, and as many bytes of noise")
    parser.add_argument("--robot", default="nominal")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    robot = RobotConfig.model_validate(load_section("robot", arguments.robot).tree)
    framing = FRAMINGS["framed"]
    with tempfile.TemporaryDirectory() as folder:
        firmware = NativeFirmware(robot, framing, Path(folder))
        for index, kind in enumerate(KINDS):
            draw = np.random.Generator(np.random.PCG64([arguments.seed, index]))
            left, different = arguments.frames // len(KINDS), 0
            while left > 0:
                pieces = damaged_stream(framing, kind, min(left, 1000), draw)
                different += disagreements(firmware, framing, pieces)
                left -= 1000
            print(
                f"{kind:>22}: {arguments.frames // len(KINDS)} damaged frames, decoded differently {different}",
                flush=True,
            )
        noise = np.random.Generator(np.random.PCG64(arguments.seed)).bytes(arguments.frames)
        pieces = [noise[at : at + 1000] for at in range(0, len(noise), 1000)]
        print(f"{'noise':>22}: {len(noise)} bytes, decoded differently {disagreements(firmware, framing, pieces)}")


if __name__ == "__main__":
    main()
