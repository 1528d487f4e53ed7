"""The specification of a run that an earlier command stored, read without any engine, so that `verify` can."""

import json
from pathlib import Path

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from configs.schema.scenario import RunSpec, SceneSpec
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.tables.side_reading import first_fault

MAX_VALUES = 100_000
"""Largest number of values of a specification; pydantic copies them for each field that is missing."""


def parse_spec(text: str | bytes) -> SceneSpec:
    """Return the content of a spec.json: a `RunSpec`, or a `SceneSpec` if the trajectory was imported.

    Raises:
        ValidationError: It breaks the format.
    """
    commas = text.count(b",") if isinstance(text, bytes) else text.count(",")
    if commas >= MAX_VALUES:
        problem = PydanticCustomError("too_many_values", "has more than {most} values", {"most": MAX_VALUES})
        raise ValidationError.from_exception_data("spec.json", [{"type": problem, "input": None}])
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        content = None  # the model says where it breaks off
    origin = content.get("origin") if isinstance(content, dict) else None
    is_imported = isinstance(origin, dict) and "log" in origin
    spec = (SceneSpec if is_imported else RunSpec).model_validate_json(text)
    RunDocument.model_validate(spec)  # of a sensor whose file is not loaded, the specification has any settings
    return spec


def spec_problem(text: str) -> str:
    """Return what is wrong with the text of a spec.json; empty where nothing is."""
    try:
        parse_spec(text)
    except ValidationError as error:
        return first_fault(error)
    return ""


def read_spec(path: Path, cure: str = "make the run again") -> SceneSpec:
    """Return the specification of a run.

    Raises:
        InputError: The file is missing or damaged.
    """
    try:
        return parse_spec(read_file(path, FileKind.DOCUMENT))
    except FileNotFoundError:
        reason = "there is no such file, which states the robot and the arena"
    except OSError as error:
        reason = error.strerror
    except ValidationError as error:
        reason = first_fault(error)
    raise InputError(f"cannot be read: {reason}", where=str(path), cure=cure)


def read_simulated_spec(path: Path) -> RunSpec:
    """Return the specification of a run that was simulated.

    Raises:
        InputError: The file is missing or damaged, or the trajectory was imported.
    """
    spec = read_spec(path)
    if not isinstance(spec, RunSpec):
        what = (
            "is the specification of an imported trajectory; imports are not supported here, because their readings"
            " were not simulated"
        )
        raise InputError(what, where=str(path), cure="name a run that symolo simulated")
    return spec
