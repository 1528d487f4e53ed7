"""Bare SyMoLo logs with something hidden: a simulated drive in one of our arenas, with a data.csv and a nominal.yaml.

PyBullet drives the robot and its sensor models read. What a tracking camera does to the poses, and what the robot
computes as its speeds from its encoder counts, are added here.
"""

import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml

# Scripts are run by their path.
sys.path.insert(0, str(Path(__file__).parents[3]))

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from pipeline.stages.simulate import simulate
from sensors.line.line_channels import CHANNELS
from symolo.core.arrays import Array
from symolo.core.tables.time_series import Recording
from symolo.dataset.tables.rows import COLUMNS, HEADER, Rows, csv_bytes, wrapped

SCENARIOS = ("symolo", "classroom", "wall_gaps")
"""Scenarios with different arenas, whose names are also those of the arenas."""
SPEED_NOISE = (0.001, 0.01)
"""Noise [m/s, rad/s] of v and w besides that of the counts: wheels slip a little and are not quite round."""
NOISE = {
    # Tables 3 and 4 of the paper have 0.8 to 1.5 mm, depending on the surface.
    "d_m": 0.0014,
    # line_sensor.noise_sd of the nominal robot.
    "line": 0.004,
    # A camera above the arena that tracks a marker (added here).
    "pose_xy_m": 0.001,
    "pose_theta_rad": 0.003,
    # SPEED_NOISE and the steps of the counters: 0.053 mm in 50 ms for each wheel, and samples up to 10 ms old.
    "v_m_s": 0.0015,
    "w_rad_s": 0.015,
}
"""Noise that nominal.yaml states."""
Sampler = Callable[[np.random.Generator], dict[str, float | str]]


def _of(
    name: str,
    low: float,
    high: float,
    *,
    null: float = 0.0,
    signs: bool = True,
    choice: tuple[str, list[str]] | None = None,
) -> Sampler:
    """Return a function that draws a size between `low` and `high` away from `null`, on one side or on both.

    Args:
        name: Parameter of the effect.
        low: Smallest distance from `null`.
        high: Largest distance.
        null: Value without the effect.
        signs: Whether the value may be below `null` too.
        choice: Name of another parameter, and the words of which one is drawn for it.
    """

    def draw(rng: np.random.Generator) -> dict[str, float | str]:
        size = float(rng.uniform(low, high)) * (float(rng.choice([-1.0, 1.0])) if signs else 1.0)
        which: dict[str, float | str] = {choice[0]: str(rng.choice(choice[1]))} if choice else {}
        return {**which, name: round(null + size, 4)}

    return draw


_SENSOR = ("sensor", ["front", "left", "right"])
_CHANNEL = ("channel", CHANNELS.tolist())
SIZES: Mapping[str, Sampler] = {
    "tof_mount_yaw": _of("angle_rad", 0.05, 0.2, choice=_SENSOR),
    "line_gain": _of("scale", 0.25, 0.5, null=1.0, choice=_CHANNEL),
    "tof_range_offset": _of("offset_m", 0.008, 0.025, choice=_SENSOR),
    "line_offset": _of("offset", 0.15, 0.3, choice=_CHANNEL),
    "tof_range_scale": _of("scale", 0.03, 0.08, null=1.0),
    "line_height": _of("height_scale", 0.15, 0.5, null=1.0),
    "tof_time_offset": _of("delay_s", 0.04, 0.15, signs=False),
    "line_ambient": _of("offset", 0.2, 0.35),
    "marker_offset": _of("offset_m", 0.01, 0.04),
    "line_adc_saturation": lambda rng: {"low": round(float(rng.uniform(0.15, 0.3)), 4), "high": 0.95},
    "marker_yaw": _of("angle_rad", 0.02, 0.1),
    "line_lateral_offset": _of("offset_m", 0.002, 0.008),
    "pose_time_offset": _of("delay_s", 0.04, 0.15, signs=False),
    "line_crosstalk": _of("share", 0.04, 0.15, signs=False),
    "wheel_radius_scale": _of("scale", 0.03, 0.06, null=1.0),
    "wheelbase_scale": _of("scale", 0.05, 0.1, null=1.0),
    "wheel_radius_asymmetry": _of("asymmetry", 0.02, 0.05),
    "turn_slip": _of("coefficient_s2_m", 0.5, 2.0, signs=False),
}
"""Effects that such a log can show."""
UNSEEN: Mapping[str, Sampler] = {
    "winding_resistance_scale": _of("scale", 0.2, 0.4, null=1.0, signs=False),
    "supply_sag": _of("source_resistance_ohm", 0.3, 0.8, signs=False),
}
"""Effects behind voltages and currents, which are not in such a log."""
HELD_OUT_SHARE = 0.3
OF_POSE = ("marker_offset", "marker_yaw", "pose_time_offset")
"""Effects of the camera that tracks the robot."""


@dataclass(frozen=True)
class Hidden:
    """What a log hides; no name means nothing."""

    name: str = ""
    parameters: Mapping[str, float | str] = field(default_factory=dict)

    @property
    def variant(self) -> str:
        words = [value for value in self.parameters.values() if isinstance(value, str)]
        return f"{self.name}[{words[0]}]" if words else self.name


@dataclass(frozen=True)
class LogPlan:
    """One log to make; the same plan is the same log."""

    name: str
    scenario: str
    seed: int
    hidden: Hidden
    seconds: float = 40.0


def write_log(plan: LogPlan, folder: Path) -> None:
    """Drive and write data.csv and nominal.yaml into a folder."""
    spec = _spec(plan)
    recording = simulate(spec).recording
    rng = np.random.default_rng([plan.seed, 7])
    rows = Rows.from_recording(recording)
    table = rows.table()
    table[:, 1:4] = _tracked(rows, plan.hidden, rng)
    table[:, 5:7] = _by_counts(recording, spec) + rng.normal(0.0, SPEED_NOISE, (len(table), 2))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "data.csv").write_bytes(csv_bytes(HEADER, [column.decimals for column in COLUMNS], table))
    nominal = {
        "kind": "symolo_csv",
        "arena": spec.arena.name,
        "robot": "nominal",
        "noise": NOISE,
        "holdout_from_ms": int(rows.t_ms[round((1.0 - HELD_OUT_SHARE) * len(table))]),
        "twist": "odometry",
    }
    (folder / "nominal.yaml").write_text(yaml.safe_dump(nominal, sort_keys=False))


def _spec(plan: LogPlan) -> RunSpec:
    overrides = [f"seed={plan.seed}", "stop.lap=false", f"stop.time_limit_s={plan.seconds}", "robot=nominal"]
    if plan.hidden.name and plan.hidden.name not in OF_POSE:
        overrides += [f"robot.effects.{plan.hidden.name}.{k}={v}" for k, v in plan.hidden.parameters.items()]
    loaded = load_scenario(plan.scenario, overrides)
    return draw_run(loaded, loaded.routes[plan.seed % len(loaded.routes)].name, 1)


def _tracked(rows: Rows, hidden: Hidden, rng: np.random.Generator) -> Array:
    """Return the poses as a camera logs them, (N, 3)."""
    t_s = 1e-3 * rows.t_ms
    pose = np.column_stack([rows.pose[:, :2], np.unwrap(rows.pose[:, 2])])
    values = hidden.parameters
    if hidden.name == "pose_time_offset":
        seen_s = t_s - float(values["delay_s"])
        pose = np.column_stack([np.interp(seen_s, t_s, column) for column in pose.T])
    if hidden.name == "marker_offset":
        ahead = float(values["offset_m"])
        pose[:, 0] += ahead * np.cos(pose[:, 2])
        pose[:, 1] += ahead * np.sin(pose[:, 2])
    if hidden.name == "marker_yaw":
        pose[:, 2] += float(values["angle_rad"])
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
