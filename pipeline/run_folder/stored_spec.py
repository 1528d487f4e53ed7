"""The specification of a run that an earlier command stored, read without any engine, so that `verify` can."""

from pathlib import Path

from pydantic import ValidationError

from configs.schema.scenario import RunSpec
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.tables.side_reading import first_fault


def spec_problem(text: str) -> str:
    """Return what is wrong with the text of a spec.json; empty where nothing is."""
    try:
        RunSpec.model_validate_json(text)
    except ValidationError as error:
        return first_fault(error)
    return ""


def read_spec(path: Path, cure: str = "make the run again") -> RunSpec:
    """Return the specification of a run.

    Raises:
        InputError: The file is missing or damaged.
    """
    try:
        return RunSpec.model_validate_json(read_file(path, FileKind.DOCUMENT))
    except OSError as error:
        reason = error.strerror
    except ValidationError as error:
        reason = first_fault(error)
    raise InputError(f"cannot be read: {reason}", where=str(path), cure=cure)
