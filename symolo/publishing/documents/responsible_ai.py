"""Origin, variation and limits of the data, in the terms of Croissant RAI 1.0.

The terms: https://docs.mlcommons.org/croissant/docs/croissant-rai-spec.html. Everything is read from metadata.json.
"""

from collections.abc import Iterator
from typing import Any

from symolo.core.errors import one_line
from symolo.core.progress import plural
from symolo.dataset.documents.contents import Contents, logs_of, sources_of
from symolo.dataset.documents.metadata import Metadata
from symolo.dataset.documents.robots import SimulatedRobots

RAI_CONFORMS_TO = "http://mlcommons.org/croissant/RAI/1.0"
MAX_ENTRIES = 200
"""Entries of a list at most; metadata.json has them all."""


def responsible_ai(metadata: Metadata) -> dict[str, Any]:
    """Return the fields of a dataset, whose names begin with `rai:`."""
    contents = Contents.from_metadata(metadata)
    fields: dict[str, Any] = {
        "rai:dataCollection": _collection(metadata, contents),
        "rai:dataCollectionType": [
            *(["Secondary Data Analysis"] if contents.recorded_runs else []),
            *(["Software Collection"] if contents.simulated_runs or contents.rendered_images else []),
        ],
        "rai:dataCollectionMissingData": _missing(metadata),
        "rai:dataCollectionRawData": _raw_data(metadata, contents),
        "rai:dataPreprocessingProtocol": _limited(_processing(metadata, contents)),
        "rai:dataBiases": _limited(_variation(metadata, contents)),
        "rai:dataLimitations": _limited(_limitations(metadata, contents)),
        "rai:dataUseCases": [*_uses(metadata, contents)],
        "rai:personalSensitiveInformation": [
            "Not known: nobody has checked whether the images of the logs show persons."
            if contents.logged_images
            else "None: no person was recorded."
        ],
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


def _collection(metadata: Metadata, contents: Contents) -> str:
    programs = ", ".join(f"{name} {version}" for name, version in sorted(metadata.made_with.items()))
    duration_s = sum(run.duration_s for run in metadata.runs)
    runs = f"{plural(len(metadata.runs), 'run')} of together {duration_s:.1f} s"
    images = plural(contents.rendered_images + contents.logged_images, "image")
    if contents.is_synthetic and not contents.has_origins:
        source = f"from the scenario {metadata.name} and the seed {metadata.seed}"
        return f"Computed, not measured: {runs} with {images}, {source}, by {programs}."
    if contents.is_synthetic:
        names = ", ".join(name for name, _ in sources_of(metadata))
        return f"Computed, not measured: {runs} that were simulated for {names}, with {images}, by {programs}."
    formats = ", ".join(sorted({importer for _, _, importer in logs_of(metadata)}))
    origin = "or simulated" if contents.simulated_runs else "not simulated"
    parts = [f"Imported from logs of other programs ({formats}), {origin}: {runs}, by {programs}"]
    if contents.logged_images:
        parts.append(f"{plural(contents.logged_images, 'image')} of the logs")
    if contents.rendered_images:
        parts.append(f"{plural(contents.rendered_images, 'image')} rendered at the poses of the trajectories")
    return "; ".join(parts) + "."


def _raw_data(metadata: Metadata, contents: Contents) -> str:
    if not contents.has_origins:
        return "The scenario with all settings and the seed, from which the data were computed."
    logs = [f"the log {file} (SHA-256 {digest})" for file, digest, _ in logs_of(metadata)]
    releases = [
        f"the release {name}" + (f" (SHA-256 of its manifest {digest})" if digest else "")
        for name, digest in sources_of(metadata)
    ]
    return f"Not included: {'; '.join(_limited(iter([*logs, *releases])))}."


def _processing(metadata: Metadata, contents: Contents) -> Iterator[str]:
    if contents.recorded_runs:
        yield "Columns of the logs were converted to SI units; metadata.json names the source of each quantity."
        yield "A cell is empty where nothing was measured."
    if any(run.tof_min_range_m is not None for run in metadata.runs):
        yield "A range sensor reports a fixed value where it sees nothing."
    if contents.rendered_images:
        yield "Rendered images are developed by a model of the camera and stored as JPEG."
    for run in metadata.runs:
        if run.origin and run.origin.log:
            yield from (f"{run.run}: {change}" for change in run.origin.log.changes)


def _uses(metadata: Metadata, contents: Contents) -> Iterator[str]:
    detection = "; of detection with annotations" if any(run.annotations for run in metadata.runs) else ""
    if contents.is_synthetic:
        yield f"Training and testing of localisation, odometry, line and wall following{detection}."
        yield "Not shown: that results carry over to a real robot without data of that robot."
        return
    yield f"Training and testing of localisation and odometry{detection}."
    if contents.rendered_images:
        yield "Not shown: that results with rendered images carry over to images of a real camera."


def _missing(metadata: Metadata) -> str:
    if not metadata.failed_runs:
        return "No run is missing."
    failed = _limited(f"{run.run} ({run.problem})" for run in metadata.failed_runs)
    return f"Not included, because of a failure: {plural(len(failed), 'run')}: {'; '.join(failed)}"


def _variation(metadata: Metadata, contents: Contents) -> Iterator[str]:
    """Yield what differs between runs, with the range that was drawn; everything else is the same in all."""
    if contents.recorded_runs and not contents.rendered_images:
        yield "The logs decide what varies between runs; nothing was drawn."
        return
    if contents.recorded_runs:
        yield "The settings below belong to the rendered images; the logs decide what varies in the trajectories."
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


def _limitations(metadata: Metadata, contents: Contents) -> Iterator[str]:
    if contents.recorded_runs:
        yield from _limits_of_records(contents)
    else:
        yield "Robot, sensors and light are models; the manual of symolo says how each compares with measurements."
        robots = SimulatedRobots.from_metadata(metadata)
        yield robots.text
        yield from robots.ranges
    for run in metadata.runs:
        yield from (f"{run.run}: {warning}" for warning in run.warnings)


def _limits_of_records(contents: Contents) -> Iterator[str]:
    yield "The parameters of the robots that drove, and the errors of their poses and readings, are not stated."
    if contents.rendered_images:
        yield (
            "Room, light, materials and camera of the rendered images are models: they are no photographs of the place"
            " in which the logs were recorded."
        )


def _limited(texts: Iterator[str]) -> list[str]:
    """Return texts of one line each, the last of which says how many were left out."""
    lines = [one_line(text) for text in texts]
    left_out = len(lines) - MAX_ENTRIES
    return lines if left_out <= 0 else [*lines[:MAX_ENTRIES], f"{left_out} more: see metadata.json"]
