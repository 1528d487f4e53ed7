"""Origin, variation and limits of the data, in the terms of Croissant RAI 1.0.

The terms: https://docs.mlcommons.org/croissant/docs/croissant-rai-spec.html. Everything is read from metadata.json.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from symolo.core.errors import one_line
from symolo.core.progress import plural
from symolo.dataset.documents.metadata import Metadata

RAI_CONFORMS_TO = "http://mlcommons.org/croissant/RAI/1.0"
MAX_ENTRIES = 200
"""Entries of a list at most; metadata.json has them all."""


def responsible_ai(metadata: Metadata) -> dict[str, Any]:
    """Return the fields of a dataset, whose names begin with `rai:`."""
    fields: dict[str, Any] = {
        "rai:dataCollection": _collection(metadata),
        "rai:dataCollectionType": ["Software Collection"],
        "rai:dataCollectionMissingData": _missing(metadata),
        "rai:dataCollectionRawData": "The scenario with all settings and the seed, from which the data were computed.",
        "rai:dataPreprocessingProtocol": [
            "A range sensor reports a fixed value where it sees nothing.",
            "Images are developed by a model of the camera and stored as JPEG.",
        ],
        "rai:dataBiases": _limited(_variation(metadata)),
        "rai:dataLimitations": _limited(_limitations(metadata)),
        "rai:dataUseCases": [
            "Training and testing of localisation, odometry, line and wall following; of detection with annotations.",
            "Not shown: that results carry over to a real robot without data of that robot.",
        ],
        "rai:personalSensitiveInformation": ["None: no person was recorded."],
    }
    kinds = sorted({kind for run in metadata.runs for kind in run.annotations})
    if kinds:
        program = f"Blender {metadata.made_with.get('bpy', '')}".strip()
        fields |= {
            "rai:dataAnnotationProtocol": [
                f"Computed from the geometry of the scene, without a person: {', '.join(kinds)}."
            ],
            "rai:machineAnnotationTools": [program],
        }
    return fields


def _collection(metadata: Metadata) -> str:
    programs = ", ".join(f"{name} {version}" for name, version in sorted(metadata.made_with.items()))
    images = sum(run.images for run in metadata.runs)
    duration_s = sum(run.duration_s for run in metadata.runs)
    return (
        f"Computed, not measured: {plural(len(metadata.runs), 'run')} of together {duration_s:.1f} s with"
        f" {plural(images, 'image')}, from the scenario {metadata.name} and the seed {metadata.seed}, by {programs}."
    )


def _missing(metadata: Metadata) -> str:
    if not metadata.failed_runs:
        return "No run of the scenario is missing."
    failed = _limited(f"{run.run} ({run.problem})" for run in metadata.failed_runs)
    return f"Not included, because of a failure: {plural(len(failed), 'run')}: {'; '.join(failed)}"


def _variation(metadata: Metadata) -> Iterator[str]:
    """Yield what differs between runs, with the range that was drawn; everything else is the same in all."""
    names = sorted({name for run in metadata.runs for name in run.drawn})
    if not names:
        yield "No setting varies between runs: all have the same robot, arena, light and materials."
        return
    yield "Settings that are not listed here are the same in all runs."
    for name in names:
        values = [run.drawn[name] for run in metadata.runs if name in run.drawn]
        numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
        if len(numbers) == len(values):
            yield f"{name}: {min(numbers):.6g} to {max(numbers):.6g}"
        else:
            yield f"{name}: {', '.join(sorted({str(value) for value in values}))}"


def _limitations(metadata: Metadata) -> Iterator[str]:
    yield "Robot, sensors and light are models; the manual of symolo says how each compares with measurements."
    robot = metadata.scenario.get("robot", {})
    if not isinstance(robot, Mapping):
        return
    effects = robot.get("effects") or {}
    names = ", ".join(sorted(effects)) if isinstance(effects, Mapping) else ""
    yield f"Deviations of the robot from its data sheet: {names}." if names else "The robot is as its data sheet says."
    for seen in robot.get("effect_ranges") or ():
        if isinstance(seen, Mapping):
            effect, quantity, low, high = (seen.get(key) for key in ("effect", "quantity", "low", "high"))
            yield f"A diagnosis observed {effect} only where {quantity} is from {low} to {high}."
    for run in metadata.runs:
        yield from (f"{run.run}: {warning}" for warning in run.warnings)


def _limited(texts: Iterator[str]) -> list[str]:
    """Return texts of one line each, the last of which says how many were left out."""
    lines = [one_line(text) for text in texts]
    left_out = len(lines) - MAX_ENTRIES
    return lines if left_out <= 0 else [*lines[:MAX_ENTRIES], f"{left_out} more: see metadata.json"]
