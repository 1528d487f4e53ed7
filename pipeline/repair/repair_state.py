"""The files of a release that are still to be restored. A file is put in place only with the right SHA-256."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from blender_scenes.render.devices import GPU_KINDS, DeviceKind
from pipeline.run_folder.workspace import Workspace
from symolo.core.files.atomic_files import make_folder, move, remove_file, remove_folder, write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report
from symolo.verification.inventory import LISTS, Inventory

MAX_BYTES = 1 << 16
"""Largest size [byte] of a file in which a single wrong bit is searched for. The time grows with the square of the
size; it is 10 s for this size."""

RUN_PARTS = 2
"""Number of parts of the folder of a run: route and test."""


@dataclass(frozen=True)
class RepairTools:
    """The tools that make files again."""

    scratch: Path
    """Temporary folder, removed at the end."""
    workers: int
    """Number of child processes at a time."""
    report: Report
    devices: Mapping[str, DeviceKind]
    """Device that rendered each run."""
    difference: str
    """Differences between this machine and that of the release, as text."""

    def excuse(self, run: str) -> str:
        """Return why the files of a run may have other bytes when they are made again."""
        device = self.devices.get(run, "CPU")
        where = "" if device == "CPU" else f" on {device}, which does not promise equal bytes,"
        return f"made again{where} the file has different bytes; {self.difference}"


@dataclass
class RepairState:
    """The state of a repair."""

    workspace: Workspace
    inventory: Inventory
    on_repaired: Callable[[str], None]
    """Called with a line for each file that is restored."""
    wanted: dict[str, str] = field(default_factory=dict)
    """SHA-256 by path of each file that is still to be restored."""
    tried: dict[str, str] = field(default_factory=dict)
    """Reason by path why the last attempt failed."""

    @classmethod
    def from_inventory(
        cls, workspace: Workspace, inventory: Inventory, on_repaired: Callable[[str], None]
    ) -> "RepairState":
        expected = inventory.expected
        state = cls(workspace, inventory, on_repaired)
        for name in sorted(inventory.damaged - {*LISTS}):
            parts = PurePosixPath(name).parts
            if name.startswith("/") or ".." in parts or parts[0].startswith("."):
                state.tried[name] = "its name leads out of the release"
            else:
                state.wanted[name] = expected[name]
        return state

    @property
    def out(self) -> Path:
        return self.workspace.out

    def runs(self) -> dict[str, set[str]]:
        """Return the runs with damaged files, and the paths of these in the run."""
        runs: dict[str, set[str]] = {}
        for name in self.wanted:
            parts = name.split("/", RUN_PARTS)
            if len(parts) > RUN_PARTS:
                runs.setdefault("/".join(parts[:RUN_PARTS]), set()).add(parts[RUN_PARTS])
        return runs

    def read(self, name: str) -> bytes | None:
        """Return the content of a released file; None while it is damaged."""
        if name in self.wanted or name not in self.inventory.expected:
            return None
        try:
            data = read_file(self.out / name, FileKind.ANY)
        except OSError:
            return None
        return data if hashlib.sha256(data).hexdigest() == self.inventory.expected[name] else None

    def put(self, name: str, data: bytes, how: str, otherwise: str = "") -> bool:
        """Put the file in place if it is the released one; `otherwise` is the reason to note if it is not."""
        if name not in self.wanted:
            return False
        if hashlib.sha256(data).hexdigest() != self.wanted[name]:
            if otherwise:
                self.tried[name] = otherwise
            return False
        if not self.write(name, data, how):
            return False
        del self.wanted[name]
        return True

    def write(self, name: str, data: bytes, how: str) -> bool:
        """Write a file of the release, and note the reason where that is not possible."""
        try:
            self._make_parents(name)
            write_file(self.out / name, data)
        except OSError as error:
            self.tried[name] = f"cannot be written: {error.strerror}"
            return False
        self.on_repaired(f"repaired: {name}: {how}")
        return True

    def take_over(self, place: str, name: str) -> None:
        """Give an extra file, which holds the content of a damaged one, the name of that.

        Raises:
            OSError: The disk refuses.
        """
        self._make_parents(name)
        move(self.out / place, self.out / name)

    def _make_parents(self, name: str) -> None:
        """Make the folders of a file, and remove links in their place, which would lead out of the release.

        An empty folder in the place of the file itself is removed as well.
        """
        for parent in reversed(PurePosixPath(name).parents[:-1]):
            place = self.out / parent
            if place.is_symlink() or (place.exists() and not place.is_dir()):
                remove_file(place)
            make_folder(place)
        place = self.out / name
        if place.is_dir() and not place.is_symlink() and not any(place.iterdir()):
            remove_folder(place)


def recorded_device(name: str) -> DeviceKind:
    """Return the device that metadata.json names; the processor for any name that is not known."""
    kinds: dict[str, DeviceKind] = {kind: kind for kind in GPU_KINDS}
    return kinds.get(name, "CPU")


def with_one_bit_flipped(data: bytes, digest: str) -> bytes | None:
    """Return the content with this SHA-256 that differs in a single bit; None if there is none or the file is too
    large.
    """
    if len(data) > MAX_BYTES:
        return None
    # The hash of the bytes before the flipped one is kept, so that only the rest is hashed for each attempt.
    before = hashlib.sha256()
    for i, byte in enumerate(data):
        for bit in range(8):
            tail = bytes((byte ^ (1 << bit),)) + data[i + 1 :]
            attempt = before.copy()
            attempt.update(tail)
            if attempt.hexdigest() == digest:
                return data[:i] + tail
        before.update(data[i : i + 1])
    return None
