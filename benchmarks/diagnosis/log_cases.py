"""Bare SyMoLo logs with something hidden: a simulated drive in one of our arenas, with a data.csv and a nominal.yaml.

PyBullet drives the robot and its sensor models read. What a tracking camera does to the poses, and what the robot
computes as its speeds from its encoder counts, are added here.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from pipeline.stages.simulate import simulate
from symolo.core.arrays import Array
from symolo.core.time_series import Recording
from symolo.dataset.tables.rows import COLUMNS, HEADER, Rows, csv_bytes, wrapped

SCENARIOS = ("symolo", "classroom", "wall_gaps")
"""Scenarios with different arenas, whose names are also those of the arenas."""
NOISE = {"d_m": 0.0014, "line": 0.004, "pose_xy_m": 0.001, "pose_theta_rad": 0.003, "v_m_s": 0.0015, "w_rad_s": 0.015}
HELD_OUT_SHARE = 0.3
OF_POSE = ("marker_offset", "pose_time_offset")
"""Effects of the camera that tracks the robot."""


@dataclass(frozen=True)
class Hidden:
    """What a log hides; no name means nothing."""

    name: str = ""
    parameters: Mapping[str, float | str] = ()  # type: ignore[assignment] - an empty mapping

    @property
    def variant(self) -> str:
        words = [value for value in dict(self.parameters).values() if isinstance(value, str)]
        return f"{self.name}[{words[0]}]" if words else self.name


@dataclass(frozen=True)
class LogPlan:
    """One log to make; the same plan is the same log."""

    name: str
    scenario: str
    seed: int
    hidden: Hidden
    seconds: float = 40.0
    twist: str = "odometry"


def write_log(plan: LogPlan, folder: Path) -> None:
    """Drive and write data.csv and nominal.yaml into a folder."""
    spec = _spec(plan)
    recording = simulate(spec).recording
    rng = np.random.default_rng([plan.seed, 7])
    rows = Rows.from_recording(recording)
    table = rows.table()
    table[:, 1:4] = _tracked(rows, plan.hidden, rng)
    if plan.twist == "odometry":
        table[:, 5:7] = _by_counts(recording, spec) + rng.normal(0.0, (0.001, 0.01), (len(table), 2))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "data.csv").write_bytes(csv_bytes(HEADER, [column.decimals for column in COLUMNS], table))
    from_ms = int(rows.t_ms[round((1.0 - HELD_OUT_SHARE) * len(table))])
    arena = spec.arena.model_dump(mode="json", exclude_none=True) if plan.scenario == "random" else spec.arena.name
    nominal = {
        "kind": "symolo_csv",
        "arena": arena,
        "robot": "nominal",
        "noise": NOISE,
        "holdout_from_ms": from_ms,
        "twist": plan.twist,
    }
    (folder / "nominal.yaml").write_text(yaml.safe_dump(nominal, sort_keys=False))


def _spec(plan: LogPlan) -> RunSpec:
    overrides = [f"seed={plan.seed}", "stop.lap=false", f"stop.time_limit_s={plan.seconds}", "robot=nominal"]
    if plan.hidden.name and plan.hidden.name not in OF_POSE:
        overrides += [f"robot.effects.{plan.hidden.name}.{k}={v}" for k, v in dict(plan.hidden.parameters).items()]
    loaded = load_scenario(plan.scenario, overrides)
    return draw_run(loaded, loaded.routes[plan.seed % len(loaded.routes)].name, 1)


def _tracked(rows: Rows, hidden: Hidden, rng: np.random.Generator) -> Array:
    """Return the poses as a camera logs them, (N, 3)."""
    t_s = 1e-3 * rows.t_ms
    pose = np.column_stack([rows.pose[:, :2], np.unwrap(rows.pose[:, 2])])
    values = dict(hidden.parameters)
    if hidden.name == "pose_time_offset":
        seen_s = t_s - float(values["delay_s"])
        pose = np.column_stack([np.interp(seen_s, t_s, column) for column in pose.T])
    if hidden.name == "marker_offset":
        ahead = float(values["offset_m"])
        pose[:, 0] += ahead * np.cos(pose[:, 2])
        pose[:, 1] += ahead * np.sin(pose[:, 2])
    pose += rng.normal(0.0, (NOISE["pose_xy_m"], NOISE["pose_xy_m"], NOISE["pose_theta_rad"]), pose.shape)
    pose[:, 2] = wrapped(pose[:, 2])
    return pose


def _by_counts(recording: Recording, spec: RunSpec) -> Array:
    """Return forward speed [m/s] and yaw rate [rad/s] by the counts since the row before, (N, 2)."""
    counts = np.asarray(recording["encoder_counts"].values, dtype=float)
    t_s = recording.trajectory.t_s
    drive = spec.robot.drive
    per_count = math.pi * drive.wheel_diameter_m / spec.robot.encoder.counts_per_revolution
    rim = per_count * np.diff(counts, axis=0, prepend=counts[:1]) / np.diff(t_s, prepend=t_s[0] - 0.05)[:, None]
    right, left = rim.T
    return np.column_stack([0.5 * (right + left), (right - left) / drive.track_m])
