"""Logs of drives by the twin, of robots that are known, and a diagnosis among few effects."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.diagnose import diagnose
from diagnosis.engine.base import by_twin
from diagnosis.inference.selection import candidates
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from symolo.core.tables.time_series import TimeSeries

ROWS = 60
ROW_S = 0.05


@pytest.fixture(scope="module")
def cases_on_the_path():
    """The package `gap_cases` of the folder of tests can be imported, as long as the tests of a module run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parents[1]))
        yield


@pytest.fixture(scope="session")
def diagnosed_among():
    """Diagnoses a measurement with a few effects as the only candidates, which takes a small part of the time.

    A test names those effects that could stand for what it hides. Without any, nothing is named: that is for tests of
    everything else that a diagnosis finds.
    """

    def diagnosed(measurement, *names):
        assert {*names} <= {each.name for each in EFFECTS.classes()}
        few = SimpleNamespace(classes=lambda: tuple(e for e in EFFECTS.classes() if e.name in names))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(candidates, "EFFECTS", few)
            return diagnose(measurement)

    return diagnosed


@pytest.fixture(scope="session")
def driven_log():
    """Makes a measurement of a drive of 3 s for each robot, the last third held out."""

    def make(*robots, straight=False):
        row = np.arange(ROWS)
        bend = 0.0 if straight else 1.0
        voltage = np.stack([3.0 + bend * np.sin(0.1 * row), 3.0 - bend * np.sin(0.07 * row)], axis=1)
        trials = tuple(trial(str(k), robot, voltage) for k, robot in enumerate(robots, start=1))
        return Measurement("made", CaseKind.DRIVE_LOG, MeasurementSource("made", ()), trials)

    def trial(name, robot, voltage):
        trajectory = by_twin(robot, voltage, ROW_S)
        t_s = ROW_S * np.arange(ROWS + 1)
        columns = dict(zip(("x_m", "y_m", "theta_rad"), trajectory.pose.T, strict=True))
        columns |= dict(zip(("enc_right_ticks", "enc_left_ticks"), trajectory.counts.T, strict=True))
        columns |= {f"u_{side}_V": np.append(voltage[:, k], np.nan) for k, side in enumerate(("right", "left"))}
        series = (TimeSeries(column, "", t_s, values.astype(float)) for column, values in columns.items())
        channels = tuple(Channel.logged(of, Role.READING) for of in series)
        return Trial(name, t_s, np.arange(len(t_s)) >= 2 * len(t_s) // 3, channels)

    return make
