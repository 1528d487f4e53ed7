"""The files of the user's own effects and sensors that a dataset was made with."""

import keyword
import re
import shlex
from collections.abc import Iterable, Iterator
from itertools import chain, count
from pathlib import Path
from typing import Any
from unicodedata import normalize

from pydantic import TypeAdapter, ValidationError

from configs.families import Family
from configs.schema.code_file import CodeFile
from configs.user_files import ROBOT_FILES, RobotFiles
from pipeline.run_folder.stored_runs import simulated_folders
from pipeline.run_folder.stored_spec import read_spec
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.files.plain_files import is_plain_file
from symolo.dataset.documents.metadata import METADATA, read_metadata
from symolo.dataset.layout import SPEC

MAX_LISTED = 20
"""Largest number of files that are listed; a dataset of a stranger may state thousands."""
FILES: TypeAdapter[list[CodeFile]] = TypeAdapter(list[CodeFile])


def new_class_name(name: str, family: Family[Any], example: str) -> str:
    """Return the name of the class of a new member.

    Raises:
        InputError: The name cannot be that of a member, or a shipped member has it.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*", name) or len(name) > 60:
        allowed = f"small letters and digits, words joined by '_', such as {example}"
        raise InputError("NAME", got=name, allowed=allowed)
    if name in {member.name for member in family.shipped}:
        raise InputError("NAME", got=name, cure=f"a shipped {family.noun} has this name; take another one")
    class_name = "".join(word.capitalize() for word in name.split("_"))
    if keyword.iskeyword(class_name):
        raise InputError("NAME", got=name, cure=f"{class_name} cannot be the name of a class; take another one")
    return class_name


def code_files(folder: Path, kind: RobotFiles) -> tuple[CodeFile, ...]:
    """Return the files of one kind of a release, or of runs that were only simulated, each content once.

    Raises:
        InputError: The folder is neither, or a text does not fit its SHA-256.
    """
    metadata = read_metadata(folder)
    if metadata is not None:
        robot = metadata.scenario.get("robot")
        stated = robot.get(kind.key, []) if isinstance(robot, dict) else []
        try:
            files = FILES.validate_python(stated)
        except ValidationError as error:
            what = f"robot.{kind.key}: {error.errors()[0]['msg']}"
            raise InputError(what, where=str(folder / METADATA), cure="`symolo verify` lists the faults") from None
    elif is_plain_file(folder / METADATA):
        cure = "`symolo verify` lists the faults"
        raise InputError("is damaged, or has another format", where=str(folder / METADATA), cure=cure)
    else:
        files = list(_of_stages(folder, kind))
    return tuple({file.sha256: file for file in files}.values())


def named_contents(files: Iterable[CodeFile]) -> dict[str, bytes]:
    """Return the content of each file by its name, with a part of the SHA-256 where two have the same name.

    Names are also the same if a file system may take them for one, in upper and lower case or in two forms of Unicode.
    """
    contents: dict[str, bytes] = {}
    taken: set[str] = set()
    for file in files:
        other = f"{Path(file.file).stem}-{file.sha256[:8]}"
        names = chain((file.file, f"{other}.py"), (f"{other}-{number}.py" for number in count(2)))
        name = next(name for name in names if _as_one(name) not in taken)
        taken.add(_as_one(name))
        contents[name] = file.text.encode()
    return contents


def _as_one(name: str) -> str:
    return normalize("NFC", normalize("NFC", name).casefold())


def extracted(folder: Path, out: Path, kind: RobotFiles) -> tuple[str, ...]:
    """Write the files of one kind into a new folder without executing them, and return their names.

    Raises:
        InputError: The dataset was made without such files, or the new folder cannot be.
    """
    check_new(out, folder)
    contents = named_contents(code_files(folder, kind))
    if not contents:
        raise InputError(f"contains no file of {kind.section} of a user's own", where=str(folder))
    with new_folder(out) as partial:
        for file, data in contents.items():
            write_file(partial / file, data)
    return tuple(contents)


def code_file_lines(folder: Path) -> Iterator[str]:
    """Yield a line for each file that a dataset was made with: whether a file with its content is loaded.

    Folders that cannot be read have none, for other checks report them.
    """
    for kind in ROBOT_FILES:
        try:
            files = code_files(folder, kind)
        except InputError:
            continue
        for file in files[:MAX_LISTED]:
            loaded = kind.family.files.get(file.name)
            state = "a file with the same content is loaded"
            if loaded is None:
                state = f"not loaded; only --{kind.noun}-file {shlex.quote(file.file)} simulates its runs again"
            elif loaded.sha256 != file.sha256:
                state = f"the loaded file {loaded.path} has changed since, its SHA-256 is {loaded.sha256}"
            yield f"{kind.noun} {file.name}: made with {file.file}, SHA-256 {file.sha256}; {state}"
        if (others := len(files) - MAX_LISTED) > 0:
            yield f"made with {others} further files of {kind.section}; `symolo {kind.noun} extract` writes all"


def _of_stages(folder: Path, kind: RobotFiles) -> Iterator[CodeFile]:
    runs = simulated_folders(folder)
    if not runs:
        raise InputError("contains no release and no simulated run", where=str(folder))
    for run in runs:
        yield from getattr(read_spec(run / SPEC).robot, kind.key)
