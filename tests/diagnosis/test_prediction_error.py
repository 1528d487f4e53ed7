"""Standard deviations of predictions: against repeated draws, and against the definition outside the seen range."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.prediction_error import SIZE, Beyond, predictions, relative_distance
from diagnosis.predictors.pose.dead_reckoning import path_sd
from diagnosis.predictors.pose.pose_noise import PoseNoise
from diagnosis.report.files import ANSWER, PAGE, SUMMARY, files
from diagnosis.unseen import unseen_inputs

pytestmark = pytest.mark.usefixtures("cases_on_the_path")
NOISE_A, NOISE_RAD_S = 0.001, 0.04
SEEN_V = 2.5


@pytest.fixture(scope="module")
def slow_bench(cases_on_the_path, tmp_path_factory):  # noqa: ARG001 - for its effect
    """A bench whose ammeter shows a tenth too much, up to 2.5 V, and an unseen run up to 5 V."""
    cases = importlib.import_module("gap_cases")
    case = cases.make_case("motor_steady", 4, [("current_sensor_gain", {"gain": 1.1})])
    slow = np.abs(case.columns["u_cmd_V"]) <= SEEN_V
    volts = np.array([0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0])
    blind = {"row": np.arange(1, 8), "t_s": 30.0 * np.arange(1, 8), "u_cmd_V": volts}
    case = replace(
        case,
        bench=replace(case.bench, inputs={k: v[slow] for k, v in case.bench.inputs.items()}),
        columns={k: v[slow] for k, v in case.columns.items()},
        blind={"blind_inputs.csv": blind},
    )
    folder = tmp_path_factory.mktemp("slow") / "case"
    cases.write(case, folder)
    measurement = read_measurement(folder, IMPORTERS)
    return diagnose(measurement), read_blind(folder, measurement.kind), volts


def test_inside_the_range_it_is_noise_and_the_scatter_of_fitted_robots(slow_bench):
    """Robots drawn with the covariance of the fit scatter as the prediction says, beside the noise."""
    diagnosis, unseen, volts = slow_bench
    (prediction,) = predictions(diagnosis, unseen)
    assert [named.name for named in diagnosis.named] == ["current_sensor_gain"]
    fit = diagnosis.fit
    draws = np.random.default_rng(1).multivariate_normal(fit.x, fit.covariance, 400)
    robots = fit.hypothesis.robots(fit.hypothesis.clipped(draws))
    (runs,) = unseen_inputs(diagnosis.measurement, robots[0], unseen)
    means = dict(zip(runs.names, runs.means(robots), strict=True))
    moving = (volts > 0.5) & (volts <= SEEN_V)
    for name, noise in (("current_A", NOISE_A), ("omega_rad_s", NOISE_RAD_S)):
        scatter = np.std(means[name], axis=0)
        level = np.median(fit.sd[np.array([o.name for o in fit.evidence.observed])[fit.evidence.quantity] == name])
        assert level == pytest.approx(noise, rel=0.3)
        expected = np.hypot(level, scatter)
        np.testing.assert_allclose(prediction.columns[f"sd_{name}"][moving], expected[moving], rtol=0.1)


def test_outside_the_range_it_grows_by_what_the_effect_adds(slow_bench):
    """For a gain of the ammeter that is (1 - 1 / gain) of the reading, times ln(1 + d), where d is the largest of the
    distances by voltage, by speed, by current and by the size of the effect itself."""
    diagnosis, unseen, volts = slow_bench
    (found,), (plain,) = (predictions(each, unseen) for each in (diagnosis, replace(diagnosis, named=())))
    (named,) = diagnosis.named
    more = np.sqrt(found.columns["sd_current_A"] ** 2 - plain.columns["sd_current_A"] ** 2)
    assert not more[volts <= SEEN_V].any()
    change = found.columns["current_A"] * (1.0 - 1.0 / named.values["gain"])
    by_voltage = np.log(np.maximum(volts / SEEN_V, 1.0))
    assert np.all(more[volts > SEEN_V] >= 0.999 * (change * by_voltage)[volts > SEEN_V])
    assert np.all(more[volts > SEEN_V] <= 1.6 * (change * by_voltage)[volts > SEEN_V])
    np.testing.assert_array_equal(found.columns["sd_omega_rad_s"], plain.columns["sd_omega_rad_s"])


def test_a_warning_names_effect_condition_range_and_value(slow_bench):
    diagnosis, unseen, _ = slow_bench
    (prediction,) = predictions(diagnosis, unseen)
    (left,) = [each for each in prediction.beyond if each.condition == "u_cmd_V"]
    assert (left.effect, left.high, left.furthest) == ("current_sensor_gain", SEEN_V, 5.0)
    assert left.share == pytest.approx(3 / 7)
    assert "current_sensor_gain is used as far as u_cmd_V = 5, and was seen from -2.5 to 2.5; 43 % of" in left.text


def test_the_files_have_standard_deviations_and_warnings(slow_bench):
    diagnosis, unseen, _ = slow_bench
    contents = files(diagnosis, unseen=unseen)
    header, *rows = contents["case.csv"].decode().splitlines()
    assert header == "current_A,omega_rad_s,sd_current_A,sd_omega_rad_s"
    assert len(rows) == 7
    warning = "case.csv: current_sensor_gain is used as far as u_cmd_V = 5, and was seen from -2.5 to 2.5"
    for text in (contents[PAGE].decode(), " ".join(contents[SUMMARY].decode().split())):
        assert text.count(warning) == 1
        assert text.count("Effects are used outside the range in which they were seen") == 1
    assert b'"condition": "current_A"' in contents[ANSWER]
    assert b'"condition": "u_cmd_V"' in contents[ANSWER]
    assert contents["plots/case.png"].startswith(b"\x89PNG")


def test_inside_the_range_nothing_is_warned_of(slow_bench, tmp_path):
    (tmp_path / "blind_inputs.csv").write_text("row,t_s,u_cmd_V\n1,30,1\n2,60,-2.4\n3,90,2\n")
    diagnosis, _, _ = slow_bench
    (prediction,) = predictions(diagnosis, read_blind(tmp_path, diagnosis.measurement.kind))
    assert prediction.beyond == ()


@pytest.mark.parametrize(
    ("value", "low", "high", "distance"),
    [(1.0, 0.5, 2.0, 0.0), (3.5, 0.5, 2.0, 1.0), (0.2, 0.5, 2.0, 0.2), (-3.0, -2.0, 1.0, 0.5), (2.0, 1.0, 1.0, 1.0)],
)
def test_a_distance_is_relative_to_the_range_or_to_its_larger_side(value, low, high, distance):
    assert relative_distance(np.array([value]), low, high)[0] == pytest.approx(distance)


def test_the_error_of_a_path_is_the_scatter_of_slipping_wheels():
    """Paths of 400 robots whose wheels slip at random, on an arc and a straight, from a first pose with noise."""
    noise, track, rows = PoseNoise(2e-3, 5e-3, 4e-3), 0.2, 120
    rng = np.random.default_rng(3)
    left, right = np.where(np.arange(rows) < 60, 0.01, 0.02), np.full(rows, 0.02)
    ends = []
    for exact in (True, *[False] * 400):
        slip = 0.0 if exact else noise.slip_m_per_sqrt_m * rng.standard_normal((2, rows))
        by_left, by_right = np.stack([left, right]) + slip * np.sqrt(np.stack([left, right]))
        turn = (by_right - by_left) / track
        yaw = np.cumsum(turn) + (0.0 if exact else noise.theta_rad * rng.standard_normal())
        forward, middle = 0.5 * (by_left + by_right), yaw - 0.5 * turn
        path = np.stack([np.cumsum(forward * np.cos(middle)), np.cumsum(forward * np.sin(middle)), yaw], axis=-1)
        if not exact:
            place = noise.xy_m * rng.standard_normal(2)
            camera = np.append(noise.xy_m * np.ones(2), noise.theta_rad) * rng.standard_normal(3)
            path = path + np.append(place, 0.0) + camera
        ends.append(path)
    sd = path_sd(ends[0], 0.5 * (left + right), [rows], noise, track)
    for row in (30, 60, 119):
        np.testing.assert_allclose(sd[:, row], np.std([path[row] for path in ends[1:]], axis=0), rtol=0.15)


def test_a_warning_of_a_larger_effect_says_which_quantity_it_changes():
    left = Beyond("tof_range_scale", f"{SIZE} in tof_front_m", 0.0, 0.0322, 0.041, 0.06)
    assert left.text == (
        "tof_range_scale changes tof_front_m by up to 0.041, and was seen with changes of up to 0.0322; 6 % of the "
        "samples are outside"
    )
