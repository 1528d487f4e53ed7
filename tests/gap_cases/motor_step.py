"""Steps of voltage on a motor, in trials from rest."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.signal import lfilter

from .case import Array, Bench, Columns, Frame, World
from .disturbances import AS_STATED, Day
from .motor_law import Motors
from .motor_motion import STEP_S, responses
from .motor_steady import instruments, motor
from .noise import correlated, share, with_dropouts, with_outliers

ROW_S = 0.005
TRIAL_ROWS = 500
FIRST_STEP_S = 0.1
MAX_V = 5.0
MIN_V = 0.9
RESOLUTION = {"current_A": 0.002, "omega_rad_s": 0.02}


def draw(rng: np.random.Generator, rows: str) -> Bench:
    trials, held = {"few": (3, 1), "some": (4, 1), "usual": (6, 2)}[rows]
    inputs = _runs(rng, trials, 0.0)
    holdout = rng.choice(np.arange(1, trials + 1), held, replace=False)
    inputs["split"] = np.where(np.isin(inputs["trial"], holdout), "holdout", "fit")
    spread = motor(rng)
    inertia = float(f"{rng.uniform(0.0025, 0.0036):.4g}")
    spread = {
        **{name: leaf for name, leaf in spread.items() if name != "supply_voltage_V"},
        "rotor_inertia_kg_m2": {"value": inertia, "tolerance": float(f"{0.02 * inertia:.6g}")},
        "supply_voltage_V": spread["supply_voltage_V"],
        "motor_side_inertia_fraction": 0.6,
        "motor_side_friction_fraction": 0.5,
    }
    nominal = {
        "kind": "motor_step",
        "motor": spread,
        "sample_rate_Hz": 200,
        "noise": {"current_A": 0.012, "omega_rad_s": 0.1, "lag1_correlation": 0.3},
    }
    return Bench(nominal, inputs, {"blind_inputs.csv": _runs(rng, 2, trials * TRIAL_ROWS * ROW_S)})


def _runs(rng: np.random.Generator, trials: int, begin_s: float) -> dict:
    time = np.round(ROW_S * np.arange(1, TRIAL_ROWS + 1), 4)
    number = np.repeat(np.arange(1, trials + 1), TRIAL_ROWS)
    voltage = np.concatenate([_sequence(rng, time) for _ in range(trials)])
    session = begin_s + (number - 1) * TRIAL_ROWS * ROW_S + np.tile(time, trials)
    return {
        "trial": number,
        "session_time_s": np.round(session, 4),
        "t_s": np.tile(time, trials),
        "u_cmd_V": voltage,
    }


def _sequence(rng: np.random.Generator, time_s: Array) -> Array:
    """Steps and short-circuit brakes in turn; in every third trial, reversals without a brake between them."""
    voltage, at, k = np.zeros_like(time_s), FIRST_STEP_S, 0
    reverses = rng.random() < 1 / 3
    sign = rng.choice([-1.0, 1.0])
    while at < time_s[-1]:
        size = np.round(rng.uniform(MIN_V, MAX_V), 2)
        sign = -sign if reverses else rng.choice([-1.0, 1.0])
        level = 0.0 if k % 2 and not (reverses and k % 4 == 1) else sign * size
        voltage[time_s > at + 1e-9] = level
        at = round(at + ROW_S * int(rng.integers(50, 110)), 4)
        k += 1
    return voltage


def mean(bench: Bench, inputs: Columns, worlds: Sequence[World]) -> tuple[Array, Array]:
    """Current and speed as the instruments would say them without noise, (V, rows) each."""
    nominal = bench.nominal["motor"]
    motors = Motors.from_worlds(worlds, nominal["supply_voltage_V"])
    trials = len(np.unique(inputs["trial"]))
    command = inputs["u_cmd_V"].reshape(trials, -1)
    begin = inputs["session_time_s"].reshape(trials, -1)[:, 0] - ROW_S
    shares = (nominal["motor_side_inertia_fraction"], nominal["motor_side_friction_fraction"])
    current, fine, times = responses(motors, worlds, command, ROW_S, begin, shares)
    read = np.stack([_read_speed(w, fine[k], times, command) for k, w in enumerate(worlds)])
    session = begin[:, None] + ROW_S * np.arange(1, command.shape[1] + 1)
    current, speed = instruments(worlds, current, read, session)
    return current.reshape(len(worlds), -1), speed.reshape(len(worlds), -1)


def _read_speed(world: World, fine: Array, times: Array, command: Array) -> Array:
    """Of (N, M + 1) speeds, what the encoder says at the rows, (N, T); its scale is applied elsewhere."""
    angle = np.cumsum(fine, axis=1) * STEP_S
    ripple = world.beyond("gear_error", "share")
    cycles = world.beyond("gear_error", "per_turn", 1.0)
    speed = fine * (1.0 + ripple * np.sin(cycles * angle + world.beyond("gear_error", "phase_rad")))
    speed = speed + _ringing(world, times, command)
    lag = world.value("speed_filter_lag", "time_constant_s", 0.0)
    if lag > 0.0:
        speed = _first_order(speed, lag)
    late = world.value("speed_time_offset", "delay_s", 0.0)
    at = ROW_S * np.arange(1, command.shape[1] + 1)
    return _glitched(world, np.stack([np.interp(at - late, times, each) for each in speed]))


def _first_order(values: Array, lag_s: float) -> Array:
    """Exact for values that are straight lines between steps, from rest."""
    keep = np.exp(-STEP_S / lag_s)
    slope = (1.0 - keep) * lag_s / STEP_S
    return np.asarray(lfilter([1.0 - slope, slope - keep], [1.0, -keep], values, axis=1))


def _ringing(world: World, times: Array, command: Array) -> Array:
    """A decaying oscillation after each change of the voltage, as of a soft coupling."""
    size = world.beyond("torsional_ringing", "rad_s_per_V")
    if size == 0.0:
        return np.zeros((len(command), len(times)))
    changes = np.diff(command, axis=1, prepend=0.0)
    found = np.zeros((len(command), len(times)))
    for trial, k in zip(*np.nonzero(changes), strict=True):
        since = np.maximum(times - k * ROW_S, 0.0)
        swing = np.sin(world.beyond("torsional_ringing", "rad_s") * since)
        found[trial] += size * changes[trial, k] * np.exp(-since / world.beyond("torsional_ringing", "decay_s")) * swing
    return found


def observe(
    bench: Bench, world: World, rng: np.random.Generator, day: Day = AS_STATED
) -> tuple[Columns, Mapping[str, Columns]]:
    """Columns of data.csv, and the inputs of unseen runs; the noise of the bench is the true one."""
    noise, struck = bench.nominal["noise"], day.struck(len(bench.inputs["trial"]))
    lost, odd = share(rng, 0.03), share(rng, 0.02)
    columns = dict(bench.inputs)
    for name, values in zip(RESOLUTION, mean(bench, bench.inputs, [world]), strict=True):
        per_trial = values[0].reshape(-1, TRIAL_ROWS)
        good = per_trial + noise[name] * correlated(rng, per_trial.shape, noise["lag1_correlation"], day.degrees)
        zero = day.zero(name, bench.inputs["trial"], bench.inputs["session_time_s"])
        good = good + noise[name] * np.reshape(zero, (-1, TRIAL_ROWS)) if name in day.wander else good
        if day.clamp_is_last and name == "current_A":
            good = np.clip(good, *_limits(world))
        good = RESOLUTION[name] * np.round(good / RESOLUTION[name])
        columns[name] = with_dropouts(rng, with_outliers(rng, good, noise[name], odd, struck.get(name)), lost).ravel()
    return columns, bench.blind


def _limits(world: World) -> tuple[float, float]:
    """What the ammeter reads at the limit of the current, in either direction."""
    limit = world.value("current_limit", "limit_A", np.inf) * world.value("current_sensor_gain", "gain", 1.0)
    offset = world.value("current_sensor_offset", "offset_A", 0.0)
    return offset - limit, offset + limit


def _glitched(world: World, speed: Array) -> Array:
    """Stretches of a few samples in which the encoder counts only part of its edges."""
    lost = world.beyond("encoder_glitches", "share_lost")
    if lost == 0.0:
        return speed
    rng = np.random.default_rng(int(world.beyond("encoder_glitches", "pattern")))
    hit = np.zeros(speed.shape, dtype=bool)
    length = int(world.beyond("encoder_glitches", "rows"))
    for trial in hit:
        for at in rng.integers(0, speed.shape[1] - length, int(world.beyond("encoder_glitches", "per_trial"))):
            trial[at : at + length] = True
    return np.where(hit, (1.0 - lost) * speed, speed)


def frame(bench: Bench, columns: Columns) -> Frame:
    n = len(columns["trial"])
    sigma = [np.full(n, bench.nominal["noise"][name]) for name in RESOLUTION]
    trials = columns["trial"]
    return Frame(
        measured=np.concatenate([columns[name] for name in RESOLUTION]),
        sigma=np.concatenate(sigma),
        holdout=np.tile(columns["split"] == "holdout", 2),
        stage=np.zeros(2 * n, dtype=np.int64),
        run=np.concatenate([trials, trials + trials.max()]),
        correlation=np.full(2 * n, bench.nominal["noise"]["lag1_correlation"]),
        usable=np.ones(2 * n, dtype=bool),
    )


def predict(bench: Bench, columns: Columns, worlds: Sequence[World]) -> Array:
    return np.concatenate(mean(bench, columns, worlds), axis=1)
