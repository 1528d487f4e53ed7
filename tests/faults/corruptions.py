"""Random damage to a release: ten kinds, each of one thing, with the files that a report has to name."""

import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

LISTS = ("manifest-sha256.txt", "tagmanifest-sha256.txt")


@dataclasses.dataclass(frozen=True)
class Damage:
    """What was done, and to which files; a swap is of two, a renaming of the old name and the new one."""

    kind: str
    files: frozenset[str]


class Corrupter:
    """Damages a copy of a release, once, and mends it from the release itself."""

    def __init__(self, release: Path, copy: Path, seed: int) -> None:
        self.release, self.copy = release, copy
        shutil.copytree(release, copy, ignore=shutil.ignore_patterns(".stages"))
        self.names = sorted(path.relative_to(copy).as_posix() for path in copy.rglob("*") if path.is_file())
        self._rng = np.random.default_rng(seed)
        self._content = {name: (copy / name).read_bytes() for name in self.names}

    def damage(self, kind: str) -> Damage:
        return Damage(kind, frozenset(KINDS[kind](self)))

    def mend(self, damage: Damage) -> None:
        for name in damage.files:
            path = self.copy / name
            if name in self._content:
                path.write_bytes(self._content[name])
            else:
                path.unlink(missing_ok=True)

    def _any(self, names: list[str] | None = None) -> str:
        names = names or self.names
        return names[self._rng.integers(len(names))]

    def _rewritten(self, name: str, data: bytes) -> list[str]:
        assert data != self._content[name], "damage that changes nothing is none"
        (self.copy / name).write_bytes(data)
        return [name]

    def bit_flip(self) -> list[str]:
        name = self._any()
        data = bytearray(self._content[name])
        data[self._rng.integers(len(data))] ^= 1 << self._rng.integers(8)
        return self._rewritten(name, bytes(data))

    def truncation(self) -> list[str]:
        name = self._any()
        return self._rewritten(name, self._content[name][: self._rng.integers(len(self._content[name]))])

    def appended_byte(self) -> list[str]:
        name = self._any()
        return self._rewritten(name, self._content[name] + bytes([self._rng.integers(256)]))

    def emptied(self) -> list[str]:
        return self._rewritten(self._any(), b"")

    def removal(self) -> list[str]:
        name = self._any()
        (self.copy / name).unlink()
        return [name]

    def swap(self) -> list[str]:
        first = self._any()
        second = self._any([name for name in self.names if self._content[name] != self._content[first]])
        return self._rewritten(first, self._content[second]) + self._rewritten(second, self._content[first])

    def copied_over(self) -> list[str]:
        source = self._any()
        target = self._any([name for name in self.names if self._content[name] != self._content[source]])
        return self._rewritten(target, self._content[source])

    def extra_file(self) -> list[str]:
        folder = Path(self._any()).parent
        name = folder / f"{self._any(['notes', '.hidden', '000099', 'data', 'copy of'])}.{self._rng.integers(10**6)}"
        filler = self._content[self._any()] if self._rng.random() < 0.5 else self._rng.bytes(10)
        (self.copy / name).write_bytes(filler)
        return [name.as_posix()]

    def renamed(self) -> list[str]:
        name = self._any()
        new = f"{name}.{self._rng.integers(10**6)}"
        (self.copy / name).rename(self.copy / new)
        return [name, new]

    def edited_text(self) -> list[str]:
        """One digit of a table, a document or a list becomes another one."""
        name = self._any([name for name in self.names if not name.endswith(".jpg")])
        data = bytearray(self._content[name])
        digits = [i for i, byte in enumerate(data) if chr(byte).isdigit()]
        at = digits[self._rng.integers(len(digits))]
        data[at] = ord("0") + (data[at] - ord("0") + int(self._rng.integers(1, 10))) % 10
        return self._rewritten(name, bytes(data))

    def edited_list(self) -> list[str]:
        """A line of one of the lists of checksums is removed, doubled, of another file, or of another checksum."""
        name = self._any(list(LISTS))
        lines = self._content[name].decode().splitlines()
        at = int(self._rng.integers(len(lines)))
        edit = self._rng.integers(4)
        digest, _, file = lines[at].partition("  ")
        lines[at : at + 1] = [
            [],
            [lines[at], lines[at]],
            [f"{digest}  {file}x"],
            [f"{self._rng.bytes(32).hex()}  {file}"],
        ][edit]
        return self._rewritten(name, ("\n".join(lines) + "\n").encode())


KINDS: dict[str, Callable[[Corrupter], list[str]]] = {
    kind.__name__: kind
    for kind in (
        Corrupter.bit_flip,
        Corrupter.truncation,
        Corrupter.appended_byte,
        Corrupter.emptied,
        Corrupter.removal,
        Corrupter.swap,
        Corrupter.copied_over,
        Corrupter.extra_file,
        Corrupter.renamed,
        Corrupter.edited_text,
        Corrupter.edited_list,
    )
}
