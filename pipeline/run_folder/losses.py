"""What a command would take away from a finished release, which it does only if the user says so."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from configs.schema.scenario import SceneSpec
from pipeline.run_folder.status import image_changes, in_order
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import released_runs
from symolo.core.errors import InputError
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import is_plain_file
from symolo.core.progress import Report, plural
from symolo.dataset.documents.metadata import Metadata, made_with, read_metadata
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, SIGNATURE, TAG_MANIFEST

MAX_NAMES = 3
"""Largest number of runs that a line names."""


@dataclass(frozen=True)
class Losses:
    """Parts of a finished release that the next one takes away."""

    name: str
    """Name of the finished dataset; empty if it is not known."""
    new_name: str
    """Name of the dataset that the command makes."""
    runs: tuple[str, ...]
    """Released runs that would be removed, or all of them if the dataset has another name."""
    images: int
    """Number of their images, of all cameras."""
    signature: bool

    @property
    def text(self) -> str:
        """All of it in words; empty if nothing is lost."""
        parts = [
            named_runs(self.runs) if self.runs else "",
            plural(self.images, "image") if self.images else "",
            "the signature" if self.signature else "",
        ]
        *first, last = [part for part in parts if part] or [""]
        return f"{', '.join(first)} and {last}" if first else last


def named_runs(runs: Sequence[str]) -> str:
    """Return a number of runs with the names of the first ones."""
    more = f" and {len(runs) - MAX_NAMES} more" if len(runs) > MAX_NAMES else ""
    return f"{plural(len(runs), 'run')} ({', '.join(runs[:MAX_NAMES])}{more})"


def losses_of(workspace: Workspace, tree: dict[str, Any], specs: Sequence[SceneSpec]) -> Losses:
    """Return what the folder would lose if the runs `specs` of the scenario `tree` were released into it."""
    out, new_name = workspace.out, specs[0].scenario
    if not all(is_plain_file(out / name) for name in (MANIFEST, TAG_MANIFEST)):
        return Losses("", new_name, (), 0, signature=False)
    metadata = read_metadata(out) or read_metadata(out / STAGES / "assemble")
    name = metadata.name if metadata else ""
    released = released_runs(workspace)
    runs = released if name and name != new_name else released - {spec.key for spec in specs}
    signature = (out / SIGNATURE).exists() and (bool(runs) or _changes(workspace, metadata, tree, specs))
    return Losses(name, new_name, tuple(sorted(runs, key=in_order)), _images(metadata, runs), signature)


def check_losses(
    workspace: Workspace, tree: dict[str, Any], specs: Sequence[SceneSpec], report: Report, *, replace: bool
) -> None:
    """Refuse to take anything away from a finished release; with `replace`, only report what will be lost.

    Raises:
        InputError: Something would be lost, without `replace`.
    """
    losses = losses_of(workspace, tree, specs)
    if not losses.text:
        return
    if replace:
        report.say(f"--replace: the finished dataset {losses.name} loses {losses.text}")
        return
    other = f", and not {losses.new_name}" if losses.name not in {losses.new_name, ""} else ""
    raise InputError(
        f"contains the finished dataset {losses.name}{other}: {losses.text} would be lost",
        where=f"--out {workspace.out}",
        cure="name another folder with --out, or give --replace",
    )


def _changes(workspace: Workspace, metadata: Metadata | None, tree: dict[str, Any], specs: Sequence[SceneSpec]) -> bool:
    """Return whether released files would get another content, as far as their inputs tell."""
    if metadata is not None:
        versions = made_with()
        if any(versions.get(program) != version for program, version in metadata.made_with.items()):
            return True
        if canonical_json(metadata.scenario) != canonical_json(tree):
            return True
    return any(image_changes(workspace, spec.key, spec) for spec in specs)


def _images(metadata: Metadata | None, runs: Iterable[str]) -> int:
    records = [record for record in metadata.runs if record.run in runs] if metadata else []
    return sum(record.images + sum(camera.images for camera in record.cameras.values()) for record in records)
