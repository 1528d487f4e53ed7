"""The firmware as a library of this machine, and the controller in Python that it is held against."""

import copy
import ctypes
import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from configs.loader import RobotAlone, load_section
from configs.validation.values import validated
from hil.build import build_native
from physics.control.base import ControllerSettings, Observation, Twist
from physics.control.built_in import BuiltIn
from physics.control.curves import CurveFollower
from sensors.wheels.odometry import Odometry
from symolo.core.random_streams import stream
from symolo.dataset.codes import State


@dataclass
class Drive:
    """What the wire holds of a drive, and what a controller makes of it; one row a tick."""

    counts: list = field(default_factory=list)
    """(2,) right and left, since the tick before."""
    line: list = field(default_factory=list)
    """(8,) 255 is white."""
    ranges_mm: list = field(default_factory=list)
    """(3,) front, left and right."""
    state: list = field(default_factory=list)
    motion: list = field(default_factory=list)
    """(2,) v [m/s] and w [rad/s]."""
    odometry: list = field(default_factory=list)
    """(3,)"""
    line_lost: list = field(default_factory=list)
    nearest: list = field(default_factory=list)
    """Index of the nearest point of the path that is driven, -1 without one."""
    goal: list = field(default_factory=list)
    """(2,) distance [m] of a path's goal, and the direction [rad] in which the robot sees it; 1 and 0 without one."""


class Reference:
    """The controller in Python, told what the wire can hold; keeps the drive."""

    def __init__(self, robot):
        self._controller = BuiltIn(ControllerSettings(), robot, 20, stream(1))
        self._odometry = Odometry.from_config(robot)
        self._pose = (0.0, 0.0, 0.0)
        self.drive = Drive()

    @property
    def state(self):
        return self._controller.state

    def step(self, counts, line, ranges_mm) -> Twist:
        self._pose = self._odometry.step(self._pose, np.array(counts, dtype=np.int64))
        ranges_m = (int(range_mm) * 0.001 for range_mm in ranges_mm)
        seen = Observation(tuple(int(value) / 255 for value in line), *ranges_m, self._pose)
        command = self._controller.step(seen)
        self._keep(counts, line, ranges_mm, command)
        return command

    def _keep(self, counts, line, ranges_mm, command):
        drive, follower, goal = self.drive, self._controller._follower, (1.0, 0.0)
        if isinstance(follower, CurveFollower):
            follower = follower._follower
        if follower is not None:
            x, y = copy.copy(follower)._goal(self._pose, obstacle_beside=False)  # a copy, because looking moves it on
            bearing = math.atan2(y, x) - self._pose[2] + follower._start[2]
            goal = math.hypot(x, y), math.remainder(bearing, 2.0 * math.pi)
        drive.counts.append(tuple(counts))
        drive.line.append(tuple(line))
        drive.ranges_mm.append(tuple(ranges_mm))
        drive.state.append(int(command.state))
        drive.motion.append((command.v_m_s, command.w_rad_s))
        drive.odometry.append(self._pose)
        drive.line_lost.append(self._controller.line_lost_count)
        drive.nearest.append(follower._nearest if follower else -1)
        drive.goal.append(goal)


class Library:
    """The controller in C."""

    def __init__(self, path):
        self.c = ctypes.CDLL(str(path))

    def drive(self, given: Drive) -> Drive:
        """What the controller in C makes of the readings of a drive."""
        inputs = [
            np.array(given.counts, dtype=np.int16),
            np.array(given.line, dtype=np.uint8),
            np.array(given.ranges_mm, dtype=np.uint16),
        ]
        ticks = len(inputs[0])
        state, line_lost, nearest = (np.zeros(ticks, np.int32) for _ in range(3))
        motion, pose = np.zeros((ticks, 2), np.float32), np.zeros((ticks, 3), np.float32)
        arrays = (*inputs, state, motion, pose, line_lost, nearest)
        self.c.native_reset()
        self.c.native_run(ctypes.c_int32(ticks), *(array.ctypes.data_as(ctypes.c_void_p) for array in arrays))
        return Drive(*inputs, state, motion, pose, line_lost, nearest)

    def begin(self):
        self.c.native_begin()

    def exchange(self, data: bytes, after_ms: int = 0) -> bytes:
        """What it answers to bytes that come in so much later."""
        answer = ctypes.create_string_buffer(1 << 16)
        length = self.c.native_exchange(ctypes.c_uint16(after_ms), data, ctypes.c_int32(len(data)), answer)
        return answer.raw[:length]

    def set_points(self) -> tuple[float, float]:
        wheels = (ctypes.c_float * 2)()
        self.c.native_set_points(wheels)
        return wheels[0], wheels[1]


@pytest.fixture(scope="session")
def robot_of():
    """A shipped robot with settings of the command line."""

    def load(name, *settings):
        return validated(load_section("robot", name, settings).root, RobotAlone, {}).robot

    return load


@pytest.fixture(scope="session")
def robot(robot_of):
    """With curve paths, and with the one limit that is compared with a sum off every sum of readings.

    There Python decides by the rounding of doubles.
    """
    return robot_of("classroom", "robot.controller.avoidance.curves.face.edge_m=0.0305")


@pytest.fixture(scope="session")
def reference():
    return Reference


@pytest.fixture(scope="session")
def library(pytestconfig):
    """Builds the firmware for a robot as a library, once for all processes; its name tells what it is made of."""
    folder, loaded = pytestconfig.cache.mkdir("firmware"), {}

    def build(robot, framing="framed", student=None):
        path = build_native(robot, folder, framing, student)
        return loaded.setdefault(path, Library(path))

    return build


@pytest.fixture(scope="session")
def wheel_counts():
    """Counts of ideal wheels over a tick of 50 ms at a command, (2,), not rounded."""

    def counts(robot, command):
        half_m_s = 0.5 * robot.drive.track_m * command.w_rad_s
        per_m = robot.encoder.counts_per_revolution / (math.pi * robot.drive.wheel_diameter_m)
        return 0.05 * per_m * np.array([command.v_m_s + half_m_s, command.v_m_s - half_m_s])

    return counts


SITUATIONS_MM = (
    (2000, 2000, 2000),
    (2000, 2000, 300),
    (2000, 300, 2000),
    (2000, 300, 300),
    (120, 170, 300),
    (120, 300, 170),
    (190, 420, 170),
    (190, 170, 420),
    (65535, 65535, 65535),
    (360, 2000, 360),
    (260, 2000, 2000),
    (2000, 150, 2000),
    (2000, 2000, 150),
)
"""Front, left and right: nothing, walls, corners, obstacles ahead, sensors gone, obstacles on a bend."""
OF_LINES, OF_WALLS = SITUATIONS_MM[-5:], SITUATIONS_MM[:9]


@pytest.fixture(scope="session")
def random_drive(wheel_counts):
    """Situations at random; the wheels do what is commanded, or are pushed about off the paths."""

    def drive(robot, ticks, rng):
        reference, command = Reference(robot), None
        left, among, has_line = 0, OF_WALLS if rng.random() < 0.5 else OF_LINES, rng.random() < 0.7
        for tick in range(ticks):
            if left == 0:
                left, pushed, noise = int(rng.integers(1, 30)), rng.random() < 0.25, 8.0 * (rng.random() < 0.3)
                floor, black = int(rng.integers(180, 256)), rng.integers(-4, 8) if has_line and tick > 100 else -1
                base, spread = rng.choice(among[: 3 if tick < 40 else None]), rng.choice([0, 0, 3, 20])
            left -= 1
            if command is None or (pushed and reference.state not in {State.AVOID_LEFT, State.AVOID_RIGHT}):
                counts = rng.integers(-300, 300, 2).tolist()
            else:
                counts = np.rint(wheel_counts(robot, command) + noise * rng.standard_normal(2)).astype(int).tolist()
            line = np.full(8, floor)
            line[max(black, 0) : max(black, 0) + 2] = 30 if black >= 0 else floor
            ranges = np.clip(base + np.rint(spread * rng.standard_normal(3)), 0, 65535).astype(int)
            command = reference.step(counts, line.tolist(), ranges.tolist())
        return reference.drive

    return drive
