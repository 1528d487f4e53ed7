"""The loop with boards that do their part and boards that do not."""

from dataclasses import replace

import pytest

from hil.errors import BoardLost
from hil.frames import HelloFrame
from hil.framings import FRAMINGS
from hil.framings.framed import Framed
from hil.loop import BoardLoop, LoopSettings
from symolo.core.errors import InputError
from symolo.dataset.codes import State
from tests.hil.stand_in_board import StandInBoard


class BadLine(StandInBoard):
    """Spoils what the board says by a function of tick and bytes; ticks count from the first step."""

    def __init__(self, framing, controller, spoil=lambda _tick, said: said):
        super().__init__(framing, controller)
        self.spoil = spoil
        self.tick = -1
        self.heard = []
        self.told = []

    def start_tick(self, tick_s):
        self.tick += 1
        return super().start_tick(tick_s)

    def write(self, data):
        self.told.append(data)
        super().write(data)

    def read(self):
        said = super().read()
        return self.spoil(self.tick, said) if said else said


@pytest.fixture
def drive(limits, command, seen):
    """Makes a loop with a board that asks for v = 0.01 n m/s in its n-th tick, and steps it."""

    def make(spoil=lambda _tick, said: said, framing=None, **settings):
        asked = []

        def controller(sensors):
            asked.append(sensors)
            return command(v=round(0.01 * len(asked), 3), w=0.5)

        framing = framing or Framed()
        link = BadLine(framing, controller, spoil)
        loop = BoardLoop(link, framing, limits, LoopSettings(**settings))
        link.heard = asked
        loop.start()
        del asked[:]  # what was told to greet a board that knows no hello
        link.tick = -1
        return loop, link, lambda count: [loop.step(seen()) for _ in range(count)]

    return make


def speeds(actuations):
    return [round(actuation.v_m_s, 4) for actuation in actuations]


def kinds(loop):
    return [(event.tick, event.kind) for event in loop.events]


@pytest.mark.parametrize("framing", FRAMINGS.values(), ids=FRAMINGS)
def test_a_command_acts_so_many_ticks_after_the_sensors_that_it_is_made_of(drive, framing):
    for delay, expected in ((0, [0.01, 0.02, 0.03]), (1, [0.0, 0.01, 0.02]), (2, [0.0, 0.0, 0.01])):
        loop, _, step = drive(framing=framing, delay_ticks=delay)
        assert speeds(step(3)) == expected
        assert loop.events == []


def test_orders_are_the_set_points_and_the_speeds_that_they_make(drive):
    _, _, step = drive(delay_ticks=0)
    [actuation] = step(1)
    # 20 v + 2 w and 20 v - 2 w for the drive of these tests
    assert (actuation.right_rad_s, actuation.left_rad_s) == (1.2, -0.8)
    assert (actuation.v_m_s, actuation.w_rad_s) == pytest.approx((0.01, 0.5))
    assert actuation.state is State.LINE


def test_a_board_is_greeted_and_started_once_and_stopped_at_the_end(drive):
    loop, link, step = drive()
    assert loop.board == HelloFrame(1, "00" * 8, 0)
    step(3)
    loop.close()
    loop.close()
    assert [(sensors.start, sensors.run) for sensors in link.heard] == [
        (True, True),
        (False, True),
        (False, True),
        (False, False),
    ]


def test_a_short_silence_is_driven_over_and_a_long_one_stops_the_robot(drive):
    loop, _, step = drive(spoil=lambda tick, said: b"" if 3 <= tick <= 6 else said, delay_ticks=1)
    actuations = step(10)
    # The command of tick 2 acts from tick 3, and two ticks more; then the wheels stand; no old command acts after that.
    assert speeds(actuations) == [0.0, 0.01, 0.02, 0.03, 0.03, 0.0, 0.0, 0.0, 0.08, 0.09]
    assert [actuation.stopped for actuation in actuations] == [False] * 5 + [True] * 2 + [False] * 3
    assert kinds(loop) == [
        (3, "no answer"),
        (4, "no answer"),
        (5, "no answer"),
        (5, "stopped"),
        (6, "no answer"),
        (7, "resumed"),
    ]


def test_a_silent_board_ends_the_run_with_its_reason(drive):
    loop, _, step = drive(spoil=lambda tick, said: b"" if tick >= 4 else said, give_up_s=0.5)
    with pytest.raises(
        BoardLost, match=r"^no command from stand-in board for 0\.5 s at 0\.65 s; the robot was stopped$"
    ):
        step(20)
    assert kinds(loop)[-1] == (13, "no answer")


def test_nobody_there_is_reported_at_once(limits, command):
    link = BadLine(Framed(), lambda _sensors: command(), lambda _tick, _said: b"")
    with pytest.raises(BoardLost, match=r"^no answer from stand-in board in 0\.2 s: is the firmware on it"):
        BoardLoop(link, Framed(), limits, LoopSettings(hello_s=0.2)).start()
    assert link.tick == 3


def test_another_wire_format_is_refused(limits, command):
    link = StandInBoard(Framed(), lambda _sensors: command())
    link._hello = HelloFrame(2, "00" * 8, 0)
    with pytest.raises(BoardLost, match="uses version 2 of the wire format, this program version 1: build and flash"):
        BoardLoop(link, Framed(), limits).start()


def test_a_board_that_boots_late_is_waited_for(limits, command):
    link = BadLine(Framed(), lambda _sensors: command(), lambda tick, said: said if tick >= 40 else b"")
    assert BoardLoop(link, Framed(), limits).start() == HelloFrame(1, "00" * 8, 0)


def test_a_board_that_re_boots_ends_the_run(drive):
    loop, link, step = drive()
    step(5)
    link.boot()
    with pytest.raises(BoardLost, match=r"^the board re-booted at 0\.25 s; the robot was stopped$"):
        step(1)
    assert kinds(loop) == [(5, "re-boot")]


def test_a_board_that_re_boots_may_be_driven_on_with(drive):
    loop, link, step = drive(on_reboot="go on")
    step(5)
    link.boot()
    step(3)
    assert kinds(loop) == [(5, "re-boot")]


def test_a_garbled_answer_is_no_answer(drive):
    def flip(tick, said):
        return said[:6] + bytes([said[6] ^ 4]) + said[7:] if tick in {2, 3} else said

    loop, _, step = drive(spoil=flip, delay_ticks=0)
    assert speeds(step(5)) == [0.01, 0.02, 0.02, 0.02, 0.05]
    assert kinds(loop) == [(2, "damaged"), (2, "no answer"), (3, "damaged"), (3, "no answer")]
    assert loop.events[0].text == "1 from the board: wrong checksum"


def test_frames_that_the_board_could_not_read_are_reported(drive):
    loop, link, step = drive()
    step(1)
    link.write(b"\0noise\0")
    step(1)
    assert [(event.tick, event.kind, event.text) for event in loop.events] == [(1, "damaged at the board", "1 frames")]


def test_an_answer_that_comes_late_is_never_obeyed(drive):
    held = []

    def late(tick, said):
        held.append(said)
        return held[-2] if tick in {3, 4} else said

    loop, _, step = drive(spoil=late, delay_ticks=0)
    assert speeds(step(6)) == [0.01, 0.02, 0.03, 0.03, 0.03, 0.06]
    assert kinds(loop) == [(3, "stale"), (3, "no answer"), (4, "stale"), (4, "no answer")]


def test_an_answer_that_comes_twice_is_obeyed_once(drive):
    loop, _, step = drive(spoil=lambda tick, said: said * 2 if tick == 1 else said, delay_ticks=0)
    assert speeds(step(3)) == [0.01, 0.02, 0.03]
    assert kinds(loop) == [(1, "repeated")]


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"right_rad_s": 21.0}, "set points 21 and -0.8 rad/s, the wheels reach 20.0"),
        ({"left_rad_s": 0.8}, "set points 1.2 and 0.8 rad/s do not fit 0.01 m/s and 0.5 rad/s"),
        ({"v_m_s": 0.05}, "set points 1.2 and -0.8 rad/s do not fit 0.05 m/s and 0.5 rad/s"),
    ],
)
def test_a_command_that_cannot_be_is_refused_though_its_checksum_is_right(limits, command, seen, wrong, why):
    link = StandInBoard(Framed(), lambda _sensors: replace(command(0.01), **wrong))
    loop = BoardLoop(link, Framed(), limits, LoopSettings(delay_ticks=0, give_up_s=0.1))
    loop.start()
    assert loop.step(seen()).right_rad_s == 0.0
    assert [event.text for event in loop.events if event.kind == "refused"] == [why]
    with pytest.raises(BoardLost, match=f"; last: {why}"):
        loop.step(seen())


def test_a_board_that_stands_still_on_purpose_is_obeyed(limits, command, seen):
    link = StandInBoard(Framed(), lambda _sensors: replace(command(0.2), right_rad_s=0.0, left_rad_s=0.0))
    loop = BoardLoop(link, Framed(), limits, LoopSettings(delay_ticks=0))
    loop.start()
    assert not loop.step(seen()).stopped
    assert loop.events == []


def test_a_count_of_frames_that_cannot_be_is_refused(drive):
    loop, link, step = drive(delay_ticks=0)
    step(2)
    link._ticks = 1000
    assert speeds(step(1)) == [0.02]
    assert kinds(loop) == [(2, "refused"), (2, "no answer")]
    assert loop.events[0].text == "the board counts 1001 frames after 2, and 1 were sent"


@pytest.mark.parametrize("lost", [{4}, {4, 5}, {0}])
def test_the_distance_in_lost_sensor_frames_is_sent_again(drive, seen, lost):
    """After the start the board's odometry holds; the way before it started is nobody's."""
    loop, link, _ = drive()
    write = link.write
    for tick in range(10):
        link.write = (lambda _data: None) if tick in lost else write
        loop.step(seen((tick + 1, 2)))
    begins = next(n for n, sensors in enumerate(link.heard) if sensors.start)
    assert begins == 0
    increments = [sensors.encoder_increments for sensors in link.heard]
    first = 2 if 0 in lost else 1
    assert sum(right for right, _ in increments) == sum(range(first, 11))
    assert sum(left for _, left in increments) == 2 * (11 - first)


def test_more_increments_than_a_frame_holds_are_sent_in_several(drive, seen):
    loop, link, _ = drive()
    write = link.write
    loop.step(seen((0, 0)))
    for tick in range(6):
        link.write = (lambda _data: None) if tick < 2 else write
        loop.step(seen((30_000, -30_000) if tick < 3 else (0, 0)))
    increments = [sensors.encoder_increments for sensors in link.heard]
    assert [sum(side) for side in zip(*increments, strict=True)] == [90_000, -90_000]
    assert max(abs(count) for counts in increments for count in counts) == 32_767


def test_a_robot_whose_encoders_do_not_fit_the_frame_is_refused(nominal, command):
    """At 6 V a nominal wheel turns without load at 19.3 rad/s, in 50 ms by 0.154 turns: 32767 / 0.154 = 213000."""
    fine = nominal.encoder.model_copy(update={"counts_per_revolution": 250_000})
    link = StandInBoard(Framed(), lambda _sensors: command())
    with pytest.raises(InputError, match=r"counts_per_revolution: got 250000, allowed: at most 213\d{3}"):
        BoardLoop.for_robot(link, Framed(), nominal.model_copy(update={"encoder": fine}))
