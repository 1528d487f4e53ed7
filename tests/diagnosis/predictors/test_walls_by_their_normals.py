"""The normal of a wall that a range sees: in the simulator, in a known arena and in an empty room, with equal results.

A law adds an offset to the readings of surfaces that face in one direction. The three sensors look forward, to the left
and to the right from the middle of the axle, so that a wall faces in the direction opposite to the one of the axis.
"""

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES
from sensors.ranging.tof import TofArray
from symolo.arena.geometry import Arena, Box, Line, Straight
from symolo.core.tables.time_series import TimeSeries

ROOM_M, OFFSET_M = 1.6, 0.02
AXES_RAD = {"front": 0.0, "left": 0.5 * math.pi, "right": -0.5 * math.pi}
POSES = np.array([(0.8, 0.7, quarter * 0.5 * math.pi + off) for quarter in range(4) for off in (-0.2, 0.1)])
QUARTERS = np.repeat(np.arange(4), 2)
FACING_RAD = {"+x": 0.0, "+y": 0.5 * math.pi, "-x": math.pi, "-y": -0.5 * math.pi}
HITS = np.array([["-x", "-y", "+x", "+y"][(quarter + turn) % 4] for quarter in QUARTERS for turn in (0, 1, 3)])
"""By pose, the directions in which the walls face that the three sensors look at: headings near +x see the one that
faces -x."""


class FacingOffset(Effect):
    slot = Slot.RANGE
    cause, excitation, setups = "a wall with another paint", "all walls", (Setup.DRIVE,)
    offset_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-1.0, high=1.0)]
    facing_rad: float

    def apply(self, reading_m, view):
        return reading_m + self.offset_m * view.facing(self.facing_rad)


@dataclass
class RoomWorld:
    """Four walls of a square room with a corner at the origin."""

    at: tuple[float, float, float]
    time_s: float = 0.0

    def pose(self):
        return self.at

    def cast(self, origins, ends):
        way = (ends - origins)[:, :2]
        with np.errstate(divide="ignore"):
            until = (np.where(way > 0.0, ROOM_M, 0.0) - origins[:, :2]) / way
        which, rows = until.argmin(axis=1), np.arange(len(way))
        normal = np.zeros((len(way), 3))
        normal[rows, which] = -np.sign(way[rows, which])
        return SimpleNamespace(fraction=until.min(axis=1), surface=np.ones(len(way), dtype=int), normal=normal)


@pytest.fixture(scope="module")
def robot():
    """Each sensor is a single ray from the middle of the axle, without noise and rounding."""
    nominal = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    of = nominal.tof.mounts
    mounts = {
        side: getattr(of, side).model_copy(update={"x_m": 0.0, "y_m": 0.0, "yaw_deg": math.degrees(yaw)})
        for side, yaw in AXES_RAD.items()
    }
    ray = {"rays": 1, "field_of_view_deg": 1e-3, "error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0}
    return nominal.with_section("tof", {**ray, "mounts": of.model_copy(update=mounts)})


def simulated(robot):
    wall = Box("wall", "wall", (0.0, 0.0, 0.075), (0.02, 1.0, 0.15), 0.0, "white_board")
    arena = Arena("test", 4.0, 1.0, Line((Straight((-5.0, 0.0), (5.0, 0.0)),), 0.015, reflectance=0.0), (wall,))
    tof = TofArray.on_robot(robot, arena, 1000, np.random.default_rng(0))
    worlds: list[Any] = [RoomWorld(tuple(pose)) for pose in POSES.tolist()]
    return np.array([tof.sample(world)[:, 0] for world in worlds])


def predicted(robot, effects, nominal=None, arena=None):
    """Readings of a log in which every pose is a trial of its own, for which the robot stands still."""
    t_s, trials = 0.05 * np.arange(2), []
    for k, pose in enumerate(POSES):
        columns = dict(zip(("x_m", "y_m", "theta_rad"), pose, strict=True)) | {f"tof_{s}_m": 0.5 for s in AXES_RAD}
        series = (TimeSeries(name, "", t_s, np.full(2, value)) for name, value in columns.items())
        channels = tuple(Channel.logged(of, Role.READING) for of in series)
        trials.append(Trial(str(k), t_s, np.zeros(2, dtype=bool), channels, arena=arena))
    measurement = Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), tuple(trials), nominal)
    (stage,) = (stage for stage in STAGES[CaseKind.DRIVE_LOG](measurement, robot) if stage.name == "tof")
    assert all(observed.usable.all() for observed in stage.observed)
    readings = stage.predict([robot.with_effect(effect) for effect in effects])
    return np.stack([of_sensor.mean[:, ::2] for of_sensor in readings], axis=-1)


def in_arena(robot, effects):
    middle, out, long = 0.5 * ROOM_M, 0.05, ROOM_M + 0.2
    across, along = (2.0 * out, long, 0.3), (long, 2.0 * out, 0.3)
    places = (
        (-out, middle, across),
        (ROOM_M + out, middle, across),
        (middle, -out, along),
        (middle, ROOM_M + out, along),
    )
    boxes = [
        {"name": f"B{k}", "center": (x, y), "size": size, "surface": "white_board"}
        for k, (x, y, size) in enumerate(places)
    ]
    arena = ArenaConfig.model_validate({"name": "test", "line": {"pieces": []}, "walls": [], "obstacles": boxes})
    return predicted(robot, effects, arena=arena)


def in_room(robot, effects):
    mount = {side: {"x_m": 0.0, "y_m": 0.0, "yaw_rad": yaw} for side, yaw in AXES_RAD.items()}
    nominal = NominalDrive.model_validate(
        {
            "kind": "drive_log",
            "robot": {
                "wheel_radius_m": {"value": 0.03, "tolerance": 0.001},
                "wheel_separation_m": {"value": 0.16, "tolerance": 0.001},
                "encoder_ticks_per_revolution": 2000,
            },
            "tof": {"range_offset_m": {"value": 0.0, "tolerance": 0.001}, "max_range_m": 1.5, "mount": mount},
            "world": {"room_x_m": ROOM_M, "room_y_m": ROOM_M},
            "noise": {
                "wheel_speed_rad_s": 0.045,
                "pose_xy_m": 0.001,
                "pose_theta_rad": 0.003,
                "travel_m_per_sqrt_m": 0.0006,
                "tof_polynomial_mm": [1.4, 4.88, 2.51, 1.15],
                "tof_polynomial_origin_m": 0.18,
            },
        }
    )
    return predicted(nominal_robot(nominal, robot), effects, nominal)


CODES = {
    "simulator": lambda robot, effects: np.array([simulated(robot.with_effect(effect)) for effect in effects]),
    "arena": in_arena,
    "room": in_room,
}


@pytest.mark.parametrize("code", CODES)
def test_a_law_of_one_wall_acts_on_the_ranges_to_this_wall(robot, code):
    bare = FacingOffset(offset_m=0.0, facing_rad=0.0)
    laws = [FacingOffset(offset_m=OFFSET_M, facing_rad=rad) for rad in FACING_RAD.values()]
    readings = CODES[code](robot, [bare, *laws])
    hits = HITS.reshape(len(POSES), len(AXES_RAD))
    for name, reading in zip(FACING_RAD, readings[1:], strict=True):
        np.testing.assert_allclose(reading - readings[0], np.where(hits == name, OFFSET_M, 0.0), atol=1e-9)
