"""Texts about sensors for a terminal: all kinds in a line each, and one with all that is known about it."""

import json
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from configs.robot_sensors import SensorSettings
from configs.validation.shapes import Shape
from sensors.base import Sensor
from sensors.registry import SENSORS
from symolo.core.field_descriptions import DescribedJsonSchema
from symolo.dataset.tables.column import Column

_MAX_FIELDS = 20
"""Largest number of fields of a section that are named in one line."""


def sensor_lines() -> Iterator[str]:
    """Yield two lines for each kind that `robot.sensors` may contain: name with meaning, and columns."""
    kinds = [kind for kind in SENSORS.classes() if kind.is_listed()]
    wide = max(len(kind.name) for kind in kinds)
    for kind in kinds:
        mark = " (your own)" if kind.name in SENSORS.files else ""
        meaning = _in_one_line((kind.__doc__ or "").partition("\n\n")[0])
        yield f"{kind.name:<{wide}}  {meaning}{mark}"
        yield f"{'':<{wide}}  {_columns(kind)}"


def _columns(kind: type[Sensor]) -> str:
    """Return the columns of a kind of sensor in one line."""
    if kind.is_rendered:
        return "readings: images"
    columns = ", ".join(f"{column.title} [{column.unit}]" for column in _default_columns(kind))
    if not columns:
        return "columns: they depend on the settings"
    return f"columns: {columns}" + ("" if kind.columns else " (with the default settings)")


def _default_columns(kind: type[Sensor]) -> tuple[Column, ...]:
    """Return the columns of a kind of sensor with its default settings; none if a setting has no default."""
    if issubclass(kind.Settings, SensorSettings) and not _without_default(kind):
        return kind.columns_of(kind.Settings())
    return kind.columns


def sensor_text(kind: type[Sensor]) -> Iterator[str]:
    """Yield the lines about one kind of sensor."""
    file = SENSORS.files.get(kind.name)
    yield kind.name
    yield f"  meaning:     {_in_one_line(kind.__doc__ or '')}"
    shipped = f"{kind.__module__.replace('.', '/')}.py, shipped with symolo"
    yield f"  defined in:  {f'{file.path} (SHA-256 {file.sha256})' if file else shipped}"
    yield f"  on a robot:  {'those that list it in robot.sensors' if kind.is_listed() else 'every one'}"
    yield from _column_lines(kind)
    settings = [f"    {line}" for line in _setting_lines(Shape.from_model(kind.Settings, DescribedJsonSchema))]
    yield "  settings, whose names end in their units:" if settings else "  settings:    none"
    yield from settings
    if kind.is_listed():
        option = f"--sensor-file {shlex.quote(str(file.path))} " if file else ""
        key = "left" if kind.is_rendered else kind.name
        fields = [f"kind: {kind.name}"] if kind.is_rendered else []
        fields += [f"{name}: VALUE" for name in _without_default(kind)]
        setting = f"robot.sensors.{key}={{{', '.join(fields)}}}"
        yield f"  try it:      symolo {option}simulate smoke --set {shlex.quote(setting)} --out data"


def _column_lines(kind: type[Sensor]) -> Iterator[str]:
    """Yield the columns of a kind of sensor with its default settings."""
    if kind.is_rendered:
        yield "  readings:    images"
        return
    columns = _default_columns(kind)
    without = "they depend on the settings" if kind.is_listed() else "none in a dataset"
    yield "  columns, with the default settings:" if columns else f"  columns:     {without}"
    for column in columns:
        yield f"    {column.title} [{column.unit}]: {_in_one_line(column.meaning)}"


def _without_default(kind: type[Sensor]) -> list[str]:
    return [name for name, field in kind.Settings.model_fields.items() if field.is_required()]


def _setting_lines(shape: Shape, above: str = "", defaults: Mapping[str, Any] | None = None) -> Iterator[str]:
    """Yield what is allowed for each setting, its default and its meaning; those of sections as `section.setting`."""
    for key in shape.fields:
        inner = shape.below(key)
        if inner is None or key == "kind":
            continue
        default = (defaults or {}).get(key, inner.schema.get("default", ...))
        if isinstance(default, dict) and default and inner.fields:
            yield from _setting_lines(inner, f"{above}{key}.", default)
            continue
        words = inner.words() if len(inner.fields) <= _MAX_FIELDS else "a mapping"
        without = "no default" if key in shape.schema.get("required", ()) else "may be left out"
        yield f"{above}{key}: {words}, {without if default is ... else f'default {json.dumps(default)}'}"
        if description := inner.schema.get("description", ""):
            yield f"  {_in_one_line(description)}"


def _in_one_line(text: str) -> str:
    return " ".join(text.split())
