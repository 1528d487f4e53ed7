"""Files with effects and sensors of the user's own, which a robot names: `effect_files`, `sensor_files`.

They are loaded here and only here, while a scenario or a robot file that the user named is read; a specification that
was written before contains their text, which nothing executes.
"""

import importlib
import os
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from configs.families import Family
from configs.schema.code_file import CodeFile
from symolo.core.errors import InputError
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import Node, node_of


@dataclass(frozen=True)
class RobotFiles:
    """A key of a robot that names files of one family, and the section whose entries need them."""

    key: str
    section: str
    registry: str
    """Module with the family, which may be in a package above this one and is imported when it is first needed."""
    table: str
    """Name of the family there."""
    has_kinds: bool = False
    """Whether an entry of the section may name its class by `kind`, in place of its key."""

    @property
    def family(self) -> Family[Any]:
        return getattr(importlib.import_module(self.registry), self.table)

    @property
    def noun(self) -> str:
        """Name of a member in messages and commands, for example `effect`."""
        return self.key.removesuffix("_files")

    def names(self, robot: Node) -> set[str]:
        """Return the names of the classes that a robot needs, whether or not they are the user's own."""
        section = robot.child(self.section)
        entries = [(str(key), node) for key, node in section.children()] if section else []
        kinds = {key: node.plain_at(("kind",)) if self.has_kinds else None for key, node in entries}
        return {str(kinds[key] or key) for key, node in entries if node.value is not None}

    def unloaded(self, robot: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any], CodeFile]]:
        """Yield key, values and file of each entry of plain values whose class is not loaded from its recorded file."""
        records, section = robot.get(self.key), robot.get(self.section)
        if not isinstance(records, (list, tuple)) or not isinstance(section, dict):
            return  # the schema says what is wrong
        by_name = {record.name: record for each in records if (record := _record(each)) is not None}
        for key, values in section.items():
            if isinstance(values, dict):
                name = values.get("kind", key) if self.has_kinds else key
                record = by_name.get(name) if isinstance(name, str) else None
                if record is not None and self.problem(record) is not None:
                    yield key, values, record

    def problem(self, record: CodeFile, use: str = "") -> InputError | None:
        """Return why nothing can be computed with the class of a recorded file, and what to do; None if it is loaded.

        Nothing executes the text of the record. `use` follows the message and says what the file is needed for.
        """
        other = self.family.files.get(record.name)
        cure = (
            f"`symolo {self.noun} extract` writes the file from the dataset; read it, since it is code, and then name"
            f" it before the command: symolo --{self.noun}-file {shlex.quote(record.file)} ..."
        )
        if other is None:
            what = f"{self.noun} {record.name}: its file {record.file} ({record.sha256}) is not loaded{use}"
            return InputError(what, cure=cure)
        if other.sha256 == record.sha256:
            return None
        what = f"{self.noun} {record.name}: the file has changed since the data were made"
        return InputError(what, where=str(other.path), got=other.sha256, allowed=record.sha256, cure=cure)

    def load(self, files: Node) -> None:
        """Load the files of a list of paths; a record in it was loaded when it was made."""
        what, allowed = f"robot.{self.key}", f"a list of Python files, such as [my_{self.noun}.py]"
        if not isinstance(files.value, tuple):
            raise InputError(what, where=files.where, got=files.plain(), allowed=allowed)
        for item in files.value:
            if isinstance(item.value, str) and item.value:
                if not os.path.isfile(item.value):  # noqa: PTH113 - pathlib raises for a name that the system refuses
                    got = displayed(Path(item.value))
                    raise InputError(f"{what}: no such file", where=item.where, got=got, allowed="a Python file")
                self.family.load(item.value)
            elif str(item.plain_at(("name",))) not in self.family.files:
                cure = "if this is the text of a file from a dataset, write it to a file and name that; read it first"
                raise InputError(what, where=item.where, got=item.plain(), allowed=allowed, cure=cure)

    def record_of(self, name: str) -> dict[str, Any]:
        """Return the record of a file that is loaded, as `CodeFile` has it.

        Raises:
            InputError: The file is not in UTF-8.
        """
        file = self.family.files[name]
        try:
            text = file.text.decode()
        except UnicodeDecodeError:
            raise InputError(f"{self.noun} file", where=str(file.path), allowed="a file in UTF-8") from None
        return {"name": name, "file": file.path.name, "sha256": file.sha256, "text": text}


EFFECT_FILES = RobotFiles("effect_files", "effects", "configs.effects.registry", "EFFECTS")
SENSOR_FILES = RobotFiles("sensor_files", "sensors", "sensors.registry", "SENSORS", has_kinds=True)
ROBOT_FILES = (EFFECT_FILES, SENSOR_FILES)
KEYS = tuple(files.key for files in ROBOT_FILES)


def anchored_files(robot: Node, folder: Path) -> Node:
    """Return a robot with absolute paths of its files, which are relative to `folder` in a file."""
    fields = dict(robot.value) if isinstance(robot.value, dict) else {}
    for key in KEYS:
        if (files := fields.get(key)) is not None and isinstance(files.value, tuple):
            fields[key] = Node(tuple(_anchored(item, folder) for item in files.value), files.where)
    return Node(fields, robot.where) if fields else robot


def _anchored(item: Node, folder: Path) -> Node:
    if not isinstance(item.value, str) or not item.value:
        return item
    return Node(os.path.abspath(folder / os.path.expanduser(item.value)), item.where)  # noqa: PTH100, PTH111 - as typed


def with_files_of_both(base: Node, over: Node, merged: Node) -> Node:
    """Return a robot that extends another, `merged`, with the files of both."""
    fields = dict(merged.value) if isinstance(merged.value, dict) else {}
    for key in KEYS:
        files = [node.value for robot in (base, over) if (node := robot.child(key)) and isinstance(node.value, tuple)]
        if len(files) == 2:
            fields[key] = Node((*files[0], *files[1]), fields[key].where)
    return Node(fields, merged.where) if fields else merged


def with_user_files(root: Node) -> Node:
    """Load the files that the robot of a tree names, and return the tree with a record of each that it needs.

    Also the class of a file that the command line names has a record, so that a specification contains all code that
    its data came from.

    Args:
        root: Tree of a scenario, or of a section.

    Raises:
        InputError: A file does not exist, cannot be executed, or has no complete class.
    """
    robot = root.child("robot")
    if robot is None or not isinstance(robot.value, dict) or not isinstance(root.value, dict):
        return root
    fields = {key: node for key, node in robot.value.items() if key not in KEYS}
    for kind in ROBOT_FILES:
        files, needed = robot.child(kind.key), kind.names(robot)
        if files is not None:
            kind.load(files)
        if needed and (records := [kind.record_of(name) for name in sorted(needed & kind.family.files.keys())]):
            fields[kind.key] = node_of(records, files.where if files else robot.where)
    return Node({**root.value, "robot": Node(fields, robot.where)}, root.where)


def with_unloaded_apart(
    robot: Any,  # noqa: ANN401 - whatever a file holds
    kind: RobotFiles,
    unloaded: Callable[[str, dict[str, Any], CodeFile], object],
    *,
    known_only: bool,
) -> Any:  # noqa: ANN401 - as above
    """Return the plain values of a robot in which `unloaded` makes the entries whose files are not loaded.

    Args:
        robot: Values as a file has them.
        kind: Key of the files.
        unloaded: Function of the key, the values and the file of such an entry.
        known_only: Whether to refuse such entries, as where numbers are to be drawn within their bounds.
    """
    apart = {key: (values, file) for key, values, file in kind.unloaded(robot)} if isinstance(robot, dict) else {}
    if not apart:
        return robot
    problems = [problem for _, file in apart.values() if (problem := kind.problem(file)) is not None]
    if known_only and problems:
        raise problems[0]
    entries = {key: unloaded(key, values, file) for key, (values, file) in apart.items()}
    return {**robot, kind.section: {**robot[kind.section], **entries}}


def _record(stated: object) -> CodeFile | None:
    """Return a stated record, which the schema checks later; None if it has no name."""
    if isinstance(stated, CodeFile):
        return stated
    if not isinstance(stated, dict) or not isinstance(stated.get("name"), str):
        return None
    file, sha256 = str(stated.get("file")), str(stated.get("sha256"))
    return CodeFile.model_construct(name=stated["name"], file=file, sha256=sha256, text="")
