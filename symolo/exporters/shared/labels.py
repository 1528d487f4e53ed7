"""Meaning of the label images of an export: categories, instances of each run and encodings, which their files lack."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from functools import cache

from symolo.core.files.file_hashes import canonical_json
from symolo.dataset.annotations import RECORD_KINDS, AnnotationDocument, CategoryEntry
from symolo.dataset.documents.description import markdown_table
from symolo.exporters.base import ExportedFile
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run

Documents = Mapping[str, AnnotationDocument]
"""Annotations of one run by camera; the name of the camera of data.csv is empty."""
LABELS = "labels.json"
MAX_LISTED_RUNS = 10
"""Largest number of runs whose instances are in the text for people."""


def label_files(data: Dataset) -> Iterator[ExportedFile]:
    """Yield labels.json, unless no image has a label image."""
    if _labelled(data):
        yield ExportedFile(LABELS, cache(lambda: _labels(data)))


def labels_part(data: Dataset, main: str) -> list[str]:
    """Return the content of labels.json as lines of Markdown; none if no image has a label image.

    Args:
        data: The dataset.
        main: Name of the table of images of the camera of data.csv; that of a further camera has the camera's name.
    """
    documents = _labelled(data)
    if not documents:
        return []
    encodings = dict.fromkeys(
        (camera or main, kind, text)
        for run_documents in documents.values()
        for camera, document in run_documents.items()
        for kind, text in _encodings(document).items()
    )
    lines = ["", "## Label images", "", f"Programs find these tables, for every run, in [{LABELS}]({LABELS})."]
    lines += ["", *markdown_table(("rows of", "column", "encoding"), encodings).splitlines()]
    lines += ["", "C is the camera: x to the right, y down, z along the optical axis.", ""]
    categories = [(str(one.id), one.name) for one in _categories(documents)]
    lines += markdown_table(("category", "name"), categories).splitlines()
    if any(kind == "instance" for _, kind, _ in encodings):
        instances = [(run, _instances(run_documents)) for run, run_documents in documents.items()]
        lines += ["", "An id of an instance may mean something else in another run.", ""]
        lines += markdown_table(("run", "instances"), instances[:MAX_LISTED_RUNS]).splitlines()
        if len(instances) > MAX_LISTED_RUNS:
            lines += ["", f"{LABELS} has those of all {len(instances)} runs."]
    return lines


def _labelled(data: Dataset) -> dict[str, Documents]:
    """Return the annotations of each run that has label images."""
    return {run.name: documents for run in data.runs if (documents := _documents(run))}


def _documents(run: Run) -> Documents:
    cameras = {"": run, **run.cameras}
    return {name: camera.annotations for name, camera in cameras.items() if camera.annotation_kinds}


def _first(documents: Documents) -> AnnotationDocument:
    """Return the annotations of a camera, for what is the same for all cameras of a run."""
    return next(iter(documents.values()))


def _encodings(document: AnnotationDocument) -> dict[str, str]:
    return {kind: text for kind, text in document.encodings.items() if kind not in RECORD_KINDS}


def _categories(documents: Mapping[str, Documents]) -> tuple[CategoryEntry, ...]:
    """Return the categories, which are the same for all runs."""
    return _first(next(iter(documents.values()))).categories


def _instances(documents: Documents) -> str:
    return ", ".join(f"{one.id} {one.name}" for one in _first(documents).instances)


def _labels(data: Dataset) -> bytes:
    documents = _labelled(data)
    return canonical_json(
        {
            "categories": [asdict(one) for one in _categories(documents)],
            "runs": {run: _labels_of_run(run_documents) for run, run_documents in documents.items()},
        }
    )


def _labels_of_run(documents: Documents) -> dict[str, object]:
    """Return the instances and the encodings of each camera."""
    further = {name: _encodings(document) for name, document in documents.items() if name}
    return {
        "instances": [asdict(one) for one in _first(documents).instances],
        **({"encodings": _encodings(documents[""])} if "" in documents else {}),
        **({"encodings_of_cameras": further} if further else {}),
    }
