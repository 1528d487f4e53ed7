"""Texts about sensors for a terminal."""

from collections.abc import Iterator

from sensors.base import Sensor
from sensors.registry import SENSORS


def sensor_lines() -> Iterator[str]:
    """Yield one line for each kind that `robot.sensors` may contain: name, columns and meaning."""
    kinds = [kind for kind in SENSORS.classes() if kind.is_listed()]
    wide = max(len(kind.name) for kind in kinds)
    for kind in kinds:
        mark = " (your own)" if kind.name in SENSORS.files else ""
        meaning = " ".join((kind.__doc__ or "").partition("\n\n")[0].split())
        yield f"{kind.name:<{wide}}  {meaning} {_columns(kind)}{mark}"


def _columns(kind: type[Sensor]) -> str:
    columns = ", ".join(f"{column.title} [{column.unit}]" for column in kind.columns)
    return f"Columns: {columns}." if columns else "Its columns depend on its settings." if not kind.is_rendered else ""
