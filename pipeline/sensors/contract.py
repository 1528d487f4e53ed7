"""The contract of a sensor of `robot.sensors`: rules that every one keeps, each with what it means."""

from collections.abc import Iterator

import numpy as np

from configs.families import last_call
from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.scenario import RunSpec
from pipeline.rules import BrokenRule, Rule, RuleVerdict, verdicts
from pipeline.sensors.trial import SECOND, SHORT_S, SensorTrial
from pipeline.stages.simulate import simulate
from sensors.base import Sensor
from symolo.core.errors import InputError
from symolo.dataset.tables.column import Column, single

MIN_TEXT = 10
MAX_DECIMALS = 15
_ONLY_SELF = "take random numbers from self.rng only, read no clock, and keep memory in self, not in class or module"


def judged(trial: SensorTrial) -> Iterator[RuleVerdict]:
    """Yield the verdict of each rule, up to that of a sensor that does not run, which the others would repeat.

    The rule about another process, which takes longer than all others together, is tested where those are kept.
    """
    is_good = True
    for verdict in verdicts(trial, RULES[:-1], lambda error: _place_and_text(error, trial.kind)):
        yield verdict
        is_good = is_good and not verdict.problem
        if verdict.problem and verdict.rule.name in {"settings", "form"}:
            return
    if is_good:
        yield from verdicts(trial, RULES[-1:], lambda error: _place_and_text(error, trial.kind))


def _place_and_text(error: BaseException, kind: type[Sensor]) -> str:
    text = f"{type(error).__name__}: {error}"
    call = last_call(error, kind.sample.__code__.co_filename)
    return f"{call.name} fails in line {call.lineno}: {text}" if call else text


def _columns(trial: SensorTrial) -> tuple[Column, ...]:
    """Return the columns, which may depend on the settings."""
    settings = trial.spec(trial.setting).robot.sensors.get(trial.kind.name)
    assert isinstance(settings, SensorSettings)  # noqa: S101 - its class is loaded
    return trial.kind.columns_of(settings)


def _texts(trial: SensorTrial) -> None:
    if len(vars(trial.kind).get("__doc__") or "") <= MIN_TEXT:
        raise BrokenRule(
            'the class has no docstring: write what the table contains, such as """Heading of the robot."""'
        )
    for column in _columns(trial):
        if not column.unit.strip():
            raise BrokenRule(f"column {column.name} has no unit: write '-' for a number without one")
        if not column.meaning.strip():
            raise BrokenRule(f"column {column.name} has no meaning: write it as the fourth part of the column")


def _settings(trial: SensorTrial) -> None:
    without = [name for name, field in trial.kind.Settings.model_fields.items() if field.is_required()]
    if without:
        raise BrokenRule(f"{', '.join(without)} has no default, which robot.sensors.{trial.kind.name}={{}} needs")
    spec = trial.spec(trial.setting)
    if RunSpec.model_validate_json(spec.model_dump_json()) != spec:
        raise BrokenRule("written as JSON and read again, the settings have other values")


def _form(trial: SensorTrial) -> None:
    try:
        readings = trial.series(trial.recording)
    except InputError as error:
        raise BrokenRule(str(error)) from None
    if len(readings) < 2:
        raise BrokenRule("the drive has fewer than two samples: choose a shorter default of period_s")


def _digits(trial: SensorTrial) -> None:
    for column, values in zip(single(_columns(trial)), trial.series(trial.recording).T, strict=True):
        if not 0 <= column.decimals <= MAX_DECIMALS:
            raise BrokenRule(f"column {column.name}: {column.decimals} digits; allowed: 0 to {MAX_DECIMALS}")
        if column.decimals == 0 and (values % 1).any():
            fraction = values[np.flatnonzero(values % 1)[0]]
            raise BrokenRule(f"column {column.name} has 0 digits, for whole numbers, and a reading is {fraction:g}")
        if np.ptp(values) and not np.ptp(np.round(values, column.decimals)):
            raise BrokenRule(
                f"column {column.name} changes by {np.ptp(values):.2g}, and {column.decimals} digits show none of it"
            )


def _repeats(trial: SensorTrial) -> None:
    again = trial.series(simulate(trial.spec(trial.setting)).recording)
    if again.tobytes() != trial.series(trial.recording).tobytes():
        raise BrokenRule(f"the same drive gives other readings when it is done again: {_ONLY_SELF}")


def _others(trial: SensorTrial) -> None:
    series = {each.name: each.values for each in trial.recording.series}
    for name, values in trial.bare.items():
        if series[name].tobytes() != values.tobytes():
            raise BrokenRule(f"with the sensor, {name} has other values: change nothing that `world` returns")


def _several(trial: SensorTrial) -> None:
    second = f"robot.sensors.{SECOND}={{kind: {trial.kind.name}}}"
    both = simulate(trial.spec(trial.setting, second)).recording
    if trial.series(both).tobytes() != trial.series(trial.recording).tobytes():
        raise BrokenRule(f"beside a second one of its kind it gives other readings: {_ONLY_SELF}")


def _bounds(trial: SensorTrial) -> None:
    shared = {*SensorSettings.model_fields, *MountedSettings.model_fields}
    schema = trial.kind.Settings.model_json_schema()["properties"]
    for name, field in schema.items():
        for bound in ("minimum", "maximum"):
            if name in shared or bound not in field:
                continue
            setting = f"robot.sensors.{trial.kind.name}.{name}={field[bound]}"
            try:
                spec = trial.spec(setting, duration_s=SHORT_S)
            except InputError:
                continue  # the sensor itself refuses the bound beside its other defaults
            try:
                simulate(spec)
            except Exception as error:  # noqa: BLE001 - the user's code may raise anything
                text = str(error) if isinstance(error, InputError) else _place_and_text(error, trial.kind)
                raise BrokenRule(f"with {name}={field[bound]}, {text}") from None


def _process(trial: SensorTrial) -> None:
    if trial.in_new_process().tobytes() != trial.series(trial.recording).tobytes():
        raise BrokenRule(f"in another process, as in a release that is resumed, it gives other readings: {_ONLY_SELF}")


RULES: tuple[Rule[SensorTrial], ...] = (
    Rule("texts", "the class has a docstring, and every column a unit and a meaning", _texts),
    Rule("settings", "every setting has a default; JSON reads back equal", _settings),
    Rule("form", "sample returns one finite number for each column", _form),
    Rule("digits", "the digits of each column show its readings; columns of 0 digits are whole numbers", _digits),
    Rule("repeats", "the same drive gives the same bytes when it is done again", _repeats),
    Rule("others", "all other readings are as without the sensor", _others),
    Rule("several", "a second sensor of the kind changes nothing", _several),
    Rule("bounds", "sample works with every setting at its bounds", _bounds),
    Rule("process", "another process, as in a release that is resumed, gives the same bytes", _process),
)
"""All rules, in the order in which they are reported."""
