"""What a process changes below a folder, in the order of its calls and with every byte, as a disk model replays it."""

import base64
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from file_operations import FileOperations

CHANGES = {"mkdir", "rmdir", "unlink", "remove", "rename", "replace"}


@dataclass
class DiskRecorder(FileOperations):
    """Notes what was done, where `FileOperations` notes what is asked for.

    `noted` holds `["create" | "mkdir" | "unlink" | "rmdir" | "fsync", path]`, `["rename", old, new]`,
    `["write", path, offset, bytes in base64]` and `["truncate", path, size]`.
    """

    _turn: Any = field(default_factory=threading.RLock)
    """Threads change the disk one after the other, so that the order of the notes is that of the changes."""

    def _counted(self, name: str) -> Callable[..., Any]:
        real = self._real[name]

        def called(*arguments: Any, **options: Any) -> Any:
            with self._turn:
                base, first = options.get("dir_fd"), arguments[0] if arguments else "."
                folder = self.path_of(base)
                path = f"{folder}/{os.fsdecode(first)}" if folder else self.path_of(first) if base is None else ""
                returned = real(*arguments, **options)
                if path and name == "fsync":
                    self.noted.append(["fsync", path])
                elif path and name == "ftruncate":
                    self.noted.append(["truncate", path, arguments[1]])
                elif path and name in {"rename", "replace"}:
                    self.noted.append(["rename", path, self.path_of(arguments[1])])
                elif path and name in CHANGES:
                    self.noted.append(["unlink" if name == "remove" else name, path])
                elif path and name == "link":
                    raise NotImplementedError(name)
                return returned

        return called

    def _os_open(self, path: Any, flags: int, *arguments: Any, **options: Any) -> int:
        if not flags & os.O_CREAT or not self.path_of(path):
            return self._real["open"](path, flags, *arguments, **options)
        if flags & os.O_TRUNC or options.get("dir_fd") is not None:
            raise NotImplementedError(path)
        with self._turn:
            new = not os.path.lexists(path)
            descriptor = self._real["open"](path, flags, *arguments, **options)
            if new:
                self.noted.append(["create", self.path_of(path)])
        return descriptor

    def _os_read(self, descriptor: int, size: int) -> bytes:
        return self._real["read"](descriptor, size)

    def _os_write(self, descriptor: int, data: Any) -> int:
        path = self.path_of(descriptor)
        if not path:
            return self._real["write"](descriptor, data)
        with self._turn:
            written = self._real["write"](descriptor, data)
            end = os.lseek(descriptor, 0, os.SEEK_CUR)  # of a file that is appended to as well
            text = base64.b64encode(bytes(data)[:written]).decode()
            self.noted.append(["write", path, end - written, text])
        return written

    def _open(self, file: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
        if mode.strip("bt") != "r" and self.path_of(file) and not options.get("opener"):  # of a file without a name
            raise NotImplementedError(f"{file} is opened with mode {mode}, beside atomic_files")
        return self._real_open(file, mode, *arguments, **options)
