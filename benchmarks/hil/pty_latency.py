"""How long the firmware behind a pty takes to answer at the control rate in real time, and whether it misses a tick.

The robot has free space ahead and a line that swings; the time is from writing the sensors to the whole command.
With `--port` the same of a real board.

    python benchmarks/hil/pty_latency.py [--seconds 60] [--framing framed] [--robot nominal] [--port /dev/ttyACM0]
"""

import argparse
import contextlib
import tempfile
import time
from pathlib import Path

import numpy as np

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from hil.build import build_firmware
from hil.frames import SensorFrame
from hil.framings import FRAMINGS
from hil.framings.base import Framing
from hil.links.pty_board import PtyBoard
from hil.links.serial_link import SerialLink
from hil.loop import BoardLoop

RATE_HZ = 20


class TimedLink(SerialLink):
    """Notes when the last bytes of each tick came in."""

    wrote_s = 0.0
    answered_ms = float("nan")
    late_ms = 0.0

    def start_tick(self, tick_s: float) -> float:
        self.answered_ms = float("nan")
        late_s = super().start_tick(tick_s)
        self.late_ms = 1000.0 * late_s
        return late_s

    def write(self, data: bytes) -> None:
        self.wrote_s = time.monotonic()
        super().write(data)

    def read(self) -> bytes:
        data = super().read()
        if data:
            self.answered_ms = 1000.0 * (time.monotonic() - self.wrote_s)
        return data


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--framing", choices=FRAMINGS, default="framed")
    parser.add_argument("--robot", default="nominal")
    parser.add_argument("--port", help="of a real board; without it the simulated one")
    arguments = parser.parse_args()
    robot = RobotConfig.model_validate(load_section("robot", arguments.robot).tree)
    framing = FRAMINGS[arguments.framing]
    with contextlib.ExitStack() as stack:
        port = arguments.port
        if port is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
            build = build_firmware(robot, arguments.framing, framing.baud, folder)
            port = stack.enter_context(PtyBoard(build.elf, framing.baud)).port
        measure(TimedLink(port, framing.baud), framing, robot, round(arguments.seconds * RATE_HZ))


def measure(link: TimedLink, framing: Framing, robot: RobotConfig, ticks: int) -> None:
    loop = BoardLoop.for_robot(link, framing, robot)
    hello = loop.start()
    answered, late = [], []
    for tick in range(ticks):
        line = [1.0] * 8
        line[3 + tick // 20 % 2] = 0.1
        loop.step(SensorFrame((20, 20), tuple(line), 2.0, 2.0, 2.0))
        answered.append(link.answered_ms)
        late.append(link.late_ms)
    loop.close()
    missed = sum(event.kind == "no answer" for event in loop.events)
    print(f"{framing.name} at {framing.baud} baud, {link.name}, {hello}")
    print(f"{ticks} ticks of {1000 / RATE_HZ:.0f} ms, missed {missed}, events {len(loop.events)}")
    for event in loop.events:
        print(f"  tick {event.tick}: {event.kind}: {event.text}, answer after {answered[event.tick]:.2f} ms")
    for name, values in (("answer [ms]", answered), ("tick begins late [ms]", late)):
        sample = np.array(values)
        marks = ", ".join(f"{mark} % {np.nanpercentile(sample, mark):.2f}" for mark in (50, 90, 99))
        print(f"{name}: {marks}, worst {np.nanmax(sample):.2f}")


if __name__ == "__main__":
    main()
