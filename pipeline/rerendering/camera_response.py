"""What a run loses if another look renders it: the response of its camera, which belongs to the look."""

import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from configs.overrides import CAMERA, names_camera
from configs.references import resolve_camera, shipped_names
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.scenario import SceneSpec
from symolo.core.yaml.tree import Node

MAX_OPTION = 120
"""Largest number of characters of an option that is typed rather than read from a file."""
_YAML_WORDS = frozenset({"null", "true", "false", "yes", "no", "on", "off", "y", "n"})
"""Words that some readers of YAML take for something else than text."""
_GREY = "monochrome"
_MANUAL = "manual_exposure"


def response_warnings(
    before: Sequence[SceneSpec], after: Sequence[SceneSpec], overrides: Sequence[str] = ()
) -> tuple[str, ...]:
    """Return a sentence for each special camera of the source that a look replaces by another one.

    Special are cameras with a name of their own, monochrome ones, and those with a manual exposure.

    Args:
        before: Runs of the source.
        after: Runs under the looks, in the order of `before` for each draw.
        overrides: Settings of the user; where one of them replaces the camera, there is nothing to say.
    """
    if any(map(names_camera, overrides)):
        return ()
    replaced: dict[str, list[tuple[CameraLook, CameraLook]]] = {}
    for k, spec in enumerate(after):
        source = before[k % len(before)]
        old, new = source.look.camera, spec.look.camera
        words = ", ".join(_words(old))
        if source.is_imported or not words or _kind(old) == _kind(new):
            continue
        text = f"the camera of the run ({words}) gives way to that of the look {spec.look.name}"
        replaced.setdefault(text, []).append((old, new))
    return tuple(text + _remedy(pairs) for text, pairs in replaced.items())


def _kind(camera: CameraLook) -> tuple[object, ...]:
    return camera.name, camera.colour_filter == _GREY, camera.manual_exposure


def _words(camera: CameraLook) -> Iterator[str]:
    if camera.name is not None:
        yield camera.name
    if camera.colour_filter == _GREY:
        yield camera.colour_filter
    if camera.manual_exposure is not None:
        yield "manual exposure"


def _remedy(pairs: Sequence[tuple[CameraLook, CameraLook]]) -> str:
    """Return the end of a sentence, with the settings that bring a camera back.

    Args:
        pairs: The camera of each run and that of the look; all cameras of the runs have the same name.
    """
    first = _fields(pairs[0][0])
    differing = [name for name in first if any(_fields(old)[name] != first[name] for old, _ in pairs)]
    settings: dict[str, str] = {}
    if pairs[0][0].name in shipped_names("camera"):
        settings["extends"] = _yaml(pairs[0][0].name)
    for old, new in pairs:
        base = _shipped(old.name) if old.name in shipped_names("camera") else new
        settings |= _settings(old, base, differing)
    if not settings:
        return ""
    option = f"--set {shlex.quote(_override(settings))}"
    if len(option) > MAX_OPTION:
        ending = " with its values" if differing else ""
        copied = "copy the value of look.camera in side/spec.json of a run into camera.yaml"
        return f"; {copied}; --set {CAMERA}=camera.yaml keeps it{ending}"
    lost = f", except for what is not the same in all runs: {', '.join(differing)}" if differing else ""
    return f"; {option} keeps it{lost}"


def _override(settings: Mapping[str, str]) -> str:
    """Return one override of the camera with all of these settings, whose values are YAML."""
    if len(settings) > 1:
        return f"{CAMERA}={{{', '.join(f'{name}: {value}' for name, value in settings.items())}}}"
    ((name, value),) = settings.items()
    return f"{CAMERA}={value}" if name == "extends" else f"{CAMERA}.{name}={value}"


def _settings(old: CameraLook, base: CameraLook, left_out: Sequence[str]) -> dict[str, str]:
    """Return settings that change one camera into an old one, except for the fields that are left out."""
    fields, there = _fields(old), _fields(base)
    settings: dict[str, str] = {}
    for name in fields:
        if name in left_out or fields[name] == there[name]:
            continue
        settings[name] = _yaml(fields[name])
        if name == _MANUAL and (manual := old.manual_exposure) is not None:
            unset = {field: info.default for field, info in type(manual).model_fields.items()}
            before = there[name] or unset
            changed = (f"{field}: {_yaml(value)}" for field, value in fields[name].items() if value != before[field])
            settings[name] = f"{{{', '.join(changed)}}}"
    return settings


def _yaml(value: str | float | None) -> str:
    """Return a value as YAML, a word without quotation marks."""
    if isinstance(value, str) and value.isidentifier() and value.lower() not in _YAML_WORDS:
        return value
    return json.dumps(int(value) if isinstance(value, float) and value.is_integer() else value)


def _fields(camera: CameraLook) -> dict[str, Any]:
    """Return the values of all fields, also of those that files leave out."""
    manual = camera.manual_exposure
    in_fields = None if manual is None else {name: getattr(manual, name) for name in type(manual).model_fields}
    return {name: getattr(camera, name) for name in CameraLook.model_fields} | {_MANUAL: in_fields}


def _shipped(name: str | None) -> CameraLook:
    return CameraLook.model_validate(resolve_camera(Node(name, ""), Path.cwd()).plain())
