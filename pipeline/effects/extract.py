"""The files of the effects that a dataset was made with."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from configs.effects.registry import EFFECTS
from configs.schema.effect_file import EffectFile
from pipeline.run_folder.stored_runs import simulated_folders
from pipeline.run_folder.stored_spec import read_spec
from symolo.core.errors import InputError
from symolo.dataset.documents.metadata import METADATA, read_metadata
from symolo.dataset.layout import SPEC

FILES: TypeAdapter[list[EffectFile]] = TypeAdapter(list[EffectFile])


def effect_files(folder: Path) -> tuple[EffectFile, ...]:
    """Return the effect files of a release, or of runs that were only simulated, each content once.

    Raises:
        InputError: The folder is neither, or a text does not fit its SHA-256.
    """
    metadata = read_metadata(folder)
    if metadata is not None:
        robot = metadata.scenario.get("robot")
        stated = robot.get("effect_files", []) if isinstance(robot, dict) else []
        try:
            files = FILES.validate_python(stated)
        except ValidationError as error:
            what = f"robot.effect_files: {error.errors()[0]['msg']}"
            raise InputError(what, where=str(folder / METADATA), cure="symolo verify lists the faults") from None
    else:
        files = list(_of_stages(folder))
    return tuple({file.sha256: file for file in files}.values())


def named_contents(files: Iterable[EffectFile]) -> dict[str, bytes]:
    """Return the content of each file by its name, with a part of the SHA-256 where two have the same name."""
    contents: dict[str, bytes] = {}
    for file in files:
        name = f"{Path(file.file).stem}-{file.sha256[:8]}.py" if file.file in contents else file.file
        contents[name] = file.text.encode()
    return contents


def effect_file_lines(folder: Path) -> Iterator[str]:
    """Yield a line for each effect file that a dataset was made with: whether a file with its content is loaded.

    Folders that cannot be read have none, for other checks report them.
    """
    try:
        files = effect_files(folder)
    except InputError:
        return
    for file in files:
        loaded = EFFECTS.files.get(file.name)
        state = "a file with the same content is loaded"
        if loaded is None:
            state = f"not loaded; only --effect-file {file.file} simulates its runs again"
        elif loaded.sha256 != file.sha256:
            state = f"the loaded file {loaded.path} has changed since, its SHA-256 is {loaded.sha256}"
        yield f"effect {file.name}: made with {file.file}, SHA-256 {file.sha256}; {state}"


def _of_stages(folder: Path) -> Iterator[EffectFile]:
    runs = simulated_folders(folder)
    if not runs:
        raise InputError("contains no release and no simulated run", where=str(folder))
    for run in runs:
        yield from read_spec(run / SPEC).robot.effect_files
