"""Comparison of the files of a release with its checksums, and which of the two to believe where they differ."""

import contextlib
import hashlib
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from pydantic import ValidationError

from symolo.core.errors import InputError
from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.paths import folders_of
from symolo.core.files.plain_files import FileKind, UnsafeFileError, check_tree, read_file
from symolo.dataset.bag import BAG_INFO
from symolo.dataset.folder_kind import Done, check_dataset
from symolo.dataset.layout import DONE, STAGES
from symolo.dataset.manifest import MANIFEST, SEALS, TAG_MANIFEST, manifest, read_manifest, tag_manifest
from symolo.verification.findings import Finding

LISTS = (MANIFEST, TAG_MANIFEST)

MAX_LINES = 3000
"""Largest manifest in which a single wrong line is searched; the time grows with the square of the lines."""


@dataclass(frozen=True)
class Files:
    """The files of a folder, without the hidden stages."""

    digests: Mapping[str, str]
    """SHA-256 by path."""
    strange: Mapping[str, str]
    """Problem of each entry that cannot be hashed, by path: no regular file, or the disk does not give it."""
    empty_folders: frozenset[str] = frozenset()

    @classmethod
    def from_folder(cls, root: Path) -> "Files":
        digests: dict[str, str] = {}
        strange: dict[str, str] = {}

        def unreadable(error: OSError) -> None:
            strange[Path(str(error.filename)).relative_to(root).as_posix()] = f"cannot be read: {error.strerror}"

        entries, empty = _entries(root, unreadable)
        for name in sorted(entries, key=lambda name: name.split("/")):
            try:
                digests[name] = sha256_of(root / name, FileKind.ANY)
            except UnsafeFileError as error:
                strange[name] = error.problem
            except OSError as error:
                strange[name] = f"cannot be read: {error.strerror}"
        return cls(digests, strange, frozenset(empty))


def _entries(root: Path, unreadable: Callable[[OSError], None]) -> tuple[list[str], list[str]]:
    """Return the paths within a folder of all but folders, and those of empty folders; links are not followed."""
    entries, empty = [], []
    for place, folders, files in os.walk(root, onerror=unreadable):
        if place == str(root):
            within = ""
            folders[:] = [name for name in folders if name != STAGES]
        else:
            within = f"{Path(place).relative_to(root).as_posix()}/"
            empty += [] if folders or files else [within[:-1]]
        links = [name for name in folders if os.path.islink(f"{place}/{name}")]  # noqa: PTH114 - once for each folder
        entries += [within + name for name in (*files, *links)]
    return entries, empty


@dataclass(frozen=True)
class Inventory:
    """The files that are there, the files that should be there, and whether the latter are certain."""

    files: Files
    expected: Mapping[str, str]
    """SHA-256 by path of every file but the lists; empty if no list is readable."""
    trusted: bool
    """Whether `expected` is what was released: it has the checksum that was noted for it, or every file fits it."""
    list_findings: tuple[Finding, ...]
    """Faults of the lists themselves."""
    assembled: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 by path, as the hidden stages noted them when the runs were assembled."""

    @classmethod
    def from_folder(cls, root: Path) -> "Inventory":
        files = Files.from_folder(root)
        content = {name: digest for name, digest in files.digests.items() if name not in {*LISTS, *SEALS}}
        lists = {name: _read(root / name) if name in files.digests else None for name in LISTS}
        if MANIFEST in _parsed(lists[MANIFEST], None)[0] and MANIFEST not in _parsed(lists[TAG_MANIFEST], None)[0]:
            # Only the tag manifest names the manifest: the two were swapped, and neither has the bytes that it should.
            lists = {MANIFEST: lists[TAG_MANIFEST], TAG_MANIFEST: lists[MANIFEST]}
        noted = _parsed(lists[TAG_MANIFEST], None)[0].get(MANIFEST, "")
        moved = next((name for name, digest in content.items() if digest == noted), None)
        # The manifest itself where it lies under another name, as of a file that it was swapped with.
        elsewhere = _parsed(_read(root / moved), None)[0] if moved else {}
        return _judged(files, content, lists, elsewhere, _assembled(root))

    @classmethod
    def of_whole(cls, root: Path) -> "Inventory":
        """Return the inventory of an undamaged release.

        Raises:
            InputError: It is no dataset, or a damaged one; the message names the first such file.
        """
        check_dataset(root)
        inventory = cls.from_folder(root)
        if fault := next(inventory.findings(), None):
            cure = f"see `symolo verify {root}` and `symolo repair {root}`"
            raise InputError(f"is not as it was released: {fault}", where=str(root), cure=cure)
        return inventory

    @cached_property
    def damaged(self) -> frozenset[str]:
        """Files that are missing, changed or strange."""
        content = self.files.digests
        wrong = {name for name, digest in self.expected.items() if content.get(name) != digest}
        return frozenset(wrong | {finding.file for finding in self.list_findings} & {*LISTS})

    @cached_property
    def extra(self) -> frozenset[str]:
        """Files that no list names, and empty folders in which no list names a file."""
        empty = self.files.empty_folders - folders_of(self.expected) if self.files.empty_folders else ()
        there = {*self.files.digests, *self.files.strange, *empty}
        return frozenset(there - {*self.expected, *LISTS, *SEALS}) if self.expected else frozenset()

    @cached_property
    def meant(self) -> Mapping[str, tuple[str, ...]]:
        """Which files should hold a content, by SHA-256."""
        return _inverted(self.expected)

    @cached_property
    def places(self) -> Mapping[str, tuple[str, ...]]:
        """Files that hold a content now, by SHA-256."""
        return _inverted(self.files.digests)

    def findings(self) -> Iterator[Finding]:
        """Yield a finding for each file that is not as it was released."""
        yield from self.list_findings
        for name in sorted({*self.expected, *self.extra, *self.files.strange}):
            if name in self.files.strange:
                yield Finding(name, self.files.strange[name])
            elif name in self.extra and name in self.files.empty_folders:
                yield Finding(name, f"is an empty folder, and {MANIFEST} names no file in it")
            elif name in self.extra:
                yield Finding(name, f"is not named in {MANIFEST}{self._meant_as(name)}")
            elif name in self.damaged:
                yield Finding(name, self._difference(name))
        if self.trusted:
            for name in sorted(self.assembled.keys() & self.expected.keys()):
                if self.expected[name] != self.assembled[name]:
                    what = "fits its checksum, but is not what was assembled: both were edited"
                    yield Finding(name, what if name not in self.damaged else "its checksum is not that of the stages")

    def _difference(self, name: str) -> str:
        there = self.files.digests.get(name)
        copies = [place for place in self.places.get(self.expected[name], ()) if place != name]
        if there is None:
            moved = [place for place in copies if place in self.extra]
            return f"is missing; {MANIFEST} names it" + (f"; its content is now named {moved[0]}" if moved else "")
        changed = f"was changed: its SHA-256 is not that of {MANIFEST}"
        holds = [other for other in self.meant.get(there, ()) if other != name]
        swapped = [other for other in holds if other in copies]
        if swapped:
            return f"{changed}; it was swapped with {swapped[0]}"
        if holds:
            return f"{changed}; it holds what {holds[0]} should hold"
        if there == _EMPTY:
            return f"{changed}; it is empty"
        return changed + (f"; its content lies in {copies[0]}" if copies else "")

    def _meant_as(self, name: str) -> str:
        meant = self.meant.get(self.files.digests.get(name, ""), ())
        missing = [other for other in meant if other in self.damaged]
        if missing:
            return f"; it is what {missing[0]} should be"
        return f"; it is a copy of {meant[0]}" if meant else ""


def _inverted(digests: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    names: dict[str, list[str]] = {}
    for name, digest in digests.items():
        names.setdefault(digest, []).append(name)
    return {digest: tuple(held) for digest, held in names.items()}


_EMPTY = hashlib.sha256(b"").hexdigest()


def _judged(
    files: Files,
    content: Mapping[str, str],
    lists: Mapping[str, bytes | None],
    elsewhere: Mapping[str, str],
    assembled: Mapping[str, str],
) -> Inventory:
    """Return the inventory with the list of checksums that is to be believed.

    The tag manifest confirms the manifest; the files and the notes of the stages confirm both. A list of checksums with
    the SHA-256 that the tag manifest gives is the released one, wherever we took it from.
    """
    list_digests = {name: files.digests.get(name, "") for name in LISTS}
    listed, problem = _parsed(lists[MANIFEST], files.strange.get(MANIFEST))
    tags, tag_problem = _parsed(lists[TAG_MANIFEST], files.strange.get(TAG_MANIFEST))
    noted = tags.get(MANIFEST, "")
    if not tag_problem and (not noted or set(tags) - {MANIFEST, BAG_INFO}):
        tag_problem = f"does not name {MANIFEST} and {BAG_INFO} alone"
    for candidate in (listed, elsewhere, *_candidates(listed, content, assembled)) if noted else ():
        if candidate and hashlib.sha256(manifest(candidate)).hexdigest() == noted:
            problems = {MANIFEST: problem or _edited(listed, candidate), TAG_MANIFEST: tag_problem}
            return _with_lists(files, candidate, list_digests, assembled, problems)
    fits = bool(listed) and all(content.get(name) == digest for name, digest in listed.items())
    if fits:  # the manifest is what it was, so the list that does not name it is the one that changed
        return _with_lists(files, listed, list_digests, assembled, {MANIFEST: problem, TAG_MANIFEST: tag_problem})
    findings = [Finding(name, text) for name, text in ((MANIFEST, problem), (TAG_MANIFEST, tag_problem)) if text]
    if not findings:
        findings = [Finding(MANIFEST, f"was changed, or {TAG_MANIFEST} was: its SHA-256 is not the one noted there")]
    return Inventory(files, listed, trusted=False, list_findings=tuple(findings), assembled=assembled)


def _candidates(
    listed: Mapping[str, str], content: Mapping[str, str], assembled: Mapping[str, str]
) -> Iterator[dict[str, str]]:
    """Yield lists of checksums that may be the released one, for a manifest that is damaged."""
    yield dict(content)
    for names in ({*listed}, {*content}, {*listed} | {*assembled}):
        yield {name: assembled.get(name, content.get(name, listed.get(name, ""))) for name in names}
        yield {name: content[name] for name in names if name in content}
    if len({*listed, *content}) <= MAX_LINES:
        for name, digest in content.items():  # one line edited or removed, while other files are damaged too
            if listed.get(name) != digest:
                yield {**listed, name: digest}
        for whole in (listed, content):  # the latter with one file that was added, such as the manifest renamed
            for name in whole:
                yield {other: digest for other, digest in whole.items() if other != name}


def _with_lists(
    files: Files,
    expected: Mapping[str, str],
    list_digests: Mapping[str, str],
    assembled: Mapping[str, str],
    problems: Mapping[str, str],
) -> Inventory:
    """Return the inventory with the faults of the lists, whose bytes follow from the expected files."""
    findings = []
    texts = {MANIFEST: manifest(expected), TAG_MANIFEST: tag_manifest(expected)}
    for name, text in texts.items():
        if not list_digests[name]:
            findings.append(Finding(name, files.strange.get(name, "is missing")))
        elif list_digests[name] != hashlib.sha256(text).hexdigest():
            other = TAG_MANIFEST if name == MANIFEST else MANIFEST
            findings.append(Finding(name, problems[name] or f"was changed: it does not fit {other} and the files"))
    return Inventory(files, expected, trusted=True, list_findings=tuple(findings), assembled=assembled)


def _edited(listed: Mapping[str, str], released: Mapping[str, str]) -> str:
    """Return a text with the first line of the manifest that is not as it was released; empty if all are."""
    other = sorted(name for name in {*listed, *released} if listed.get(name) != released.get(name))
    more = f" and {len(other) - 1} more" if len(other) > 1 else ""
    return f"was changed: not as released is its entry for {other[0]}{more}" if other else ""


def _parsed(data: bytes | None, strange: str | None) -> tuple[dict[str, str], str]:
    """Return the list, or the part of it that can be read, and its fault."""
    if data is None:
        return {}, strange or "is missing"
    try:
        return read_manifest(data), "" if data else "is empty"
    except ValueError as error:
        lines: dict[str, str] = {}
        for line in data.splitlines():
            with contextlib.suppress(ValueError):
                lines |= read_manifest(line)
        return lines, str(error)


def _read(path: Path) -> bytes | None:
    try:
        return read_file(path, FileKind.CHECKSUMS)
    except OSError:
        return None


def _assembled(root: Path) -> dict[str, str]:
    """Return the checksums that `assemble` noted for each run; empty if the stages were deleted."""
    noted: dict[str, str] = {}
    stage = root / STAGES / "assemble"
    try:
        check_tree(root, f"{STAGES}/assemble")
    except UnsafeFileError:
        return noted
    for marker in sorted(stage.glob(f"*/*/{DONE}")):
        run = marker.parent.relative_to(stage).as_posix()
        try:
            files = Done.model_validate_json(read_file(marker, FileKind.CHECKSUMS)).files
        except (OSError, ValidationError):
            continue
        noted |= {f"{run}/{name}": digest for name, digest in files.items()}
    return noted
