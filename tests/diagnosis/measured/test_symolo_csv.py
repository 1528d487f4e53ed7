"""The importer of a bare data.csv: what it reads, and that it names every fault of a case."""

import numpy as np
import pytest
import yaml

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind
from symolo.core.errors import InputError

HEADER = "t,x,y,theta,state,v,w,d_f,d_l,d_r,L0,L1,L2,L3,L4,L5,L6,L7,img"
NOISE = {"d_m": 0.002, "line": 0.01, "pose_xy_m": 0.001, "pose_theta_rad": 0.003, "v_m_s": 0.002, "w_rad_s": 0.02}


def row(k, **changed):
    cells = dict(
        zip(HEADER.split(","), [50 * k, 0.005 * k, 0.0, 0.0, 0, 0.1, 0.0, 0.5, 2.0, 0.3, *[0.9] * 8, 0], strict=True)
    )
    return ",".join(str(value) for value in {**cells, **changed}.values())


@pytest.fixture
def case(tmp_path):
    def write(rows=None, runs=(), **nominal):
        text = "\n".join([HEADER, *(rows or [row(k) for k in range(20)])]) + "\n"
        for folder in [tmp_path / "runs" / name for name in runs] or [tmp_path]:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "data.csv").write_text(text)
        keys = {"kind": "symolo_csv", "arena": "symolo", "robot": "nominal", "noise": NOISE, **nominal}
        (tmp_path / "nominal.yaml").write_text(yaml.safe_dump({k: v for k, v in keys.items() if v is not None}))
        return tmp_path

    return write


def read(folder):
    return read_measurement(folder, IMPORTERS)


def refusal(folder):
    with pytest.raises(InputError) as refused:
        read(folder)
    return str(refused.value)


def test_columns_become_channels_in_si_units_with_the_stated_noise(case):
    measurement = read(case())
    (trial,) = measurement.trials
    assert measurement.kind == CaseKind.SYMOLO_CSV
    np.testing.assert_allclose(trial.t_s, 0.05 * np.arange(20))
    np.testing.assert_allclose(trial["x_m"].values, 0.005 * np.arange(20))
    assert trial["tof_front_m"].good.all()
    assert (trial["tof_left_m"].quality == SampleQuality.NO_TARGET).all()  # 2.0 m is the robot's code for it
    assert trial["line_3"].noise_sd[0] == NOISE["line"]
    assert not measurement.heldout_rows


def test_a_heading_goes_on_beyond_half_a_turn(case):
    rows = [row(0, theta=3.1), row(1, theta=-3.1), row(2, theta="")]
    theta = read(case(rows)).trials[0]["theta_rad"].values
    np.testing.assert_allclose(theta, [3.1, 2 * np.pi - 3.1, np.nan])


def test_rows_from_a_time_on_are_held_out(case):
    (trial,) = read(case(holdout_from_ms=500)).trials
    np.testing.assert_array_equal(trial.holdout, np.arange(20) >= 10)


def test_times_count_from_the_first_row_and_the_start_of_the_log_is_kept(case):
    """A clock drift is counted from the start of a drive; a clock may show any time then."""
    rows = [row(k, t=1_000_000 + 50 * k) for k in range(20)]
    (trial,) = read(case(rows, holdout_from_ms=1_000_500)).trials
    np.testing.assert_allclose(trial.t_s, 0.05 * np.arange(20))
    np.testing.assert_allclose(trial["x_m"].series.t_s, trial.t_s)
    assert trial.begins_s == 1000.0
    np.testing.assert_array_equal(trial.holdout, np.arange(20) >= 10)
    refused = refusal(case(rows, holdout_from_ms=500))
    assert "1000000 to 1000950 ms" in refused


def test_of_several_runs_those_with_a_name_are_held_out(case):
    trials = read(case(runs=("a", "b", "c"), holdout=["b"])).trials
    assert {trial.name: trial.holdout.all() for trial in trials} == {"a": False, "b": True, "c": False}


def test_arena_and_robot_may_be_mappings_as_in_a_scenario(case):
    folder = case(
        arena={"name": "mine", "line": {"pieces": []}, "walls": [{"name": "A", "start": [1, 1], "end": [1, -1]}]},
        robot={"extends": "nominal", "drive": {"track_m": 0.15}},
    )
    nominal = read(folder).nominal
    assert nominal.arena.walls[0].name == "A"
    assert nominal.robot.drive.track_m == 0.15
    assert nominal.robot.drive.wheel_diameter_m == 0.065


@pytest.mark.parametrize(
    ("effects", "twist", "name"),
    [
        ({"range_wander": {"sd_m": 0.01, "time_constant_s": 60.0}}, "truth", "range_wander"),
        ({"encoder_ticks_scale": {"scale": 1.05}}, "odometry", "encoder_ticks_scale"),
        (
            {"wheel_eccentricity": {"side": "left", "amplitude": 0.1, "phase_rad": 0.0}},
            "odometry",
            "wheel_eccentricity",
        ),
        ({"floor_slope": {"gradient": 0.1, "direction_rad": 0.0}}, "truth", "floor_slope"),
        ({"floor_slope": {"gradient": 0.1, "direction_rad": 0.0}}, "odometry", None),
        ({"encoder_ticks_scale": {"scale": 1.05}}, "truth", None),
        ({"range_gathering_time": {"duration_s": 0.1}}, "truth", None),
    ],
)
def test_an_effect_of_the_robot_that_no_stage_predicts_is_refused(case, effects, twist, name):
    folder = case(robot={"extends": "nominal", "effects": effects}, twist=twist)
    if name is None:
        assert list(read(folder).nominal.robot.effects)
    else:
        text = refusal(folder)
        assert f"robot.effects.{name}" in text
        assert "no prediction of a bare log" in text


def test_every_fault_of_a_case_is_named_at_once(case):
    folder = case([row(0), row(1, v="fast"), row(2, x="nan")], noise={**NOISE, "line": -1.0, "d": 2.0}, twist="wheels")
    text = refusal(folder)
    for part in ("unknown key", "noise.line", "twist", "row 3", "column v", "row 4", "column x"):
        assert part in text


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"arena": "symola"}, "did you mean symolo"),
        ({"robot": "fleet"}, "is drawn for each run"),
        ({"arena": "random"}, "is drawn for each run"),
        ({"holdout_from_ms": 5000}, "holdout_from_ms"),
        ({"holdout_from_ms": 500, "holdout": ["1"]}, "both holdout and holdout_from_ms"),
        ({"holdout": ["2"]}, "no trial to hold out has such a name"),
        ({"noise": None}, "noise"),
    ],
)
def test_a_fault_of_the_nominal_file_is_named(case, changed, message):
    assert message in refusal(case(**changed))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([row(0), row(0)], "column t: 0 repeats 0"),
        ([row(k, x=1000 * k + 100) for k in range(5)], "this looks like mm"),
        ([row(k, d_f=500) for k in range(5)], "this looks like mm"),
    ],
)
def test_a_fault_of_the_data_is_named(case, rows, message):
    assert message in refusal(case(rows))


def test_a_heading_in_degrees_is_noted(case):
    rows = [row(k, theta=3.0 * k, w=np.radians(3.0) / 0.05) for k in range(60)]
    assert any("CHECK THE UNIT of theta" in note for note in read(case(rows)).notes)


def test_a_case_without_data_is_refused(case):
    folder = case()
    (folder / "data.csv").unlink()
    assert "there is no data.csv" in refusal(folder)
