"""Short drives of a worn and of a nominal robot, and a world in which everything is what the filters take it for."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.robot import TofMount
from pipeline.baselines.robot_knowledge import LineRow, RobotDrawing, RobotKnowledge, Start
from pipeline.baselines.runs import LoggedRun
from pipeline.stages.simulate import simulate
from sensors.wheels.odometry import Odometry
from symolo.arena.geometry import Arena, Box, Line, Straight

WALL_X_M = 0.5
SENSOR_X_M = 0.085
PER_COUNT_M = 5e-6
"""So fine that rounding does not matter."""


@pytest.fixture(scope="session")
def driven() -> Callable[[str], LoggedRun]:
    """12 s counter-clockwise by a robot, past the first obstacle and the bend."""

    @cache
    def drive(robot: str) -> LoggedRun:
        spec = draw_run(load_scenario("symolo", [f"robot={robot}", "stop={lap: false, time_limit_s: 12}"]), "CCW", 1)
        return LoggedRun.of_recording(spec.key, spec, simulate(spec).recording)

    return drive


@pytest.fixture(scope="session")
def before_a_wall() -> Callable[..., RobotKnowledge]:
    """A robot that drives along x towards a wall across it; no line, and only the front sensor reads."""
    center, size = (WALL_X_M + 0.5, 0.0, 0.5), (1.0, 4.0, 1.0)
    wall = Box("wall", "wall", center, size, 0.0, "white_board")
    arena = Arena("test", 5.0, 0.8, Line((Straight((9.0, 9.0), (9.5, 9.0)),), 0.015, 0.05), (wall,))
    mounts = [TofMount(x_m=SENSOR_X_M, y_m=0.0, z_m=0.5, yaw_deg=yaw) for yaw in (0, 45, -45)]
    row = LineRow(0.08, 0.009525 * (np.arange(8) - 3.5), 0.00125)

    def given(ways_m: np.ndarray, front_m: np.ndarray, start: Start) -> RobotKnowledge:
        """With the wheels' ways (N, 2) between rows and readings (N,); the ways of the first row are left aside."""
        rows = len(front_m)
        nothing = np.full(rows, np.nan)
        counts = np.rint(np.cumsum(ways_m, axis=0) / PER_COUNT_M).astype(np.int64)
        return RobotKnowledge(
            t_s=0.05 * np.arange(rows),
            counts=counts,
            ranges_m=np.column_stack((front_m, nothing, nothing)),
            fresh=np.ones((rows, 3), dtype=bool),
            on_line=np.zeros((rows, 8), dtype=bool),
            start=start,
            drawing=RobotDrawing(Odometry(PER_COUNT_M, 0.14), tuple(mounts), np.radians(25.0), 1.2, 1e-9, row),
            map=arena,
            images=None,
        )

    return given
