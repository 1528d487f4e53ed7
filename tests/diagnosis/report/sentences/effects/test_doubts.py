import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.other_size import OtherSize
from diagnosis.inference.selection.rivals import RivalComparison
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.report.sentences.effects.doubts import log_doubts, size_doubts
from symolo.core.tables.time_series import TimeSeries


def test_a_size_that_no_robot_has_is_doubted():
    effect = CandidateEffect(EFFECTS.by_name()["supply_sag"])

    def named(ohm, std):
        values, errors = ({"source_resistance_ohm": number} for number in (ohm, std))
        return NamedEffect(effect, values, errors, RivalComparison(effect, 0.9, ()))

    assert size_doubts(named(1.87, 0.38)) == []  # may still be less than 1
    (text,) = size_doubts(named(20.0, 2.0))
    assert text.startswith("source_resistance_ohm 20 +- 2 is beyond 1")


def step_log(voltage_V, kind=CaseKind.MOTOR_STEP):
    """A log with a row every 20 ms, whose rows from the 41st on are held out."""
    rows = len(voltage_V)
    t_s = 0.02 * np.arange(1, rows + 1)
    voltage = Channel.logged(TimeSeries("u_cmd_V", "V", t_s, voltage_V), Role.INPUT)
    trial = Trial("1", t_s, np.arange(rows) >= 40, (voltage,))
    return Measurement("bench", kind, MeasurementSource("a test", ()), (trial,))


@pytest.mark.parametrize(("std_s", "is_doubted"), [(2.5e-6, True), (1.9e-3, True), (2.0e-3, False)])
@pytest.mark.parametrize("name", ["input_delay", "actuator_lag"])
def test_the_error_of_a_time_counts_changes_of_the_voltage_between_the_rows(name, std_s, is_doubted):
    """Nine changes in the rows of the fit leave 20 ms / sqrt(12 * 9) = 1.92 ms; those of held-out rows do not count."""
    voltage_V = np.repeat([6.0, -6.0] * 6, 4)[:49]
    effect = CandidateEffect(EFFECTS.by_name()[name])
    (parameter,) = (each.name for each in effect.coordinates)
    named = NamedEffect(effect, {parameter: 0.06}, {parameter: std_s}, RivalComparison(effect, 0.9, ()))
    texts = log_doubts(named, step_log(voltage_V))
    assert len(texts) == is_doubted
    assert all("its 9 changes leave an error of about 1.9 ms" in text for text in texts)


@pytest.mark.parametrize(
    ("kind", "delay_s", "is_doubted"),
    [
        (CaseKind.MOTOR_STEP, 0.020268, True),
        (CaseKind.MOTOR_STEP, 0.060345, False),
        (CaseKind.MOTOR_STEP, 0.0222, False),
        (CaseKind.DRIVE_LOG, 0.020268, False),
    ],
)
def test_a_delay_of_one_row_of_a_step_log_may_be_the_order_of_its_columns(kind, delay_s, is_doubted):
    effect = CandidateEffect(EFFECTS.by_name()["input_delay"])
    named = NamedEffect(effect, {"delay_s": delay_s}, {"delay_s": 6.5e-5}, RivalComparison(effect, 0.97, ()))
    texts = log_doubts(named, step_log(np.full(49, 6.0), kind))
    assert len(texts) == is_doubted
    assert all("one row of the log, 20 ms" in text and "held: after_row" in text for text in texts)


@pytest.mark.parametrize(("rise", "is_stated"), [(2.0, True), (40.0, False)])
def test_another_size_beside_a_second_effect_is_stated_if_it_has_a_weight(rise, is_stated):
    effect = CandidateEffect(EFFECTS.by_name()["pose_time_offset"])
    other = OtherSize("range_gathering_time", rise, {"delay_s": 0.013}, {"delay_s": 0.002})
    comparison = RivalComparison(effect, 0.97, ())
    named = NamedEffect(effect, {"delay_s": 0.007}, {"delay_s": 0.005}, comparison, other_size=other)
    texts = log_doubts(named, step_log(np.zeros(50), CaseKind.DRIVE_LOG))
    expected = "beside range_gathering_time, which these data only hint at, it would be delay_s 0.02; "
    assert [text.startswith(expected) for text in texts] == [True] * is_stated
