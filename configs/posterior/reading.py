"""The key `like` of a scenario: the posterior file that it names, read strictly.

The scenario of a published dataset contains the whole posterior in place of the path, so that `release` makes the
dataset again without the file. It may come from a stranger, so it is checked as strictly as a file, and nothing in it
is executed.
"""

import os
import shlex
from pathlib import Path

from pydantic import ValidationError

from configs.effects.registry import EFFECTS
from configs.posterior.schema import FILE, VERSION, LoadedPosterior, Posterior
from configs.schema.base import Section
from configs.user_files import EFFECT_FILES
from configs.validation.schema_faults import all_explained
from configs.validation.shapes import Shape
from symolo.core.errors import InputError, together
from symolo.core.files.file_hashes import sha256_of
from symolo.core.yaml.reader import displayed, read_yaml
from symolo.core.yaml.tree import Node, node_of

KEY = "like"


class _Stored(Section):
    """A posterior within a scenario."""

    like: LoadedPosterior


_ALLOWED = f"the output folder of `symolo diagnose`, or its {FILE}"


def anchored_posterior(scenario: Node, folder: Path) -> Node:
    """Return a scenario with an absolute path of its posterior, which is relative to `folder` in a file."""
    named = scenario.child(KEY)
    if named is None or not isinstance(named.value, str) or not isinstance(scenario.value, dict):
        return scenario
    place = os.path.abspath(folder / os.path.expanduser(named.value))  # noqa: PTH100, PTH111 - as typed
    return Node({**scenario.value, KEY: Node(place, named.where)}, scenario.where)


def with_posterior(root: Node) -> Node:
    """Return a scenario with the content of the posterior file that it names in place of the path.

    Raises:
        InputError: There is no such file, it has a different version, or something in it is wrong; or the scenario
            contains the posterior itself, and something in that is wrong.
    """
    named = root.child(KEY)
    if named is None or not isinstance(root.value, dict):
        return root
    if named.value is None:
        return Node({key: node for key, node in root.value.items() if key != KEY}, root.where)
    if isinstance(named.value, dict):
        _check_stored(named)
        return root
    if not isinstance(named.value, str) or not named.value:
        raise InputError(KEY, where=named.where, got=named.plain(), allowed=_ALLOWED)
    return Node({**root.value, KEY: _read(_file(named), named.where)}, root.where)


def _file(named: Node) -> Path:
    path = Path(str(named.value))
    field = "" if named.where.endswith(KEY) else f"{KEY}: "  # an option names the field itself
    # For names that the system refuses, os.path returns False, while pathlib raises.
    if os.path.isdir(path):  # noqa: PTH112 - as above
        path /= FILE
        if not os.path.isfile(path):  # noqa: PTH113 - as above
            cure = "diagnose the case again: earlier versions did not write this file"
            what = f"{field}the folder has no {FILE}"
            raise InputError(what, where=named.where, got=displayed(path.parent), allowed=_ALLOWED, cure=cure)
    if not os.path.isfile(path):  # noqa: PTH113 - as above
        raise InputError(f"{field}no such file", where=named.where, got=displayed(path), allowed=_ALLOWED)
    return path


def _read(path: Path, where: str) -> Node:
    root = read_yaml(path).root
    version = root.child("version")
    if version is None or version.value != VERSION or isinstance(version.value, bool):
        raise InputError(
            f"{KEY}: version of the file" if version else f"{KEY}: this is no {FILE}, since it states no version",
            where=version.where if version else root.where,
            got=version.plain() if version else ...,
            allowed=f"{VERSION}" if version else "",
            cure="diagnose the case again with this version of symolo" if version else f"name {_ALLOWED}",
        )
    fields = dict(root.value) if isinstance(root.value, dict) else {}
    if (files := fields.get("effect_files")) is not None:
        fields["effect_files"] = _with_records(files, path.parent)
    complete = Node(fields, root.where)
    try:
        Posterior.model_validate(complete.plain())
    except ValidationError as error:
        raise together(all_explained(error, complete, Shape.from_model(Posterior))) from None
    return Node({**fields, "sha256": Node(sha256_of(path), where)}, where)


def _check_stored(posterior: Node) -> None:
    """Check a posterior that a scenario contains.

    Raises:
        InputError: Something in it is wrong, or an effect of its own is not loaded from a file of the same content.
    """
    complete = Node({KEY: posterior}, posterior.where)
    try:
        loaded = _Stored.model_validate(complete.plain()).like
    except ValidationError as error:
        raise together(all_explained(error, complete, Shape.from_model(_Stored))) from None
    for record in loaded.effect_files:
        file = EFFECTS.files.get(record.name)
        if file is None or file.sha256 != record.sha256:
            raise InputError(
                f"{KEY}.effect_files: {record.file} is not loaded" + (" with this content" if file else ""),
                where=posterior.where,
                allowed=f"a file with the SHA-256 {record.sha256}",
                cure=f"write its text to a file, read it, and name that: symolo --effect-file"
                f" {shlex.quote(record.file)} ...",
            )


def _with_records(files: Node, folder: Path) -> Node:
    """Load the files of the user's own effects, which lie beside the posterior, and return a record of each."""
    records = []
    for _, item in files.children():
        if not isinstance(item.value, str) or Path(item.value).name != item.value:
            allowed = "names of Python files in the folder of the posterior"
            raise InputError("effect_files", where=item.where, got=item.plain(), allowed=allowed)
        records.append(EFFECT_FILES.record_of(EFFECTS.load(folder / item.value).name))
    return node_of(records, files.where)
