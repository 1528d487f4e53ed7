"""Runs a controller that is on a board at a serial line."""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass

from configs.schema.board import Board
from configs.schema.robot import RobotConfig
from hil.board.build import build_board, cache_folder
from hil.build import FirmwareBuild, build_firmware, firmware_sources
from hil.frames import SensorFrame
from hil.framings import FRAMINGS
from hil.links.base import BoardLink
from hil.links.lockstep import LockstepLink
from hil.links.serial_link import SerialLink
from hil.loop import BoardEvent, BoardLoop, LoopSettings
from physics.control.base import Observation, Twist
from physics.run.controller_runner import Decision
from symolo.dataset.codes import BOARD_EVENT_COLUMNS


@dataclass(frozen=True)
class BoardRunner:
    """Gets each decision from a board."""

    loop: BoardLoop
    firmware_id: str
    """Identity of the firmware; empty for a real board whose framing has no hello."""

    @property
    def events(self) -> tuple[BoardEvent, ...]:
        return tuple(self.loop.events)

    def decide(self, seen: Observation) -> Decision:
        before = len(self.loop.events)
        actuation = self.loop.step(
            SensorFrame(seen.encoder_increments, seen.line, seen.front_m, seen.left_m, seen.right_m)
        )
        command = Twist(actuation.v_m_s, actuation.w_rad_s, actuation.state)
        counts = event_counts(self.loop.events[before:], stopped=actuation.stopped)
        return Decision(command, (actuation.right_rad_s, actuation.left_rad_s), actuation.line_lost, counts)


@contextmanager
def connected_board(robot: RobotConfig, board: Board, control_hz: int, port: str = "") -> Iterator[BoardRunner]:
    """Connect to a board, wait for its answer, and stop it at the end.

    Args:
        robot: Robot whose controller the firmware is.
        board: Settings of the serial line.
        control_hz: Rate of the decisions.
        port: Serial port of a real board; empty for the simulated one.

    Raises:
        InputError: The port cannot be opened, or the robot's numbers do not fit the firmware.
        EnvironmentLacking: A compiler or a library is missing; names the line that installs it.
        RunFailed: No board answers.
    """
    link, firmware_id = _line(robot, board, port)
    settings = LoopSettings(
        tick_s=1.0 / control_hz,
        delay_ticks=board.actuation_delay_ticks,
        timeout_ticks=board.timeout_ticks,
        give_up_s=board.give_up_s,
    )
    with closing(link), BoardLoop.for_robot(link, FRAMINGS[board.framing], robot, settings) as loop:
        hello = loop.start()
        yield BoardRunner(loop, hello.firmware_id if hello else firmware_id)


def counted(events: Iterable[BoardEvent]) -> Counter[str]:
    """Return how many faults of each kind there were."""
    counts: Counter[str] = Counter()
    for event in events:
        counts[event.kind] += event.count
    return counts


def event_counts(events: Iterable[BoardEvent], *, stopped: bool) -> tuple[int, ...]:
    """Return the counts of the events of one tick, in the order of `BOARD_COLUMNS`: a row of side/board.csv.

    Args:
        events: Events of that tick.
        stopped: Whether the wheels are stopped because no command has come.
    """
    kinds = counted(events)
    return (int(not kinds["no answer"]), int(stopped), *(kinds[kind] for kind in BOARD_EVENT_COLUMNS))


def firmware_id_of(robot: RobotConfig, board: Board) -> str:
    """Return the identity of the firmware for the simulated board."""
    return firmware_sources(robot, board.framing, board.bits_per_s)[1]


def build_for(robot: RobotConfig, board: Board) -> FirmwareBuild:
    """Build the simulated board and its firmware as files in the user's cache, and return the firmware.

    Raises:
        InputError: The robot's numbers do not fit the firmware.
        EnvironmentLacking: A compiler or a library is missing; names the line that installs it.
    """
    build_board()
    return build_firmware(robot, board.framing, board.bits_per_s, cache_folder())


def _line(robot: RobotConfig, board: Board, port: str) -> tuple[BoardLink, str]:
    if port:
        return SerialLink(port, board.bits_per_s), ""
    firmware = build_for(robot, board)
    return LockstepLink(firmware.elf, board.bits_per_s), firmware.id
