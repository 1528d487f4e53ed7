"""Predictions of unseen runs against the oracle of the hide-and-find cases, which shares no code with ours."""

import importlib

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.nominal_robot import nominal_robot
from diagnosis.unseen import csv_text, unseen_inputs
from pipeline.diagnosing.importers import IMPORTERS

pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def predicted(tmp_path):
    """Of the textbook robot in the unseen runs of a fresh case: by file, and the case itself."""

    def make(kind, seed):
        cases = importlib.import_module("gap_cases")
        case = cases.make_case(kind, seed, rows="few")
        cases.write(case, tmp_path / case.name)
        measurement = read_measurement(tmp_path / case.name, IMPORTERS)
        robot = nominal_robot(measurement.nominal, draw_robot(load_section("robot", "nominal"), 0, "t")[0])
        unseen = unseen_inputs(measurement, robot, read_blind(tmp_path / case.name, measurement.kind))
        return {runs.file: dict(zip(runs.names, runs.means([robot])[:, 0], strict=True)) for runs in unseen}, case

    return make


@pytest.mark.parametrize(("kind", "tolerance"), [("motor_steady", 3e-4), ("motor_step", 0.05)])
def test_unseen_voltages(predicted, kind, tolerance):
    predictions, case = predicted(kind, 3)
    (columns,) = predictions.values()
    assert list(predictions) == [f"{case.name}.csv"]
    bench = importlib.import_module(f"gap_cases.{kind}")
    current, speed = bench.mean(case.bench, case.blind["blind_inputs.csv"], [case.bench.textbook()])
    assert np.abs(columns["omega_rad_s"] - speed[0]).max() < tolerance
    assert np.abs(columns["current_A"] - current[0]).max() < tolerance


def test_unseen_targets(predicted):
    predictions, case = predicted("tof_bench", 4)
    (columns,) = predictions.values()
    inputs = case.blind["blind_inputs.csv"]
    assert columns["reading_m"] == pytest.approx(np.asarray(inputs["distance_m"]), abs=1e-9)


def test_an_unseen_drive(predicted):
    """Ranges by the oracle's ray casting, poses by the mid-point rule written out; files round."""
    predictions, case = predicted("drive_log", 5)
    name, nominal = case.name, case.bench.nominal
    assert set(predictions) == {f"{name}_wheels.csv", f"{name}_pose.csv", f"{name}_tof.csv"}
    inputs = case.blind["blind_pose_inputs.csv"]
    ticks = np.stack([inputs["enc_left_ticks"], inputs["enc_right_ticks"]], axis=-1)
    robot = nominal["robot"]
    per_tick = 2.0 * np.pi * robot["wheel_radius_m"]["value"] / robot["encoder_ticks_per_revolution"]
    x, y, yaw = (float(inputs[axis][0]) for axis in ("x_m", "y_m", "theta_rad"))
    for left, right in np.diff(ticks, axis=0) * per_tick:
        turn = (right - left) / robot["wheel_separation_m"]["value"]
        x += 0.5 * (left + right) * np.cos(yaw + 0.5 * turn)
        y += 0.5 * (left + right) * np.sin(yaw + 0.5 * turn)
        yaw += turn
    pose = predictions[f"{name}_pose.csv"]
    assert [pose[axis][-1] for axis in ("x_m", "y_m", "theta_rad")] == pytest.approx([x, y, yaw], abs=5e-4)
    ranges = importlib.import_module("gap_cases.drive_ranges")
    seen = case.blind["blind_tof_inputs.csv"]
    poses = np.stack([seen[axis] for axis in ("x_m", "y_m", "theta_rad")], axis=-1)
    world = case.bench.textbook()
    for sensor in ("front", "left", "right"):
        expected = ranges.ranges(nominal, world, poses, sensor)
        near = expected < nominal["tof"]["max_range_m"]
        assert predictions[f"{name}_tof.csv"][f"tof_{sensor}_m"][near] == pytest.approx(expected[near], abs=5e-4)
    wheels = predictions[f"{name}_wheels.csv"]
    assert len(wheels["wheel_left_rad_s"]) == len(ticks)
    assert np.isnan(wheels["wheel_left_rad_s"][-1])


def test_text_has_a_line_for_each_row_and_nothing_where_nothing_is_known():
    text = csv_text({"a": np.array([0.125, np.nan]), "b": np.array([1e-9, 2.0])})
    assert text == "a,b\n0.125,1e-09\n,2\n"
