"""side/spec.json of a released run, held to the whole schema."""

from pathlib import Path

from pydantic import ValidationError

from configs.schema.scenario import RunSpec
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.layout import SIDE, SPEC
from symolo.dataset.tables.side_reading import first_fault


def spec_problem(text: str) -> str:
    """Return what is wrong with the text of a spec.json; empty where nothing is."""
    try:
        RunSpec.model_validate_json(text)
    except ValidationError as error:
        return first_fault(error)
    return ""


def read_run_spec(run_folder: Path) -> RunSpec:
    """Return every number that a released run was made from.

    Raises:
        InputError: The file is missing or damaged.
    """
    path = run_folder / SIDE / SPEC
    try:
        return RunSpec.model_validate_json(read_file(path, FileKind.DOCUMENT))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    except ValidationError as error:
        raise InputError(f"is damaged: {first_fault(error)}", where=str(path)) from None
