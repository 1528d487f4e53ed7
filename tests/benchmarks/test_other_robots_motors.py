"""The compiled motors of the second generator against exponentials of the nominal motor."""

import numpy as np
import pytest

from benchmarks.diagnosis.other_robots.compiled import advance_wheels
from benchmarks.diagnosis.other_robots.drives import case as drives
from benchmarks.diagnosis.other_robots.drives.wheels import ORDER
from benchmarks.diagnosis.other_robots.motor import draw_motor
from benchmarks.diagnosis.other_robots.steps.bench import StepBench
from benchmarks.diagnosis.other_robots.steps.commands import draw_commands

pytestmark = pytest.mark.compiler


def speeds_from_rest(motor, u, dt_s):
    """Between changes of its direction a motor with dry friction approaches its final speed exponentially."""
    r, k, b, tc, j = motor
    rate = (k * k / r + b) / j
    w, speeds = 0.0, []
    for volts in u:
        left_s = dt_s
        while left_s > 1e-12:
            direction = np.sign(w) or (np.sign(volts) if abs(k * volts / r) > tc else 0.0)
            if direction == 0:
                break
            final = (k * volts / r - direction * tc) / (j * rate)
            after = final + (w - final) * np.exp(-rate * left_s)
            if after * direction >= 0:
                w, left_s = after, 0.0
            else:  # it stops within the row
                left_s -= max(np.log((w - final) / -final) / rate, 1e-9)
                w = 0.0
        speeds.append(w)
    return np.array(speeds)


def mean_speeds(motor, u):
    """Mean speeds of the rows of a drive, from milliseconds."""
    w = speeds_from_rest(motor, np.repeat(u, 50), 0.001)
    return (0.5 * (w + np.concatenate([[0], w[:-1]]))).reshape(-1, 50).mean(axis=1)


@pytest.mark.parametrize("number", range(5))
def test_trials_and_wheels_of_the_nominal_motor_follow_exponentials(number):
    rng = np.random.default_rng([1, number])
    m = draw_motor(rng, inertia=True)
    motor = (m.R, m.K, m.B, m.Tc, m.J)
    u, _ = draw_commands(rng, 400, m.supply)
    bench = StepBench(m, u[None], np.zeros(1), session=2.0, shares=(0.6, 0.5), top=m.supply)
    read = bench.readings({}, [], np.zeros((1, 5)), substeps=20)[0]
    w = speeds_from_rest(motor, u, 0.005)
    np.testing.assert_allclose(read[400:], w, atol=2e-3 * m.supply / m.K)
    np.testing.assert_allclose(read[:400], (u - m.K * w) / m.R, atol=2e-3 * m.supply / m.R)

    volts = np.repeat(rng.uniform(-1, 1, (2, 8)) * m.supply, 10, axis=1)
    parameters = np.array([[dict(zip(ORDER, motor, strict=False), vs=m.supply).get(name, 0.0) for name in ORDER]])
    angles, zero = np.zeros((1, 2, 80)), np.zeros((2, 80))
    inputs = (volts, np.zeros(80), zero, zero)
    advance_wheels(parameters, inputs, np.zeros((1, 4)), angles, (0, 80, 0))
    for c in range(2):
        speeds = np.diff(angles[0, c], prepend=0) / 0.05
        np.testing.assert_allclose(speeds, mean_speeds(motor, volts[c]), atol=2e-3 * m.supply / m.K)


def robust_sd(values):
    return np.nanmedian(np.abs(values)) / 0.6745


def test_a_drive_with_nothing_hidden_has_the_wheel_speeds_and_turns_of_its_equations_and_the_stated_noise():
    wheels, turns = [], []
    made = (drives.make(np.random.default_rng([1, k]), "none") for k in range(8))
    cases = [case for case in made if case and case.truth["setting"]["voltages_logged"]][:3]
    assert len(cases) == 3
    for case in cases:
        table = np.array(case.rows)
        cell = {
            name: np.array([float(x) if x else np.nan for x in table[:, k]])
            for k, name in enumerate(case.header)
            if k != 1
        }
        nominal, z, noise = case.nominal, case.truth["setting"]["deviations"], case.nominal["noise"]
        factors, robot = case.truth["disturbances"]["noise_factor"], case.nominal["robot"]
        entries = [entry for entry in nominal["motor"].values() if isinstance(entry, dict)]
        entries += [robot["wheel_radius_m"], robot["wheel_separation_m"]]
        *motor, radius, track = (e["value"] + x * e["tolerance"] for e, x in zip(entries, z, strict=False))
        for trial in np.unique(cell["trial"]):
            rows = cell["trial"] == trial
            moved = []
            for side in ("left", "right"):
                moved.append(
                    2 * np.pi * np.diff(cell[f"enc_{side}_ticks"][rows]) / robot["encoder_ticks_per_revolution"]
                )
                expected = mean_speeds(motor, cell[f"u_{side}_V"][rows][:-1])
                wheels.append((moved[-1] / 0.05 - expected) / noise["wheel_speed_rad_s"] / factors["wheel"])
            total = [np.concatenate([[0], np.cumsum(m)]) * radius for m in moved]
            first = np.arange(0, rows.sum() - 10, 10)
            rolled = sum(np.abs(t[first + 10] - t[first]) for t in total) / 2
            turned = (total[1] - total[0]) / track
            error = np.diff(cell["theta_rad"][rows][[*first, first[-1] + 10]]) - np.diff(
                turned[[*first, first[-1] + 10]]
            )
            slip = 2 * (noise["travel_m_per_sqrt_m"] * factors["travel"] / track) ** 2 * rolled
            turns.append(error / np.sqrt(2 * (noise["pose_theta_rad"] * factors["pose"]) ** 2 + slip))
    assert robust_sd(np.concatenate(wheels)) == pytest.approx(1, abs=0.15)
    assert robust_sd(np.concatenate(turns)) == pytest.approx(1, abs=0.15)
