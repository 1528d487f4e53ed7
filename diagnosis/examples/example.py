"""The cases that are shipped with the package, so that a diagnosis can be tried without a robot."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from diagnosis.measured.case_files.nominal import NOMINAL, kind_of
from symolo.core.errors import InputError, nearest
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.files.plain_files import FileKind, read_named_file

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Example:
    """A case of the package, and the truth about it."""

    folder: Path
    """Folder of the case; its name is that of the example."""
    kind: str
    """Kind of the case, such as motor_steady."""
    hidden: Mapping[str, Mapping[str, object]]
    """Effects that the simulated robot had, with their parameters as far as its author states them."""
    note: str = ""
    """Definition of the effects of the case, if it differs from that of the diagnosis."""

    @property
    def name(self) -> str:
        return self.folder.name

    def copy(self, out: Path) -> None:
        """Copy the case into a folder that is new or empty.

        Raises:
            InputError: The folder exists and is not empty.
        """
        check_new(out)
        with new_folder(out) as folder:
            for file in sorted(file for file in self.folder.rglob("*") if file.is_file()):
                copied = folder / file.relative_to(self.folder)
                make_folder(copied.parent)
                write_file(copied, read_named_file(file, FileKind.LOG))


def examples() -> tuple[Example, ...]:
    """Return all examples, in the order of their names."""
    answers = json.loads(read_named_file(FOLDER / "answers.json", FileKind.DOCUMENT))
    return tuple(
        Example(
            file.parent,
            str(kind_of(file)),
            {effect["name"]: effect.get("parameters", {}) for effect in answers[file.parent.name]["effects"]},
            answers[file.parent.name].get("note", ""),
        )
        for file in sorted(FOLDER.glob(f"*/{NOMINAL}"))
    )


def example_of(name: str) -> Example:
    """Return the example of this name, or the first one with a hidden effect of this kind.

    Raises:
        InputError: No example has this name or kind.
    """
    cases = examples()
    for case in cases:
        if name == case.name or (name == case.kind and case.hidden):
            return case
    names = [*dict.fromkeys(case.kind for case in cases), *(case.name for case in cases)]
    raise InputError(
        "there is no such example", got=name, allowed=f"one of {', '.join(names)}", nearest=nearest(name, names)
    )
