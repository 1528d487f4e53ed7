"""What is still to be restored of a release, and the one way in which a file gets its place: with the right SHA-256."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from blender_scenes.render.devices import DeviceKind
from pipeline.run_folder.workspace import Workspace
from symolo.core.atomic_files import make_folder, remove_file, write_file
from symolo.core.progress import Report
from symolo.verification.inventory import LISTS, Inventory

MAX_BYTES = 1 << 16
"""Of a file in which a single wrong bit is looked for; the time goes by the square of its size, 10 s for this one."""

RUN_PARTS = 2
"""A run's folder is route and test."""


@dataclass(frozen=True)
class RepairTools:
    """What files are made again with."""

    scratch: Path
    """A folder that may be filled; it is removed in the end."""
    workers: int
    """Children at a time."""
    report: Report
    devices: Mapping[str, DeviceKind]
    """On what each run was rendered."""
    difference: str
    """What made the release and is not here."""

    def excuse(self, run: str) -> str:
        """Why files of a run that were made again may be other bytes."""
        device = self.devices.get(run, "CPU")
        where = "" if device == "CPU" else f" on {device}, which promises no equal bytes,"
        return f"made again{where} it is other bytes; {self.difference}"


@dataclass
class RepairState:
    """A repair under way."""

    workspace: Workspace
    inventory: Inventory
    tell: Callable[[str], None]
    """Where each file that is restored is said."""
    wanted: dict[str, str] = field(default_factory=dict)
    """SHA-256 of each file that is still to be restored, by path."""
    tried: dict[str, str] = field(default_factory=dict)
    """Why the last attempt at a file came to nothing."""

    @classmethod
    def of(cls, workspace: Workspace, inventory: Inventory, tell: Callable[[str], None]) -> "RepairState":
        expected = inventory.expected
        state = cls(workspace, inventory, tell)
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
        """Runs with damaged files, and those by their path in the run."""
        runs: dict[str, set[str]] = {}
        for name in self.wanted:
            parts = name.split("/", RUN_PARTS)
            if len(parts) > RUN_PARTS:
                runs.setdefault("/".join(parts[:RUN_PARTS]), set()).add(parts[RUN_PARTS])
        return runs

    def read(self, name: str) -> bytes | None:
        """The content of a released file, None while it is not the one that was released."""
        if name in self.wanted or name not in self.inventory.expected:
            return None
        try:
            data = (self.out / name).read_bytes()
        except OSError:
            return None
        return data if hashlib.sha256(data).hexdigest() == self.inventory.expected[name] else None

    def put(self, name: str, data: bytes, how: str, otherwise: str = "") -> bool:
        """Put the file in place where it is the one that was released; `otherwise` says why it may not be."""
        if name not in self.wanted:
            return False
        if hashlib.sha256(data).hexdigest() != self.wanted[name]:
            if otherwise:
                self.tried[name] = otherwise
            return False
        try:
            self._clear_the_way(name)
            write_file(self.out / name, data)
        except OSError as error:
            self.tried[name] = f"cannot be written: {error.strerror}"
            return False
        del self.wanted[name]
        self.tell(f"repaired: {name}: {how}")
        return True

    def _clear_the_way(self, name: str) -> None:
        """Make the folders of a file; a link in place of one would lead out of the release."""
        for parent in reversed(PurePosixPath(name).parents[:-1]):
            place = self.out / parent
            if place.is_symlink() or (place.exists() and not place.is_dir()):
                remove_file(place)
            make_folder(place)


def with_one_bit_less_wrong(data: bytes, digest: str) -> bytes | None:
    """The content with that SHA-256 that differs in a single bit, None where there is none or the file is too large."""
    if len(data) > MAX_BYTES:
        return None
    before = hashlib.sha256()
    for i, byte in enumerate(data):
        rest = data[i + 1 :]
        for bit in range(8):
            attempt = before.copy()
            attempt.update(bytes((byte ^ (1 << bit),)) + rest)
            if attempt.hexdigest() == digest:
                return data[:i] + bytes((byte ^ (1 << bit),)) + rest
        before.update(data[i : i + 1])
    return None
