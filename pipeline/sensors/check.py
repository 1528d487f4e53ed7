"""`symolo sensor check`: the verdict of every rule about the sensor of a file, in words."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from configs.robot_sensors import SensorSettings
from pipeline.rules import RuleVerdict, rule_lines
from pipeline.sensors.contract import RULES, judged
from pipeline.sensors.trial import DRIVE_S, SensorTrial
from sensors.registry import SENSORS
from symolo.core.errors import InputError
from symolo.dataset.tables.column import single


@dataclass(frozen=True)
class CheckedSensor:
    """The verdicts about one kind of sensor."""

    trial: SensorTrial
    verdicts: tuple[RuleVerdict, ...]

    @property
    def is_good(self) -> bool:
        return not any(verdict.problem for verdict in self.verdicts)


def check(path: Path) -> CheckedSensor:
    """Load the sensor of a file and test all rules.

    Raises:
        InputError: The file cannot be loaded, or its class is no sensor of `robot.sensors` with readings.
    """
    kind = SENSORS.load(path)
    if not kind.is_listed() or kind.is_rendered:
        allowed = "Settings that derive from SensorSettings or MountedSettings, and readings that are numbers"
        raise InputError(f"sensor {kind.name}", where=str(path), allowed=allowed)
    trial = SensorTrial(kind)
    return CheckedSensor(trial, tuple(judged(trial)))


def check_text(checked: CheckedSensor) -> Iterator[str]:
    """Yield the lines about the result: each rule with what it means, and the range of each column."""
    kind = checked.trial.kind
    yield f"{kind.name}: {' '.join((kind.__doc__ or '').split())}"
    yield from rule_lines(RULES, [("", verdict) for verdict in checked.verdicts], "sample")
    if not checked.is_good:
        return
    settings = checked.trial.spec(checked.trial.setting).robot.sensors.get(kind.name)
    assert isinstance(settings, SensorSettings)  # noqa: S101 - its class is loaded
    yield f"Readings in {DRIVE_S:g} s of the scenario smoke; compare them with the units:"
    readings = checked.trial.series(checked.trial.recording).T
    for column, values in zip(single(kind.columns_of(settings)), readings, strict=True):
        low, high = (f"{value:.{column.decimals}f}" for value in (values.min(), values.max()))
        yield f"  {column.name} [{column.unit}]: {low} to {high}"
