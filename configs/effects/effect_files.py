"""Files with effects of the user's own, which a robot names: `effect_files: [my_effect.py]`.

They are loaded here and only here, while a scenario or a robot file that the user named is read; a specification that
was written before contains their text, which nothing executes.
"""

import os
from pathlib import Path
from typing import Any

from configs.effects.registry import EFFECTS
from symolo.core.errors import InputError
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import Node, node_of

KEY = "effect_files"


def anchored_files(robot: Node, folder: Path) -> Node:
    """Return a robot with absolute paths of its effect files, which are relative to `folder` in a file."""
    files = robot.child(KEY)
    if files is None or not isinstance(files.value, tuple) or not isinstance(robot.value, dict):
        return robot
    paths = tuple(
        Node(os.path.abspath(folder / os.path.expanduser(item.value)), item.where)  # noqa: PTH100, PTH111 - as typed
        if isinstance(item.value, str) and item.value
        else item
        for item in files.value
    )
    return Node({**robot.value, KEY: Node(paths, files.where)}, robot.where)


def with_files_of_both(base: Node, over: Node, merged: Node) -> Node:
    """Return a robot that extends another, `merged`, with the files of both."""
    files = [node.value for robot in (base, over) if (node := robot.child(KEY)) and isinstance(node.value, tuple)]
    if len(files) < 2 or not isinstance(merged.value, dict):
        return merged
    return Node({**merged.value, KEY: Node((*files[0], *files[1]), merged.value[KEY].where)}, merged.where)


def with_user_effects(root: Node) -> Node:
    """Load the files that the robot of a tree names, and return the tree with a record of each that it needs.

    Also an effect of a file that the command line names has a record, so that a specification contains all code that
    its data came from.

    Args:
        root: Tree of a scenario, or of a section.

    Raises:
        InputError: A file does not exist, cannot be executed, or has no complete effect.
    """
    robot = root.child("robot")
    if robot is None or not isinstance(robot.value, dict) or not isinstance(root.value, dict):
        return root
    files = robot.child(KEY)
    if files is not None:
        _load(files)
    effects = robot.child("effects")
    present = [str(key) for key, node in effects.children() if node.value is not None] if effects else []
    fields = {key: node for key, node in robot.value.items() if key != KEY}
    if records := [record_of(name) for name in sorted({*present} & EFFECTS.files.keys())]:
        fields[KEY] = node_of(records, files.where if files else robot.where)
    return Node({**root.value, "robot": Node(fields, robot.where)}, root.where)


def _load(files: Node) -> None:
    """Load the files of a list of paths; a record in it was loaded when it was made."""
    what, allowed = f"robot.{KEY}", "a list of Python files, such as [my_effect.py]"
    if not isinstance(files.value, tuple):
        raise InputError(what, where=files.where, got=files.plain(), allowed=allowed)
    for item in files.value:
        if isinstance(item.value, str) and item.value:
            if not os.path.isfile(item.value):  # noqa: PTH113 - pathlib raises for a name that the system refuses
                got = displayed(Path(item.value))
                raise InputError(f"{what}: no such file", where=item.where, got=got, allowed="a Python file")
            EFFECTS.load(item.value)
        elif str(item.plain_at(("name",))) not in EFFECTS.files:
            cure = "if this is the text of a file from a dataset, write it to a file and name that; read it first"
            raise InputError(what, where=item.where, got=item.plain(), allowed=allowed, cure=cure)


def record_of(name: str) -> dict[str, Any]:
    """Return the record of the file of an own effect that is loaded, as `EffectFile` has it.

    Raises:
        InputError: The file is not in UTF-8.
    """
    file = EFFECTS.files[name]
    try:
        text = file.text.decode()
    except UnicodeDecodeError:
        raise InputError("effect file", where=str(file.path), allowed="a file in UTF-8") from None
    return {"name": name, "file": file.path.name, "sha256": file.sha256, "text": text}
