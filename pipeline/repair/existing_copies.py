"""Copies of damaged files elsewhere: under another name in the release, or in the hidden stages."""

import contextlib
from pathlib import Path

from pipeline.repair.repair_state import RUN_PARTS, RepairState
from pipeline.run_folder.first_stage import TAKEN
from pipeline.stages.assemble import METADATA_COPY
from pipeline.stages.render import IMAGES
from pipeline.stages.simulate_runs import SPEC
from symolo.core.files.atomic_files import make_folder, remove_folder, write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import ANNOTATIONS, SIDE, camera_and_file


def put_back(state: RepairState, aside: Path) -> set[str]:
    """Restore files that are in the release under another name, and return those names that are extra files.

    An interruption at any instant loses no content: all that will be overwritten and belongs elsewhere is copied into
    `aside` first, such as that of two files that were swapped. That folder goes when the content has its place.
    """
    sources: dict[str, str] = {}
    for name, digest in state.wanted.items():
        if places := state.inventory.places.get(digest, ()):
            sources[name] = next((place for place in places if place in state.inventory.extra), places[0])
    for place in sorted({place for place in sources.values() if place in state.wanted}):
        make_folder(aside)
        write_file(aside / state.inventory.files.digests[place], read_file(state.out / place, FileKind.ANY))
    last = {place: name for name, place in sources.items() if place in state.inventory.extra}
    moved: set[str] = set()
    for name, digest in list(state.wanted.items()):
        copy, place = aside / digest, sources.get(name)
        if place is not None and not copy.exists():
            copy = state.out / place
        if place in last and last[place] == name:
            # Renamed, for after an interruption a copy that stayed would be taken for a file of the user's own.
            with contextlib.suppress(OSError):
                state.take_over(place, name)
                copy = state.out / name
        how = f"its content was in {place}" if place else "an interrupted repair had moved it aside"
        with contextlib.suppress(OSError):
            if state.put(name, read_file(copy, FileKind.ANY), how) and place in last:
                moved.add(place)
    if not any((aside / digest).exists() for digest in state.wanted.values()):
        remove_folder(aside)
    return moved


def take_from_stages(state: RepairState) -> None:
    """Restore files of which the stages have a copy."""
    for name in list(state.wanted):
        if path := _copy_in_stages(state, name):
            with contextlib.suppress(OSError):
                state.put(name, read_file(path, FileKind.ANY), "from the stages")


def _copy_in_stages(state: RepairState, name: str) -> Path | None:
    if name == METADATA:
        return state.out / METADATA_COPY
    parts = name.split("/", RUN_PARTS)
    if len(parts) <= RUN_PARTS:
        return None
    run, inner = "/".join(parts[:RUN_PARTS]), parts[RUN_PARTS]
    camera, file = camera_and_file(inner)
    logged_copy = state.workspace.simulate(run).path / TAKEN / inner
    if camera and logged_copy.is_file():
        return logged_copy
    if file.startswith(f"{IMAGES}/"):
        return state.workspace.render(run, camera).path / file
    if file.startswith(f"{ANNOTATIONS}/"):
        return state.workspace.annotate(run, camera).path / file
    return state.workspace.simulate(run).path / SPEC if inner == f"{SIDE}/{SPEC}" else None
