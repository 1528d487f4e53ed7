"""Trials held out by their names, and parts of a robot taken alone."""

import numpy as np
import pytest

from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.holdout import hold_out, select_part
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from symolo.core.errors import InputError
from symolo.core.tables.time_series import TimeSeries

T_S = np.arange(3.0)


@pytest.fixture
def drives():
    trials = tuple(
        Trial(
            name,
            T_S,
            np.zeros(3, dtype=bool),
            (Channel.logged(TimeSeries("x_m", "m", T_S, T_S.copy()), Role.READING),),
            part=part,
        )
        for name, part in (("square/1", "left wheel"), ("square/2", "right wheel"), ("circular/1", "left wheel"))
    )
    return Measurement("drives", CaseKind.DRIVE_LOG, MeasurementSource("test", ("drives.csv",)), trials)


def held(measurement):
    return [trial.name for trial in measurement.trials if trial.holdout.all()]


def test_whole_trials_are_held_out_by_pattern(drives):
    assert held(hold_out(drives, ["circular/*"])) == ["circular/1"]
    assert held(hold_out(drives, ["*/1"])) == ["square/1", "circular/1"]
    assert held(hold_out(drives, ["right wheel"])) == ["square/2"]
    assert held(hold_out(hold_out(drives, ["*/1"]), ["*/2"])) == ["square/2"]


def test_a_pattern_that_matches_nothing_names_the_nearest(drives):
    with pytest.raises(InputError, match=r"got 'squares/1', allowed: square/1 to circular/1; did you mean square/1"):
        hold_out(drives, ["circular/*", "squares/1"])


def test_something_is_left_to_fit(drives):
    with pytest.raises(InputError, match="all trials would be held out; leave some"):
        hold_out(drives, ["*"])


def test_one_part_of_the_robot_alone(drives):
    measurement = select_part(drives, "left wheel")
    assert ([trial.name for trial in measurement.trials], measurement.name) == (
        ["square/1", "circular/1"],
        "drives-left-wheel",
    )
    with pytest.raises(InputError, match=r"got 'left weel', allowed: left wheel, right wheel; did you mean left wheel"):
        select_part(drives, "left weel")
