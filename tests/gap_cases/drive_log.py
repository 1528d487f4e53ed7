"""Drives of a robot in a room, and their three stages, each driven by what was measured before it."""

from collections.abc import Mapping, Sequence

import numpy as np

from .case import Array, Bench, Columns, Effect, Frame, World
from .disturbances import AS_STATED, Day
from .drive_ranges import SENSORS, clear_of_corners, ranges
from .drive_tour import drive
from .drive_wheels import ROW_S, SIDES, Wheels, ground, kept, mean_speeds, radii, slope, turned
from .motor_steady import motor
from .noise import OUTLIER_SIGMAS, share, white, with_dropouts
from .sizes import NEEDS_VOLTAGES
from .tof_bench import NO_TARGET_M

BETWEEN_TRIALS_S = 5.0
WINDOW = 10
NEAR_LIMIT_M = 0.03
POLYNOMIAL_MM = [1.4, 4.88, 2.51, 1.15]
ORIGIN_M = 0.18
POSE = ("x_m", "y_m", "theta_rad")


def draw(rng: np.random.Generator, rows: str) -> Bench:
    trials, length = {"few": (2, 601), "some": (3, 801), "usual": (4, 1201)}[rows]
    number = np.repeat(np.arange(1, trials + 1), length)
    time = np.tile(np.round(ROW_S * np.arange(length), 2), trials)
    apart = ROW_S * (length - 1) + BETWEEN_TRIALS_S
    holdout = number == int(rng.integers(1, trials + 1))
    inputs = {
        "trial": number,
        "split": np.where(holdout, "holdout", "fit"),
        "session_time_s": np.round(time + (number - 1) * apart, 2),
        "t_s": time,
        "logs_voltage": np.full(len(time), 1.0 if rng.random() < 0.75 else np.nan),
    }
    blind = {"session_time_s": np.round(trials * apart + ROW_S * np.arange(401), 2), "t_s": ROW_S * np.arange(401)}
    names = ["blind_pose_inputs.csv", "blind_tof_inputs.csv"]
    names += ["blind_wheels_inputs.csv"] if np.isfinite(inputs["logs_voltage"][0]) else []
    return Bench(_nominal(rng), inputs, dict.fromkeys(names, blind))


def _nominal(rng: np.random.Generator) -> dict:
    def spread(low: float, high: float, share_of_it: float) -> dict:
        value = float(f"{rng.uniform(low, high):.4g}")
        return {"value": value, "tolerance": float(f"{share_of_it * value:.6g}")}

    drawn = motor(rng)
    supply = drawn.pop("supply_voltage_V")
    side = {"x_m": 0.045, "y_m": 0.05, "yaw_rad": 0.78539816}
    mounts = {
        "front": {"x_m": 0.06, "y_m": 0.0, "yaw_rad": 0.0},
        "left": side,
        "right": {**side, "y_m": -0.05, "yaw_rad": -0.78539816},
    }
    return {
        "kind": "drive_log",
        "motor": {**drawn, "rotor_inertia_kg_m2": spread(0.0025, 0.0036, 0.02), "supply_voltage_V": supply},
        "robot": {
            "wheel_radius_m": spread(0.03, 0.036, 0.0015),
            "wheel_separation_m": spread(0.14, 0.17, 0.004),
            "encoder_ticks_per_revolution": 1920,
        },
        "tof": {"range_offset_m": {"value": 0, "tolerance": 0.0005}, "max_range_m": 1.2, "mount": mounts},
        "world": {"room_x_m": 1.99, "room_y_m": float(np.round(rng.uniform(1.6, 1.8), 2))},
        "noise": {
            "wheel_speed_rad_s": 0.045,
            "pose_xy_m": 0.001,
            "pose_theta_rad": 0.003,
            "travel_m_per_sqrt_m": 0.0006,
            "tof_polynomial_mm": POLYNOMIAL_MM,
            "tof_polynomial_origin_m": ORIGIN_M,
        },
    }


def observe(
    bench: Bench, world: World, rng: np.random.Generator, day: Day = AS_STATED
) -> tuple[Columns, Mapping[str, Columns]]:
    """Columns of data.csv, and the inputs of unseen runs; the noise of the bench is the true one."""
    trials, begin, rows = _shape(bench.inputs)
    blind = next(iter(bench.blind.values()))
    begin = np.append(begin, blind["session_time_s"][0])
    log = _logged(bench, world, begin, rows, rng, day)
    columns = {**bench.inputs, **{name: values[:trials].ravel() for name, values in log.items()}}
    columns |= _spoilt(bench, columns, rng, day)
    unseen = {name: values[trials, : len(blind["t_s"])] for name, values in log.items()}
    volts = {f"u_{side}_V": unseen[f"u_{side}_V"] for side in SIDES}
    start = {name: np.where(np.arange(len(blind["t_s"])) == 0, unseen[name], np.nan) for name in POSE}
    ticks = {f"enc_{side}_ticks": unseen[f"enc_{side}_ticks"] for side in SIDES}
    given = {
        "blind_pose_inputs.csv": {**ticks, **start},
        "blind_tof_inputs.csv": {name: unseen[name] for name in POSE},
        "blind_wheels_inputs.csv": volts,
    }
    return columns, {name: {**blind, **given[name]} for name in bench.blind}


def _shape(inputs: Columns) -> tuple[int, Array, int]:
    """Trials, session times of their starts, rows of one."""
    trials = len(np.unique(inputs["trial"]))
    session = inputs["session_time_s"].reshape(trials, -1)
    return trials, session[:, 0], session.shape[1]


def _logged(
    bench: Bench, world: World, begin: Array, rows: int, rng: np.random.Generator, day: Day
) -> dict[str, Array]:
    """Columns (N, rows) as a perfect logger would have them, with noise but nothing lost."""
    nominal, noise = bench.nominal, bench.nominal["noise"]
    driven = drive(nominal, world, begin, rows, rng)
    time = ROW_S * np.arange(rows)

    def at(times: Array) -> Array:
        nearest = [[np.interp(times, driven.time_s, axis) for axis in trial.T] for trial in driven.pose]
        return np.moveaxis(np.array(nearest), 1, 2)

    logged = at(time - _age_s(world, time))
    ahead = world.value("marker_offset", "offset_m", 0.0)
    logged[..., 0] += ahead * np.cos(logged[..., 2])
    logged[..., 1] += ahead * np.sin(logged[..., 2])
    logged[..., 2] += world.value("marker_yaw", "angle_rad", 0.0)
    sd = np.array([noise["pose_xy_m"], noise["pose_xy_m"], noise["pose_theta_rad"]])
    logged = logged + sd * white(rng, logged.shape, day.degrees)
    seen_from = at(time - world.value("tof_time_offset", "delay_s", 0.0))
    voltage = driven.voltage if np.isfinite(bench.inputs["logs_voltage"][0]) else np.full_like(driven.voltage, np.nan)
    found = {"v_cmd_m_s": driven.command[..., 0], "w_cmd_rad_s": driven.command[..., 1]}
    found |= {f"u_{side}_V": voltage[..., k] for k, side in enumerate(SIDES)}
    found |= {f"enc_{side}_ticks": driven.ticks[..., k] for k, side in enumerate(SIDES)}
    for sensor in SENSORS:
        true = ranges(nominal, world, seen_from, sensor) + _jumped(world, sensor, begin[:, None] + time)
        spread = reading_sd(true, noise["tof_polynomial_mm"])
        good = white(rng, true.shape, day.degrees)
        if f"tof_{sensor}_m" in day.wander:
            session = begin[:, None] + time
            trial = np.repeat(np.arange(len(begin)), rows)
            good = good + np.reshape(day.zero(f"tof_{sensor}_m", trial, session.ravel()), good.shape)
        reading = np.round(true + spread * good, 3)
        found[f"tof_{sensor}_m"] = np.where(reading > nominal["tof"]["max_range_m"], np.nan, np.maximum(reading, 0.0))
    return found | {name: logged[..., k] for k, name in enumerate(POSE)}


def _age_s(world: World, time_s: Array) -> Array:
    """Age of the logged poses at (rows,) times of a trial."""
    drift = world.value("pose_clock_drift", "rate", 0.0)
    return world.value("pose_time_offset", "delay_s", 0.0) + drift * time_s


def _jumped(world: World, sensor: str, session_s: Array) -> Array:
    """What a sensor that was moved once reads more, at (...) times."""
    size = world.beyond("range_jump", "offset_m") if sensor == "front" else 0.0
    return size * (session_s >= world.beyond("range_jump", "begins_s"))


def reading_sd(distance: Array, polynomial_mm: Sequence[float]) -> Array:
    return 1e-3 * np.polynomial.polynomial.polyval(np.maximum(distance - ORIGIN_M, 0.0), polynomial_mm)


def _spoilt(bench: Bench, columns: Columns, rng: np.random.Generator, day: Day) -> dict[str, Array]:
    """Ranges and poses with readings that are lost or bad."""
    noise, struck = bench.nominal["noise"], day.struck(len(columns["trial"]))
    odd, lost, blinks = share(rng, 0.02), share(rng, 0.03), share(rng, 0.03)
    found = {}
    for sensor in SENSORS:
        reading = columns[f"tof_{sensor}_m"]
        hit = rng.random(len(reading))
        far = rng.uniform(*OUTLIER_SIGMAS, len(reading)) * rng.choice([-1.0, 1.0], len(reading))
        far = struck.get(f"tof_{sensor}_m", np.where(hit < 0.5 * odd, far, 0.0))
        worse = np.round(np.maximum(reading + far * reading_sd(reading, noise["tof_polynomial_mm"]), 0.0), 3)
        reading = np.where(far != 0.0, worse, reading)
        reading = np.where((hit >= 0.5 * odd) & (hit < odd), NO_TARGET_M, reading)
        found[f"tof_{sensor}_m"] = with_dropouts(rng, reading, lost)
    gone = rng.random(len(columns["x_m"])) < blinks
    gone &= columns["t_s"] > 0.0
    sd = {"x_m": noise["pose_xy_m"], "y_m": noise["pose_xy_m"], "theta_rad": noise["pose_theta_rad"]}
    poses = {name: columns[name] + sd[name] * struck[name] if name in struck else columns[name] for name in POSE}
    return found | {name: np.where(gone, np.nan, poses[name]) for name in POSE}


def frame(bench: Bench, columns: Columns) -> Frame:
    """Wheel speeds, then pose increments over windows that follow each other, then ranges."""
    nominal, noise = bench.nominal, bench.nominal["noise"]
    trials, _, rows = _shape(columns)
    book = bench.textbook()
    turns = _turns(bench, columns)
    held = (columns["split"] == "holdout").reshape(trials, rows)
    has_volts = np.isfinite(columns["u_left_V"]).reshape(trials, rows)[:, :-1, None]
    wheels = np.where(has_volts, turns / ROW_S, np.nan)
    poses = _poses(columns)
    increments = _increments(poses[:, ::WINDOW], poses[:, ::WINDOW, 2])
    travel = np.abs(turns * book.own["wheel_radius_m"])
    windows = travel[:, : WINDOW * increments.shape[1]].reshape(trials, -1, WINDOW, 2).sum(axis=2).mean(axis=-1)
    q = noise["travel_m_per_sqrt_m"] ** 2 * windows
    xy = np.sqrt(2.0 * noise["pose_xy_m"] ** 2 + (0.12 * noise["pose_theta_rad"]) ** 2 + 0.5 * q)
    width = nominal["robot"]["wheel_separation_m"]["value"]
    theta = np.sqrt(2.0 * noise["pose_theta_rad"] ** 2 + 2.0 * q / width**2)
    readings, spreads = [], []
    for sensor in SENSORS:
        value, spread = _range_readings(bench, columns, poses, sensor)
        readings.append(value)
        spreads.append(spread)
    parts = [
        (wheels, np.full(wheels.shape, noise["wheel_speed_rad_s"]), held[:, :-1, None]),
        (increments, np.stack([xy, xy, theta], axis=-1), held[:, :1, None]),
        (np.stack(readings, axis=-1), np.stack(spreads, axis=-1), held[..., None]),
    ]
    measured, sigma, holdout, stage, run, first = [], [], [], [], [], 0
    for number, (values, spread, out) in enumerate(parts):
        lines = np.moveaxis(values, 2, 1)
        measured.append(lines.ravel())
        sigma.append(np.moveaxis(spread, 2, 1).ravel())
        holdout.append(np.moveaxis(np.broadcast_to(out, values.shape), 2, 1).ravel())
        stage.append(np.full(values.size, number))
        run.append(np.repeat(first + np.arange(lines.shape[0] * lines.shape[1]), lines.shape[2]))
        first += lines.shape[0] * lines.shape[1]
    n = sum(len(each) for each in measured)
    return Frame(
        measured=np.concatenate(measured),
        sigma=np.concatenate(sigma),
        holdout=np.concatenate(holdout),
        stage=np.concatenate(stage),
        run=np.concatenate(run),
        correlation=np.full(n, np.nan),
        usable=np.ones(n, dtype=bool),
    )


def _range_readings(bench: Bench, columns: Columns, poses: Array, sensor: str) -> tuple[Array, Array]:
    """Usable readings of a sensor (N, rows), and their noise with that of the poses in it."""
    nominal, noise, book = bench.nominal, bench.nominal["noise"], bench.textbook()
    expected = ranges(nominal, book, poses, sensor)
    reading = columns[f"tof_{sensor}_m"].reshape(expected.shape)
    bad = (reading > NO_TARGET_M - 0.001) | (expected > nominal["tof"]["max_range_m"] - NEAR_LIMIT_M)
    bad |= ~clear_of_corners(nominal, book, poses, sensor)
    variance = reading_sd(expected, noise["tof_polynomial_mm"]) ** 2
    for k, sd in enumerate((noise["pose_xy_m"], noise["pose_xy_m"], noise["pose_theta_rad"])):
        nudged = poses + np.eye(3)[k] * 1e-4
        variance = variance + (sd * (ranges(nominal, book, nudged, sensor) - expected) / 1e-4) ** 2
    return np.where(bad, np.nan, reading), np.where(np.isfinite(variance), np.sqrt(variance), 1.0)


def predict(bench: Bench, columns: Columns, worlds: Sequence[World]) -> Array:
    wheels = _wheel_stage(bench, columns, worlds)
    turns, poses = _turns(bench, columns), _poses(columns)
    found = []
    for k, world in enumerate(worlds):
        parts = [
            wheels[k],
            _pose_stage(bench, world, columns, turns, poses),
            _range_stage(bench, world, columns, poses),
        ]
        found.append(np.concatenate([np.moveaxis(part, 2, 1).ravel() for part in parts]))
    return np.array(found)


def _turns(bench: Bench, columns: Columns) -> Array:
    """By the ticks and their nominal number: of each wheel in each row (N, rows - 1, 2) [rad]."""
    trials, _, rows = _shape(columns)
    ticks = np.stack([columns[f"enc_{side}_ticks"].reshape(trials, rows) for side in SIDES], axis=-1)
    return np.diff(ticks, axis=1) * 2.0 * np.pi / bench.nominal["robot"]["encoder_ticks_per_revolution"]


def _poses(columns: Columns) -> Array:
    trials, _, rows = _shape(columns)
    return np.stack([columns[name].reshape(trials, rows) for name in POSE], axis=-1)


def _wheel_stage(bench: Bench, columns: Columns, worlds: Sequence[World]) -> Array:
    """Speeds as the encoders say them, (V, N, rows - 1, 2); worlds with the same motors are simulated once."""
    trials, begin, rows = _shape(columns)
    voltage = np.stack([columns[f"u_{side}_V"].reshape(trials, rows) for side in SIDES], axis=-1)
    if np.isnan(voltage[:, :-1]).all():
        return np.full((len(worlds), trials, rows - 1, 2), np.nan)
    alike: dict[tuple, int] = {}
    which, different = [], []
    for world in worlds:
        bare = World(
            {name: value for name, value in world.own.items() if name in bench.nominal["motor"]},
            tuple(each for each in world.effects if each.name in NEEDS_VOLTAGES),
            world.outsides,
        )
        key = (tuple(bare.own.values()), tuple(map(_key, bare.effects)), bare.beyond("session_change", "fraction"))
        if key not in alike:
            alike[key] = len(different)
            different.append(bare)
        which.append(alike[key])
    wheels = Wheels.from_worlds(different, bench.nominal["motor"]["supply_voltage_V"])
    costly = 2 * (wheels.source_ohm.ravel() > 0.0) + (wheels.delay_s.ravel() > 0.0)
    speeds = np.zeros((len(different), trials, rows - 1, 2))
    for group in np.unique(costly):
        chosen = np.flatnonzero(costly == group).tolist()
        speeds[chosen] = mean_speeds(wheels.pick(chosen), voltage, begin)
    read = [speeds[k] * kept(w, speeds[k]) for k, w in zip(which, worlds, strict=True)]
    scales = [w.value("encoder_ticks_scale", "scale", 1.0) for w in worlds]
    return np.array(read) * np.array(scales)[:, None, None, None]


def _key(effect: Effect) -> tuple:
    return effect.name, *effect.parameters.values()


def _pose_stage(bench: Bench, world: World, columns: Columns, turns: Array, poses: Array) -> Array:
    """Increments over windows in the frame of their first row, (N, windows, 3), from the ticks."""
    del bench
    true = turns / world.value("encoder_ticks_scale", "scale", 1.0)
    speed = true / ROW_S
    for _ in range(4):
        speed = true / ROW_S / kept(world, speed)
    true = ROW_S * speed
    trials, _, rows = _shape(columns)
    start = np.zeros((trials, 1, 2))
    angle = np.concatenate([start, np.cumsum(true, axis=1)], axis=1)
    # Where the robot is, as far as that matters, is known well enough from the log.
    filled = _filled(poses)
    travel = radii(world) * true
    travel = ground(world, travel, 0.5 * (angle[:, 1:] + angle[:, :-1]), 0.5 * (filled[:, 1:, :2] + filled[:, :-1, :2]))
    yaw = turned(world, travel, ROW_S)
    heading = np.concatenate([np.zeros((trials, 1)), np.cumsum(yaw, axis=1)], axis=1)
    middle, ahead = 0.5 * (heading[:, 1:] + heading[:, :-1]), 0.5 * travel.sum(axis=-1)
    # Downhill is a direction in the room: turned into the frame of this dead reckoning by the logged heading.
    askew = world.value("marker_yaw", "angle_rad", 0.0)
    down, to_own = slope(world, travel), heading[:, :-1] - (filled[:, :-1, 2] - askew)
    cos, sin = np.cos(to_own), np.sin(to_own)
    moved = [
        ahead * np.cos(middle) + cos * down[..., 0] - sin * down[..., 1],
        ahead * np.sin(middle) + sin * down[..., 0] + cos * down[..., 1],
    ]
    place = np.concatenate([start, np.cumsum(np.stack(moved, axis=-1), axis=1)], axis=1)
    path = np.concatenate([place, heading[..., None]], axis=-1)
    time = ROW_S * np.arange(rows)
    late = _age_s(world, time)
    if late.any():
        path = np.array([[np.interp(time - late, time, axis) for axis in trial.T] for trial in path]).swapaxes(1, 2)
    off = world.value("marker_offset", "offset_m", 0.0)
    path = path + off * np.stack([np.cos(path[..., 2]), np.sin(path[..., 2]), np.zeros(path.shape[:2])], axis=-1)
    path[..., 2] += askew
    return _increments(path[:, ::WINDOW], path[:, ::WINDOW, 2])


def _increments(path: Array, heading: Array) -> Array:
    """Between neighbours of (N, n, 3) in the body frame of the first."""
    step: Array = np.diff(path, axis=1)
    at = heading[:, :-1]
    cos, sin = np.cos(at), np.sin(at)
    x = cos * step[..., 0] + sin * step[..., 1]
    y = -sin * step[..., 0] + cos * step[..., 1]
    return np.stack([x, y, step[..., 2]], axis=-1)


def _filled(poses: Array) -> Array:
    """Gaps in a log (N, rows, 3) bridged by straight lines."""
    rows = np.arange(poses.shape[1])
    filled = poses.copy()
    for trial in filled:
        known = np.isfinite(trial[:, 0])
        for k in range(3):
            trial[:, k] = np.interp(rows, rows[known], trial[known, k])
    return filled


def _range_stage(bench: Bench, world: World, columns: Columns, poses: Array) -> Array:
    """Of all sensors at the logged poses, (N, rows, 3)."""
    trials, _, rows = _shape(columns)
    time = ROW_S * np.arange(rows)
    later = _age_s(world, time) - world.value("tof_time_offset", "delay_s", 0.0)
    axle = poses
    if later.any():
        shifted = [[np.interp(time + later, time, axis) for axis in trial.T] for trial in _filled(poses)]
        axle = np.where(np.isnan(poses), np.nan, np.array(shifted).swapaxes(1, 2))
    off = world.value("marker_offset", "offset_m", 0.0)
    axle = axle - world.value("marker_yaw", "angle_rad", 0.0) * np.array([0.0, 0.0, 1.0])
    axle = axle - off * np.stack([np.cos(axle[..., 2]), np.sin(axle[..., 2]), np.zeros((trials, rows))], axis=-1)
    session = columns["session_time_s"].reshape(trials, rows)
    seen = [ranges(bench.nominal, world, axle, sensor) + _jumped(world, sensor, session) for sensor in SENSORS]
    return np.stack(seen, axis=-1)
