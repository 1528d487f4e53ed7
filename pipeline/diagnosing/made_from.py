"""The record of what a diagnosis was made from, so that it can be made again."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from configs.schema.robot import RobotConfig
from pipeline.work.units import DiagnosisSettings
from symolo.core.errors import InputError
from symolo.core.files.paths import check_path
from symolo.core.files.plain_files import FileKind, read_file

MADE_FROM = "made_from.json"


class MadeFrom(BaseModel):
    """Cases and options of a diagnosis."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    cases: tuple[str, ...] = Field(min_length=1)
    """Absolute paths of the cases; a name that is no path, such as `table-1`, stays as it is."""
    importer: str | None = None
    part: str | None = None
    held_out: tuple[str, ...] = ()
    nominal: str = ""

    @classmethod
    def from_case(cls, case: Path, settings: DiagnosisSettings) -> "MadeFrom":
        """Return the record of a diagnosis of a case, and of those that are fitted together with it."""
        return cls(
            cases=tuple(_whole(path) for path in (case, *settings.together)),
            importer=settings.importer,
            part=settings.part,
            held_out=settings.held_out,
            nominal=settings.nominal,
        )

    @property
    def paths(self) -> tuple[Path, ...]:
        """Paths of the cases."""
        return tuple(Path(name) for name in self.cases)

    @property
    def settings(self) -> DiagnosisSettings:
        """Settings with which the first case is read."""
        return DiagnosisSettings(
            importer=self.importer,
            part=self.part,
            held_out=self.held_out,
            nominal=self.nominal,
            together=self.paths[1:],
        )


def read_made_from(folder: Path) -> MadeFrom:
    """Return the record of the diagnosis in a folder.

    Raises:
        InputError: The folder has no such record, or a case is no longer there.
    """
    file = folder / MADE_FROM
    if not file.is_file():
        cure = "name the output folder of symolo diagnose; with several cases, that of one case"
        raise InputError(f"there is no {MADE_FROM}", where=str(folder), cure=cure)
    try:
        made_from = MadeFrom.model_validate_json(read_file(file, FileKind.DOCUMENT))
        if made_from.nominal:
            RobotConfig.model_validate_json(made_from.nominal)
    except ValidationError as error:
        raise InputError("cannot be read", where=str(file), cure="diagnose the case again") from error
    for path in made_from.paths:
        check_path(path, str(file))
        if path.is_absolute() and not path.exists():
            cure = f"put it back, or diagnose it where it is now with --out {folder}"
            raise InputError(f"the case {path} is no longer there", where=str(file), cure=cure)
    return made_from


def _whole(path: Path) -> str:
    return str(path.absolute()) if path.exists() else str(path)
