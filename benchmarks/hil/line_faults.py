"""Effect of a bad serial line on frames: how many damaged ones are accepted and wrong.

Each damaged frame is followed by two whole ones, of which the second must always be received. A wrong frame "passes" if
the framing accepts it; it is "obeyed" if the loop would accept it as the answer to the last frame too: with the right
number, consistent speeds within the robot's limits, and a possible count of frames.

    python benchmarks/hil/line_faults.py [--frames 1000000] [--framing framed] [--robot nominal] [--seed 1]
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from configs.loader import load_section
from configs.schema.robot import RobotConfig
from hil.frames import CommandFrame, SensorFrame
from hil.framings import FRAMINGS
from hil.framings.base import CommandMessage, Framing, HelloRequest, SensorsMessage
from hil.plausibility import DriveLimits, TickCount
from symolo.dataset.codes import State

STATES = tuple(State)
KINDS = (
    "1 bit", "2 bits", "3 bits", "4 to 8 bits", "burst to 16 bits", "burst 17 to 64 bits", "bytes lost", "bytes more",
    "cut short", "end lost", "bytes swapped", "the one before again", "an older one", "garbage",
)  # fmt: skip


@dataclass
class Tally:
    """Counts of damaged frames of one kind."""

    damaged: int = 0
    passed: int = 0
    """Number of wrong frames that the framing accepted."""
    obeyed: int = 0
    """Number of these that the loop would have obeyed."""
    unharmed: int = 0
    """Number of damaged frames whose content is still right."""
    first_lost: int = 0
    """Number of whole frames right after a damaged one that were not decoded."""
    second_lost: int = 0
    """Number of whole frames after that which were not decoded; re-synchronisation has failed."""

    def __add__(self, other: "Tally") -> "Tally":
        return Tally(*(getattr(self, name) + getattr(other, name) for name in self.__dataclass_fields__))


def flipped(frame: bytes, bits: list[int]) -> bytes:
    number = int.from_bytes(frame, "little")
    for bit in bits:
        number ^= 1 << bit
    return number.to_bytes(len(frame), "little")


def damaged(frame: bytes, older: list[bytes], kind: str, draw: np.random.Generator) -> bytes:
    """Return a frame after damage of one kind; `older` are the frames before it, the last one first."""
    at, some = int(draw.integers(len(frame))), int(draw.integers(1, 5))
    match kind:
        case "bytes lost":
            return frame[:at] + frame[at + some :]
        case "bytes more":
            return frame[:at] + draw.bytes(some) + frame[at:]
        case "cut short":
            return frame[:at]
        case "end lost":
            return frame[:-1]
        case "bytes swapped":
            return frame[:at] + frame[at : at + 2][::-1] + frame[at + 2 :]
        case "the one before again":
            return older[0]
        case "an older one":
            return older[some % 3 + 1]
        case "garbage":
            return draw.bytes(len(frame))
        case _:
            return flipped(frame, bits_of(kind, 8 * len(frame), draw))


def bits_of(kind: str, size: int, draw: np.random.Generator) -> list[int]:
    """Which bits of a frame that has `size` of them are flipped."""
    if kind.startswith("burst"):
        low, high = (2, 17) if kind == "burst to 16 bits" else (17, 65)
        length = int(draw.integers(low, high))
        begin = int(draw.integers(size - length + 1))
        inside = np.flatnonzero(draw.integers(0, 2, length - 2)) + begin + 1
        return [begin, begin + length - 1, *inside.tolist()]
    many = int(draw.integers(4, 9)) if kind == "4 to 8 bits" else int(kind[0])
    chosen: set[int] = set()
    while len(chosen) < many:
        chosen.add(int(draw.integers(size)))
    return sorted(chosen)


def drawn_command(limits: DriveLimits, ticks: int, draw: np.random.Generator) -> CommandFrame:
    """Return a random command of a controller, rounded as on the wire."""
    v, w = draw.uniform(-0.05, 0.3), draw.uniform(-2.5, 2.5)
    turn = 0.5 * w * limits.track_m
    right, left = (v + turn) / limits.wheel_radius_m, (v - turn) / limits.wheel_radius_m
    speeds = (round(number, 3) for number in (right, left, v, w))
    return CommandFrame(STATES[int(draw.integers(len(STATES)))], *speeds, int(draw.integers(30)), ticks, 0)


def drawn_sensors(draw: np.random.Generator) -> SensorFrame:
    right, left = (int(number) for number in draw.integers(-100, 101, 2))
    line = tuple((draw.integers(0, 256, 8) / 255.0).tolist())
    front, left_m, right_m = (draw.integers(20, 2001, 3) / 1000.0).tolist()
    return SensorFrame((right, left), line, front, left_m, right_m)


def to_simulator(framing: Framing, kind: str, count: int, limits: DriveLimits, draw: np.random.Generator) -> Tally:
    """Damage of one kind to commands on their way from the board."""
    decoder, tally, older = framing.from_board(), Tally(), [b"\0"] * 4
    frames, tick = TickCount(), 0

    def transmit(damage: Callable[[bytes, list[bytes]], bytes]) -> tuple[CommandFrame, list[CommandMessage]]:
        nonlocal tick
        tick += 1
        sent = drawn_command(limits, min(tick, 65535), draw)
        data = framing.command(tick & 0xFF, sent)
        received = decoder.decode(damage(data, older))
        older.insert(0, data)
        older.pop()
        frames.sent((0, 0))
        return sent, [message for message in received if isinstance(message, CommandMessage)]

    def matches(answer: CommandMessage, sent: CommandFrame) -> bool:
        whole = sent if framing.numbers_frames else CommandFrame(sent.state, sent.right_rad_s, sent.left_rad_s)
        return answer.command == whole and answer.seq in {None, tick & 0xFF}

    def obeyed(answers: list[CommandMessage]) -> list[CommandMessage]:
        return [
            answer
            for answer in answers
            if answer.seq in {None, tick & 0xFF}
            and not limits.refusal(answer.command)
            and not frames.refusal(answer.command)
        ][:1]

    for _ in range(count):
        sent, answers = transmit(lambda data, before: damaged(data, before, kind, draw))
        tally.damaged += 1
        taken = obeyed(answers)
        tally.unharmed += any(matches(answer, sent) for answer in answers)
        tally.passed += any(not matches(answer, sent) for answer in answers)
        tally.obeyed += any(not matches(answer, sent) for answer in taken)
        for place in ("first_lost", "second_lost"):
            sent, answers = transmit(lambda data, _before: data)
            taken = obeyed(answers)
            whole = any(matches(answer, sent) for answer in taken)
            setattr(tally, place, getattr(tally, place) + (not whole))
            tally.obeyed += any(not matches(answer, sent) for answer in taken)
            if whole:
                frames.answered(replace(taken[0].command))
        if tick >= 60_000:
            frames, tick = TickCount(), tick & 0xFF
    return tally


def to_board(framing: Framing, kind: str, count: int, draw: np.random.Generator) -> Tally:
    """Damage of one kind to sensor frames on their way to the board, which obeys all that pass."""
    decoder, tally, older = framing.to_board(), Tally(), [b"\0"] * 4
    for number in range(count):
        for place in ("damaged", "first_lost", "second_lost"):
            sent = drawn_sensors(draw)
            data = framing.sensors((3 * number) & 0xFF, sent)
            spoilt = damaged(data, older, kind, draw) if place == "damaged" else data
            received = [message for message in decoder.decode(spoilt) if not isinstance(message, HelloRequest)]
            older = [data, *older[:-1]]
            decoded = [message.sensors for message in received if isinstance(message, SensorsMessage)]
            if place == "damaged":
                tally.damaged += 1
                tally.unharmed += sent in decoded
                tally.passed += any(frame != sent for frame in decoded)
            else:
                setattr(tally, place, getattr(tally, place) + (sent not in decoded))
    tally.obeyed = tally.passed
    return tally


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=1_000_000, help="damaged ones each way, of all kinds together")
    parser.add_argument("--framing", choices=FRAMINGS, default="framed")
    parser.add_argument("--robot", default="nominal")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    framing = FRAMINGS[arguments.framing]
    limits = DriveLimits.from_robot(RobotConfig.model_validate(load_section("robot", arguments.robot).tree))
    each = arguments.frames // len(KINDS)
    for direction in ("to the simulator", "to the board"):
        titles = f"{'damage':>22} {'damaged':>9} {'passed':>8} {'obeyed':>8} {'unharmed':>9}   lost 1  lost 2"
        print(f"{direction + ':':>18}{titles}")
        whole = Tally()
        for index, kind in enumerate(KINDS):
            draw = np.random.Generator(np.random.PCG64([arguments.seed, index]))
            if direction == "to the board":
                tally = to_board(framing, kind, each, draw)
            else:
                tally = to_simulator(framing, kind, each, limits, draw)
            show(kind, tally)
            whole += tally
        show("all", whole)


def show(kind: str, tally: Tally) -> None:
    numbers = f"{tally.damaged:9d} {tally.passed:8d} {tally.obeyed:8d} {tally.unharmed:9d}"
    print(f"{'':>18}{kind:>22} {numbers} {tally.first_lost:8d} {tally.second_lost:7d}", flush=True)


if __name__ == "__main__":
    main()
