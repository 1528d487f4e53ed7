"""A disk as a loss of power may leave it: what was flushed, and of the rest any part.

Names and contents are apart. The bytes of a file are there for good once the file is flushed; that it has its name,
once its folder is. A renaming from one folder to another is so once both are; it is done wholly or not at all. This is
what POSIX promises, which is less than any file system keeps. What goes wrong with less: T. S. Pillai et al., All File
Systems Are Not Created Equal, OSDI 2014.
"""

import base64
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

import numpy as np

ROOT = 0
"""Number of the folder that everything lies below; it is there for good."""

Tree = dict[str, bytes | None]
"""Content of each file by its path; None of a folder."""
Fate = Callable[[bytes, bytes, np.random.Generator], bytes]
"""What becomes of a file that was not flushed: from its content at the last flush and the one it has now."""


def tree_below(folder: Path) -> Tree:
    """Return what is on a real disk."""
    paths = sorted(folder.rglob("*"))
    return {path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else None for path in paths}


def write_tree(tree: Tree, folder: Path) -> None:
    """Put it on a real disk, in an empty folder."""
    for path, content in tree.items():
        if content is None:
            (folder / path).mkdir(parents=True, exist_ok=True)
        else:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(content)


@dataclass
class Naming:
    """A creation, renaming or removal that the disk may still lose."""

    file: int
    """Number of the file or folder."""
    names: list[tuple[int, str, int | None]]
    """Folder, name, and the file that has the name afterwards."""
    waits_for: set[int]
    """Folders that are still to be flushed."""

    def touches(self, other: "Naming") -> bool:
        """Return whether the two cannot change places."""
        mine, theirs = ({(folder, name) for folder, name, _ in one.names} for one in (self, other))
        return self.file == other.file or bool(mine & theirs)

    def apply(self, folders: dict[int, dict[str, int]]) -> None:
        for folder, name, file in self.names:
            if file is None:
                folders[folder].pop(name, None)
            else:
                folders[folder][name] = file


@dataclass
class Disk:
    """Begins with a tree that is there for good."""

    root: str
    """Absolute path of the folder."""
    begun: Tree
    _folders: dict[int, dict[str, int]] = field(default_factory=lambda: {ROOT: {}})
    """Names in each folder, as the process sees them."""
    _flushed_folders: dict[int, dict[str, int]] = field(default_factory=lambda: {ROOT: {}})
    _files: dict[int, bytes] = field(default_factory=dict)
    _flushed_files: dict[int, bytes] = field(default_factory=dict)
    _namings: list[Naming] = field(default_factory=list)

    def __post_init__(self) -> None:
        for path, content in self.begun.items():
            self.do(["mkdir" if content is None else "create", f"{self.root}/{path}"])
            if content:
                self._files[self._find(f"{self.root}/{path}")] = content
        for naming in self._namings:
            naming.apply(self._flushed_folders)
        self._namings.clear()
        self._flushed_files = dict(self._files)

    def do(self, operation: Sequence) -> None:
        """Apply one operation of a `DiskRecorder`."""
        kind, path, *details = operation
        if kind in {"create", "mkdir"}:
            folder, name = self._place(path)
            number = len(self._folders) + len(self._files)
            if kind == "mkdir":
                self._folders[number], self._flushed_folders[number] = {}, {}
            else:
                self._files[number] = self._flushed_files[number] = b""
            self._name(number, [(folder, name, number)])
        elif kind in {"unlink", "rmdir"}:
            self._name(self._find(path), [(*self._place(path), None)])
        elif kind == "rename":
            file = self._find(path)
            self._name(file, [(*self._place(path), None), (*self._place(details[0]), file)])
        elif path == self.root or self._has(path):  # not a file that is open still, and has no name any more
            self._change(kind, self._find(path), details)

    def _change(self, kind: str, file: int, details: list) -> None:
        if kind == "write":
            offset, data = details[0], base64.b64decode(details[1])
            before = self._files[file].ljust(offset, b"\0")
            self._files[file] = before[:offset] + data + before[offset + len(data) :]
        elif kind == "truncate":
            self._files[file] = self._files[file][: details[0]].ljust(details[0], b"\0")
        elif file in self._files:
            self._flushed_files[file] = self._files[file]
        else:
            self._flush_folder(file)

    def _flush_folder(self, folder: int) -> None:
        done: list[Naming] = []
        for naming in reversed(self._namings):
            naming.waits_for.discard(folder)
            # What came before it, and cannot be without it, is there as well.
            if not naming.waits_for or any(naming.touches(later) for later in done):
                done.append(naming)
        for naming in reversed(done):
            naming.apply(self._flushed_folders)
        self._namings = [naming for naming in self._namings if all(naming is not one for one in done)]

    def _name(self, file: int, names: list[tuple[int, str, int | None]]) -> None:
        naming = Naming(file, names, {folder for folder, _, _ in names})
        naming.apply(self._folders)
        self._namings.append(naming)

    def _place(self, path: str) -> tuple[int, str]:
        return self._find(str(PurePosixPath(path).parent)), PurePosixPath(path).name

    def _find(self, path: str) -> int:
        number = ROOT
        for name in PurePosixPath(path).relative_to(self.root).parts:
            number = self._folders[number][name]
        return number

    def _has(self, path: str) -> bool:
        try:
            self._find(path)
        except KeyError:
            return False
        return True

    @property
    def unflushed_namings(self) -> int:
        return len(self._namings)

    def seen(self) -> Tree:
        """Return what the process sees, and a killed one leaves."""
        return _tree(self._folders, self._files)

    def after_power_loss(self, done: Sequence[bool], fate: Fate, rng: np.random.Generator) -> Tree:
        """Return what is on the disk when the power comes back.

        Args:
            done: Of each unflushed naming, in order, whether the disk has done it; those that it cannot do without
                are done as well.
            fate: Of each file that is not flushed.
            rng: Source of what `fate` draws.
        """
        folders = {number: dict(names) for number, names in self._flushed_folders.items()}
        chosen: list[Naming] = []
        for wanted, naming in reversed(list(zip(done, self._namings, strict=True))):
            if wanted or any(naming.touches(later) for later in chosen):
                chosen.append(naming)
        for naming in reversed(chosen):
            naming.apply(folders)
        files = {
            number: now if now == self._flushed_files[number] else fate(self._flushed_files[number], now, rng)
            for number, now in self._files.items()
        }
        return _tree(folders, files)


def _tree(folders: dict[int, dict[str, int]], files: dict[int, bytes]) -> Tree:
    tree: Tree = {}

    def walk(folder: int, above: str) -> None:
        for name, number in sorted(folders[folder].items()):
            tree[above + name] = files.get(number)
            if number in folders:
                walk(number, f"{above}{name}/")

    walk(ROOT, "")
    return tree


def lost(flushed: bytes, _now: bytes, _rng: np.random.Generator) -> bytes:
    return flushed


def whole(_flushed: bytes, now: bytes, _rng: np.random.Generator) -> bytes:
    return now


def zeros(flushed: bytes, now: bytes, _rng: np.random.Generator) -> bytes:
    """The size is on the disk, the blocks are not."""
    return flushed[: len(now)].ljust(len(now), b"\0")


def torn(flushed: bytes, now: bytes, rng: np.random.Generator) -> bytes:
    """The new bytes up to a random one."""
    low, high = sorted((len(flushed), len(now)))
    return now[: int(rng.integers(low, high + 1))]


def holed(flushed: bytes, now: bytes, rng: np.random.Generator) -> bytes:
    """The new bytes from a random one on, and zeros before it."""
    low, high = sorted((len(flushed), len(now)))
    start = int(rng.integers(low, high + 1))
    return flushed[:start].ljust(start, b"\0") + now[start:]


FATES = (lost, whole, zeros, torn, holed)


def any_of_them(flushed: bytes, now: bytes, rng: np.random.Generator) -> bytes:
    return FATES[int(rng.integers(len(FATES)))](flushed, now, rng)


@dataclass(frozen=True)
class Cut:
    """The disk after a loss of power."""

    what: str
    """After which operation, and what became of the unflushed."""
    tree: Tree


def cuts(root: str, begun: Tree, operations: Sequence[Sequence], seed: int) -> Iterator[Cut]:
    """Cut the power after every operation, in several ways; each different disk once.

    Namings are lost all, done all, done up to a random one in their order, which is what file systems with a journal
    leave, and done in a random choice, which POSIX permits.
    """
    disk = Disk(root, begun)
    known: set[frozenset[tuple[str, bytes | None]]] = set()
    for number, operation in enumerate([["begin", root], *operations]):
        if number > 0:
            disk.do(operation)
        rng = np.random.Generator(np.random.PCG64([seed, number]))
        count = disk.unflushed_namings
        some = int(rng.integers(count + 1))
        ways: list[tuple[str, list[bool], Fate]] = [
            ("only what is flushed", [False] * count, lost),
            ("every name, no content", [True] * count, lost),
            ("every name, zeros", [True] * count, zeros),
            ("every name, torn", [True] * count, torn),
            ("names in order, torn", [place < some for place in range(count)], torn),
            ("any names, anything", (rng.random(count) < 0.5).tolist(), any_of_them),
        ]
        for what, done, fate in ways:
            tree = disk.after_power_loss(done, fate, rng)
            if (content := frozenset(tree.items())) not in known:
                known.add(content)
                yield Cut(f"{number} of {len(operations)}: {operation[0]} {operation[1]}: {what}", tree)
