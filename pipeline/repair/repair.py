"""Repair of a release: damaged files are made again, and put in place if they have the bytes of the manifest."""

import contextlib
import hashlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.devices import DeviceKind
from pipeline.repair import descriptions, existing_copies, frames, tables
from pipeline.repair.repair_state import RepairState, RepairTools, recorded_device, with_one_bit_flipped
from pipeline.run_folder.stored_spec import spec_problem
from pipeline.run_folder.workspace import Workspace
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import remove_file, remove_folder, remove_leftovers, write_file
from symolo.core.files.file_locks import LOCK
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, Metadata, made_with
from symolo.dataset.folder_kind import KIND, check_dataset, check_is_whole
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, read_manifest, tag_manifest
from symolo.verification.findings import Finding
from symolo.verification.inventory import Inventory
from symolo.verification.verify import verify

FITS = "the file matches its checksum, and no other copy exists; `symolo release` with its scenario makes it again"
SCRATCH = "repair"
"""Temporary folder below the hidden stages."""
ASIDE = "aside"
"""Folder below the hidden stages for content that has no place in the release for a moment."""


@dataclass(frozen=True)
class Repaired:
    """The result of a repair."""

    repaired: int
    """Number of files that were restored or removed."""
    left: tuple[Finding, ...]
    """Remaining faults with the reason of each; empty where the release is complete."""


def repair(
    root: Path, workers: int, report: Report, on_repaired: Callable[[str], None], *, remove_extra: bool = False
) -> Repaired:
    """Repair a release.

    Args:
        root: The release.
        workers: Number of child processes at a time.
        report: Progress report.
        on_repaired: Called with a line for each file that is restored.
        remove_extra: Whether files that belong to no release are removed.

    Raises:
        InputError: It is no dataset, or another command works in it.
        EnvironmentLacking: The machine cannot render; what was restored before stays so.
    """
    if (root / DECLARATION).is_file():
        raise InputError("is a bag", where=str(root), cure=f"repair the dataset in it: `symolo repair {root}/data`")
    check_is_whole(root, "symolo repair")
    check_dataset(root)
    workspace = Workspace(root.absolute())
    stages = workspace.out / STAGES
    with workspace.locked():
        for folder, _, _ in os.walk(workspace.out):  # those that cannot be read are reported as faults
            with contextlib.suppress(PermissionError):
                remove_leftovers(Path(folder))
        scratch = stages / SCRATCH
        remove_folder(scratch)
        try:
            return _repair(workspace, scratch, workers, report, on_repaired, remove_extra=remove_extra)
        finally:
            remove_folder(scratch)
            # Also those of an interrupted repair go, but for what it has laid aside.
            if {path.name for path in stages.iterdir()} <= {LOCK, KIND}:
                remove_folder(stages)


def _repair(
    workspace: Workspace,
    scratch: Path,
    workers: int,
    report: Report,
    on_repaired: Callable[[str], None],
    *,
    remove_extra: bool,
) -> Repaired:
    inventory = Inventory.from_folder(workspace.out)
    if not inventory.trusted and _flip_manifest_back(workspace.out, on_repaired):
        inventory = Inventory.from_folder(workspace.out)
    faults = list(inventory.findings())
    aside = workspace.out / STAGES / ASIDE
    if not faults:
        remove_folder(aside)  # of a repair that was interrupted just before it did so
        return Repaired(0, tuple(_faults_of_content(workspace.out)))
    if not inventory.trusted:
        why = "no list of checksums can be trusted; `symolo release` with its scenario makes damaged files again"
        first, *others = faults
        return Repaired(0, (Finding(first.file, f"{first.what}; {why}"), *others))
    state = RepairState.from_inventory(workspace, inventory, on_repaired)
    moved = existing_copies.put_back(state, aside)
    existing_copies.take_from_stages(state)
    descriptions.flip_back(state, (METADATA,))
    metadata = descriptions.read_metadata(state)
    difference = descriptions.differences(state, metadata, made_with())
    descriptions.write_description(state, metadata, f"written again, its text is different; {difference}")
    runs = metadata.runs if metadata else []
    devices: dict[str, DeviceKind] = {record.run: recorded_device(record.render_device) for record in runs}
    tools = RepairTools(scratch, workers, report, devices, difference)
    specs = descriptions.make_specs(state, metadata, state.runs())
    tables.make_tables(state, specs, metadata, tools)
    frames.render_frames(state, specs, tools)
    descriptions.flip_back(state, list(state.wanted))
    descriptions.write_bag_info(state, metadata)
    _write_lists(state)
    for name in sorted(inventory.extra & (moved if not remove_extra else inventory.extra)):
        _remove(workspace.out / name, workspace.out)
        on_repaired(f"removed: {name}: it does not belong to the release")
    return _result(state, len(faults), metadata)


def _remove(path: Path, out: Path) -> None:
    """Remove a file or an empty folder, and the folders above it that become empty."""
    (remove_folder if path.is_dir() and not path.is_symlink() else remove_file)(path)
    if path.parent != out and not any(path.parent.iterdir()):
        _remove(path.parent, out)


def _flip_manifest_back(out: Path, on_repaired: Callable[[str], None]) -> bool:
    """Restore a manifest in which a single bit is wrong, which is possible even if other files are damaged."""
    try:
        data, noted = (
            read_file(out / MANIFEST, FileKind.CHECKSUMS),
            read_manifest(read_file(out / TAG_MANIFEST, FileKind.CHECKSUMS))[MANIFEST],
        )
    except (OSError, ValueError, KeyError):
        return False
    right = with_one_bit_flipped(data, noted)
    if right is None:
        return False
    write_file(out / MANIFEST, right)
    on_repaired(f"repaired: {MANIFEST}: one bit was wrong")
    return True


def _write_lists(state: RepairState) -> None:
    """Write the lists of checksums, even if files are still damaged."""
    expected = state.inventory.expected
    for name, text in ((MANIFEST, manifest(expected)), (TAG_MANIFEST, tag_manifest(expected))):
        if state.inventory.files.digests.get(name) != hashlib.sha256(text).hexdigest():
            state.write(name, text, "written again")


def _result(state: RepairState, faults: int, metadata: Metadata | None) -> Repaired:
    """Return the result after another check of every file."""
    left = []
    by_checksum = list(Inventory.from_folder(state.out).findings())
    if not by_checksum:
        left = list(_faults_of_content(state.out))
    for fault in by_checksum:
        why = state.tried.get(fault.file, "")
        if not why and fault.file in state.wanted:
            if fault.file == METADATA:
                why = "there is no other copy of it; `symolo release` with its scenario writes it again"
            elif metadata is None:
                why = f"{METADATA} is needed to make it again"
            else:
                why = "the files that it is made from are damaged too"
        elif not why and fault.file in state.inventory.extra:
            why = "--remove-extra removes it"
        left.append(Finding(fault.file, f"{fault.what}; {why}" if why else fault.what))
    return Repaired(max(0, faults - len(left)), tuple(left))


def _faults_of_content(out: Path) -> Iterator[Finding]:
    """Yield the faults that `verify` finds in files that fit their checksums, of which no other content is known."""
    for fault in verify(out, spec_problem):
        yield Finding(fault.file, f"{fault.what}; {FITS}")
