"""Copies of damaged files elsewhere: under another name in the release, or in the hidden stages."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from pipeline.repair.repair_state import RUN_PARTS, RepairState
from pipeline.stages.assemble import KEPT_METADATA, SIDE
from pipeline.stages.render import IMAGES
from pipeline.stages.simulate_runs import SPEC
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.documents.metadata import METADATA
from symolo.dataset.layout import ANNOTATIONS


def put_back(state: RepairState, scratch: Path) -> set[str]:
    """Restore files that are in the release under another name, and return those names that are extra files."""
    sources: dict[str, str] = {}
    for name, digest in state.wanted.items():
        if places := state.inventory.places.get(digest, ()):
            sources[name] = next((place for place in places if place in state.inventory.extra), places[0])
    aside: dict[str, Path] = {}
    for place in {place for place in sources.values() if place in state.wanted}:
        # It will be overwritten, such as one of two files that were swapped.
        aside[place] = scratch / state.inventory.files.digests[place]
        make_folder(scratch)
        write_file(aside[place], read_file(state.out / place, FileKind.ANY))
    moved = set()
    for name, place in sources.items():
        with contextlib.suppress(OSError):
            if state.put(
                name, read_file(aside.get(place, state.out / place), FileKind.ANY), f"its content lay in {place}"
            ):
                moved |= {place} & state.inventory.extra
    return moved


def take_from_stages(state: RepairState) -> None:
    """Restore files of which the stages have a copy."""
    for name in list(state.wanted):
        for path in _kept(state, name):
            with contextlib.suppress(OSError):
                if state.put(name, read_file(path, FileKind.ANY), "from the stages"):
                    break


def _kept(state: RepairState, name: str) -> Iterator[Path]:
    if name == METADATA:
        yield state.out / KEPT_METADATA
    parts = name.split("/", RUN_PARTS)
    if len(parts) <= RUN_PARTS:
        return
    run, inner = "/".join(parts[:RUN_PARTS]), parts[RUN_PARTS]
    if inner.startswith(f"{IMAGES}/"):
        yield state.workspace.render(run).path / inner
    elif inner.startswith(f"{ANNOTATIONS}/"):
        yield state.workspace.annotate(run).path / inner
    elif inner == f"{SIDE}/{SPEC}":
        yield state.workspace.simulate(run).path / SPEC
