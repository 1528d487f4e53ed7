"""Python's file operations below one folder, counted, noted, and made to fail at one of them as a bad disk would."""

import builtins
import io
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

BY_PATH = ("mkdir", "rmdir", "unlink", "remove", "rename", "replace", "link", "scandir", "listdir")
BY_DESCRIPTOR = ("fsync", "ftruncate")


@dataclass
class FileOperations:
    """What a process does to files below `root`; `install` puts it between the process and the system, for good.

    Faults come to what goes through `os` and `open`. A C library that opens files of its own is not seen.
    """

    root: str
    at: int = 0
    """Number of the operation that fails, from 1; 0 for none."""
    error: int = 0
    """What it fails with: an error number or, less than 0, a signal that the process gets. Of a write, half is done."""
    count: int = 0
    noted: list[list[str]] = field(default_factory=list)
    """Of each operation, its name and path as given or as its descriptor leads to."""
    _real: dict[str, Callable[..., Any]] = field(default_factory=dict)
    _real_open: Callable[..., Any] = io.open

    def install(self) -> None:
        for name in (*BY_PATH, *BY_DESCRIPTOR, "open", "read", "write"):
            self._real[name] = getattr(os, name)
        for name in (*BY_PATH, *BY_DESCRIPTOR):
            setattr(os, name, self._counted(name))
        os.open, os.read, os.write = self._os_open, self._os_read, self._os_write
        builtins.open = io.open = self._open

    def step(self, name: str, path: str, half: Callable[[], object] | None = None) -> None:
        """Count one operation, and fail where it is its turn; `half` does some of what it would have done."""
        self.count += 1
        self.noted.append([name, path])
        if self.count == self.at:
            if half is not None:
                half()
            if self.error < 0:
                os.kill(os.getpid(), -self.error)
                return
            raise OSError(self.error, os.strerror(self.error), path)

    def path_of(self, thing: object) -> str:
        """Where a path or descriptor leads, if it is below `root`; else nothing."""
        if isinstance(thing, int):
            try:
                path = os.readlink(f"/proc/self/fd/{thing}")  # noqa: PTH115 - pathlib may be what is counted
            except OSError:
                return ""
        elif isinstance(thing, str | bytes | os.PathLike):
            path = os.path.abspath(os.fsdecode(thing))  # noqa: PTH100 - as above
        else:
            return ""
        return path if path.startswith(self.root + "/") else ""

    def _counted(self, name: str) -> Callable[..., Any]:
        real = self._real[name]

        def called(*arguments: Any, **options: Any) -> Any:
            base = options.get("dir_fd", options.get("src_dir_fd"))
            first = arguments[0] if arguments else "."
            path = f"{self.path_of(base)}/{first}" if base is not None and self.path_of(base) else self.path_of(first)
            if path:
                self.step(name, path if name not in {"rename", "replace"} else f"{path} {os.fspath(arguments[1])}")
            return real(*arguments, **options)

        return called

    def _os_open(self, path: Any, flags: int, *arguments: Any, **options: Any) -> int:
        base = options.get("dir_fd")
        found = self.path_of(path) if base is None else f"{self.path_of(base)}/{path}" if self.path_of(base) else ""
        if found:
            self.step("create" if flags & os.O_CREAT else "open", found)
        return self._real["open"](path, flags, *arguments, **options)

    def _os_read(self, descriptor: int, size: int) -> bytes:
        if path := self.path_of(descriptor):
            self.step("read", path)
        return self._real["read"](descriptor, size)

    def _os_write(self, descriptor: int, data: Any) -> int:
        if path := self.path_of(descriptor):
            self.step("write", path, lambda: self._real["write"](descriptor, bytes(data)[: len(data) // 2]))
        return self._real["write"](descriptor, data)

    def _open(self, file: Any, mode: str = "r", buffering: int = -1, *arguments: Any, **options: Any) -> Any:
        path = self.path_of(file)
        if not path or options.get("opener") or isinstance(file, int):
            return self._real_open(file, mode, buffering, *arguments, **options)
        self.step("open" if mode.strip("bt") == "r" else "create", path)
        raw = _Raw(self, path, os.fspath(file), mode.replace("b", "").replace("t", ""))
        if buffering == 0:
            return raw
        buffer = io.BufferedRandom(raw) if "+" in mode else io.BufferedReader(raw) if raw.readable() else None
        buffer = buffer or io.BufferedWriter(raw)
        return buffer if "b" in mode else io.TextIOWrapper(buffer, *arguments, **options)


class _Raw(io.FileIO):
    """A file whose every read and write from and to the system counts."""

    def __init__(self, operations: FileOperations, path: str, file: str, mode: str) -> None:
        super().__init__(file, mode)
        self._operations, self._path = operations, path

    def readinto(self, buffer: Any) -> int | None:
        self._operations.step("read", self._path)
        return super().readinto(buffer)

    def readall(self) -> bytes | None:
        self._operations.step("read", self._path)
        return super().readall()

    def write(self, data: Any) -> int | None:
        whole = bytes(data)
        self._operations.step("write", self._path, lambda: super(_Raw, self).write(whole[: len(whole) // 2]))
        return super().write(whole)


def below(folder: Path) -> str:
    """`root` for a folder."""
    return str(folder.resolve())
