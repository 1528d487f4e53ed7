"""The control loop with the controller on a board: it sends sensor readings, receives wheel commands, and stops the
robot safely when no commands come.
"""

from collections import deque
from dataclasses import dataclass, field, replace
from typing import Literal

from typing_extensions import Self

from configs.schema.robot import RobotConfig
from hil.closing import Closing
from hil.errors import BoardLost
from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings.base import CommandMessage, Damaged, Framing
from hil.links.base import BoardLink
from hil.plausibility import DriveLimits, TickCount, check_encoders
from symolo.dataset.codes import State

PROTOCOL = 1
"""Version of the wire format."""
_CAUSES = frozenset({"damaged", "refused", "stale"})
"""Kinds of event that explain a missing command."""
_AT_REST = SensorFrame((0, 0), (1.0,) * 8, None, None, None, run=False)
"""Readings with which the robot stops: no line, no range, no motion."""
_MAX_REASONS = 3
"""Largest number of reasons that the event about the damage of a tick names."""

Kind = Literal[
    "damaged",
    "damaged at the board",
    "refused",
    "stale",
    "repeated",
    "no answer",
    "stopped",
    "resumed",
    "re-boot",
    "late",
]


@dataclass(frozen=True)
class BoardEvent:
    """A fault, or the end of a fault, at one tick."""

    tick: int
    kind: Kind
    text: str
    """Description of the first one, where there are several of a kind in a tick."""
    count: int = 1
    """Number of faults of this kind in this tick."""


@dataclass(frozen=True)
class LoopSettings:
    """Timing, and what happens when the board does not answer."""

    tick_s: float = 0.05
    delay_ticks: int = 1
    """Number of ticks between the sensor readings and the motion that their command causes; 1 as in SimTwo."""
    timeout_ticks: int = 3
    """Number of ticks in a row without a command after which the wheels are stopped."""
    give_up_s: float = 2.0
    """Time [s] without a command after which the run ends."""
    hello_s: float = 5.0
    """Time [s] for the first answer; an Arduino, which resets when its port is opened, needs 2 s."""
    on_reboot: Literal["stop", "go on"] = "stop"
    """Action when the board re-boots: end the run, or go on with the commands that follow."""


@dataclass(frozen=True)
class Actuation:
    """What the wheels do from one tick on, and the state of the controller."""

    state: State
    right_rad_s: float
    left_rad_s: float
    """Set points [rad/s] of the wheels."""
    v_m_s: float
    w_rad_s: float
    """Forward speed [m/s] and yaw rate [rad/s] that belong to the set points."""
    line_lost: int
    """Number of ticks in the line state without a channel on the line; 0 where the framing does not transmit it."""
    stopped: bool
    """Whether the wheels are stopped because no command has come for too long."""


@dataclass
class BoardLoop(Closing):
    """Sends the sensor readings to a board at each tick, and returns what its answers make the wheels do.

    Call `start` once, `step` at each tick and `close` at the end; leaving a `with` block calls it too. `events` lists
    all faults, also after an error.
    """

    link: BoardLink
    framing: Framing
    limits: DriveLimits
    settings: LoopSettings = field(default_factory=LoopSettings)
    events: list[BoardEvent] = field(default_factory=list)
    board: HelloFrame | None = None
    """The answer to the hello; None before `start`, and where the framing has no hello."""

    def __post_init__(self) -> None:
        self._decoder = self.framing.from_board()
        self._tick = -1
        self._seq = 0
        self._count = TickCount()
        self._misses = 0
        self._answered = self._closed = False
        self._pending: deque[CommandFrame | None] = deque([None] * self.settings.delay_ticks)
        self._acting: CommandFrame | None = None

    @classmethod
    def for_robot(
        cls, link: BoardLink, framing: Framing, robot: RobotConfig, settings: LoopSettings | None = None
    ) -> Self:
        """Return the loop for a robot.

        Raises:
            InputError: Its encoders count more in a tick than a frame holds.
        """
        settings = settings or LoopSettings()
        check_encoders(robot, settings.tick_s)
        return cls(link, framing, DriveLimits.from_robot(robot), settings)

    def start(self) -> HelloFrame | None:
        """Wait until the board answers, and return its hello where the framing has one.

        Raises:
            BoardLost: No board answers, or its wire format has another version.
        """
        for _ in range(max(1, round(self.settings.hello_s / self.settings.tick_s))):
            self.link.start_tick(self.settings.tick_s)
            seq = self._next_seq()
            hello = self.framing.hello(seq)
            self.link.write(hello or self.framing.sensors(seq, _AT_REST))
            while data := self.link.read():
                for message in self._decoder.decode(data):
                    if isinstance(message, HelloFrame):
                        return self._check_hello(message)
                    if isinstance(message, CommandMessage) and not hello:
                        return self._drain()
        raise BoardLost(
            f"no answer from {self.link.name} in {self.settings.hello_s:g} s: is the firmware on it, built for the"
            f" framing {self.framing.name} and this baud rate?"
        )

    def step(self, sensors: SensorFrame) -> Actuation:
        """Send the sensor readings to the board, and return what the robot does until the next tick.

        Encoder increments of frames that the board lost are added to the next frame, so that its odometry stays right.

        Raises:
            BoardLost: No command came for longer than `give_up_s`, the board re-booted, or it was unplugged.
        """
        self._tick += 1
        late_s = self.link.start_tick(self.settings.tick_s)
        if late_s > self.settings.tick_s:
            self._note("late", f"the tick begins {1000.0 * late_s:.0f} ms late")
        sent = replace(
            sensors, encoder_increments=self._count.with_lost(sensors.encoder_increments), start=not self._answered
        )
        self._count.sent(sent.encoder_increments)
        self.link.write(self.framing.sensors(self._next_seq(), sent))
        command = self._answer()
        self._count_misses(command)
        self._pending.append(command)
        self._acting = self._pending.popleft() or self._acting
        return self._actuation()

    def close(self) -> None:
        """Stop the robot and close the line; may be called again."""
        if self._closed:
            return
        self._closed = True
        try:
            self.link.start_tick(self.settings.tick_s)
            self.link.write(self.framing.sensors(self._next_seq(), _AT_REST))
            self.link.read()
        except BoardLost:
            pass  # without frames the firmware stops the robot by itself
        finally:
            self.link.close()

    def _next_seq(self) -> int:
        self._seq = (self._seq + 1) & 0xFF
        return self._seq

    def _check_hello(self, hello: HelloFrame) -> HelloFrame:
        if hello.protocol != PROTOCOL:
            raise BoardLost(
                f"{self.link.name} uses version {hello.protocol} of the wire format, this program version {PROTOCOL}:"
                " build and flash the firmware again"
            )
        self.board = hello
        return hello

    def _drain(self) -> None:
        """Let a tick pass, so that a late answer to the hello is not mistaken for one to the next frame."""
        self.link.start_tick(self.settings.tick_s)
        while data := self.link.read():
            self._decoder.decode(data)

    def _answer(self) -> CommandFrame | None:
        """Return the command that answers the last frame, or None when the tick ends without a good one."""
        command: CommandFrame | None = None
        damage: list[str] = []
        while command is None and (data := self.link.read()):
            for message in self._decoder.decode(data):
                if isinstance(message, Damaged):
                    damage.append(message.reason)
                elif isinstance(message, CommandMessage):
                    command = self._checked(message, command)
        if damage:
            self._note("damaged", f"{len(damage)} from the board: {', '.join(damage[:_MAX_REASONS])}")
        return command

    def _checked(self, answer: CommandMessage, accepted: CommandFrame | None) -> CommandFrame | None:
        """Return the command for this tick after one more answer."""
        command = answer.command
        if answer.seq is not None and answer.seq != self._seq:
            self._note("stale", f"an answer to frame {answer.seq}, the last is {self._seq}")
        elif accepted is not None:
            self._note("repeated", "one more answer to the same frame")
        elif reason := self.limits.refusal(command) or self._count.refusal(command):
            self._note("refused", reason)
        else:
            self._accept(command)
            return command
        return accepted

    def _accept(self, command: CommandFrame) -> None:
        self._answered = True
        rebooted = self._count.answered(command)
        if command.dropped:
            self._note("damaged at the board", f"{command.dropped} frames")
        if rebooted:
            self._note("re-boot", f"the board re-booted and counts {command.ticks} frames")
            if self.settings.on_reboot == "stop":
                raise BoardLost(f"the board re-booted {self._when()}; the robot was stopped")

    def _count_misses(self, command: CommandFrame | None) -> None:
        """Count ticks without a command, and end the run when there are too many."""
        settings = self.settings
        if command is not None:
            if self._misses >= settings.timeout_ticks:
                self._note("resumed", f"after {self._misses} ticks without a command")
            self._misses = 0
            return
        self._misses += 1
        self._note("no answer", "no command to this tick's frame")
        if self._misses == settings.timeout_ticks:
            self._note("stopped", f"{self._misses} ticks without a command: the wheels are stopped")
            # An old command must not act again when the next one has come but does not act yet.
            self._pending = deque([None] * settings.delay_ticks)
            self._acting = self._acting and replace(self._acting, right_rad_s=0.0, left_rad_s=0.0)
        if self._misses * settings.tick_s >= settings.give_up_s:
            why = next((f"; last: {event.text}" for event in reversed(self.events) if event.kind in _CAUSES), "")
            silence = f"no command from {self.link.name} for {settings.give_up_s:g} s {self._when()}"
            raise BoardLost(f"{silence}; the robot was stopped{why}")

    def _actuation(self) -> Actuation:
        acting = self._acting or CommandFrame(State.LINE, 0.0, 0.0)
        stopped = self._misses >= self.settings.timeout_ticks
        twist, line_lost = self.limits.twist(acting), acting.line_lost or 0
        return Actuation(acting.state, acting.right_rad_s, acting.left_rad_s, *twist, line_lost, stopped)

    def _when(self) -> str:
        return f"at {self._tick * self.settings.tick_s:.2f} s"

    def _note(self, kind: Kind, text: str) -> None:
        """Record an event; those of one kind in one tick are counted, since a board may send thousands."""
        events = self.events
        for place in range(len(events) - 1, -1, -1):
            if events[place].tick != self._tick:
                break
            if events[place].kind == kind:
                events[place] = replace(events[place], count=events[place].count + 1)
                return
        events.append(BoardEvent(self._tick, kind, text))
