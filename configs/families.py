"""A family of classes: the members of the project, and those of Python files that a user loads.

Members are in packages above this one, for example sensors, which need rays and motion. They are therefore imported by
name when they are first needed.
"""

import importlib
import inspect
import linecache
import os
import re
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum
from functools import cache, cached_property
from hashlib import sha256
from importlib.abc import InspectLoader
from importlib.util import decode_source, module_from_spec, spec_from_file_location
from pathlib import Path
from types import CodeType, GenericAlias, MappingProxyType, ModuleType
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from pydantic import Field, create_model

from configs.schema.base import Section, absent
from symolo.core.errors import InputError, nearest
from symolo.core.files.plain_files import FileKind, UnsafeFileError, read_named_file


class Named(Protocol):
    """A class that has a name, by which configs refer to it."""

    name: ClassVar[str]


Member = TypeVar("Member", bound=Named)


class _TextLoader(InspectLoader):
    """Loader of a file whose content has been read.

    Python's own one may execute compiled code of an earlier content, if the file has the same time of change and size.
    """

    def __init__(self, file: Path, text: bytes) -> None:
        self._file = file
        self._text = text

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return self.source_to_code(self._text, str(self._file))

    def get_source(self, fullname: str) -> str:
        del fullname
        return decode_source(self._text)


@dataclass(frozen=True)
class UserFile(Generic[Member]):
    """A file of the user that was loaded."""

    member: type[Member]
    path: Path
    text: bytes
    """Content that was executed; the file may have changed since."""

    @property
    def sha256(self) -> str:
        return sha256(self.text).hexdigest()


@dataclass(frozen=True, eq=False)
class Family(Generic[Member]):
    """Classes that derive from one base class, one in each module or file."""

    noun: str
    """Name of a member in messages, for example `effect`."""
    base: type[Member]
    table: str
    """Name of the tuple in each package that names the package's modules, for example `EFFECTS`."""
    packages: tuple[str, ...]
    check: Callable[[type[Member], str], None]
    """Function of a class and its place, which raises InputError for a class that is not complete."""
    _loaded: dict[Path, UserFile[Member]] = field(default_factory=dict)
    """Files outside the project, in the order of loading."""

    def classes(self) -> tuple[type[Member], ...]:
        """Return all members in the order of the tables; those of loaded files come last."""
        return (*self._shipped, *(file.member for file in self._loaded.values()))

    def by_name(self) -> Mapping[str, type[Member]]:
        """Return all members by their names."""
        return _by_name(self.classes())

    def named(self, name: str) -> type[Member]:
        """Return a member by its name, which the user gave as an argument.

        Raises:
            InputError: There is none.
        """
        if (member := self.by_name().get(name)) is not None:
            return member
        cure = (
            f"`symolo {self.noun} list` lists all; name your own file before the command: symolo --{self.noun}-file"
            " FILE ..."
        )
        raise InputError("NAME", got=name, nearest=nearest(name, self.by_name()), cure=cure)

    @property
    def shipped(self) -> tuple[type[Member], ...]:
        """Members of the project alone."""
        return self._shipped

    @property
    def files(self) -> Mapping[str, UserFile[Member]]:
        """Files that were loaded, by the names of their members."""
        return {file.member.name: file for file in self._loaded.values()}

    @property
    def variable(self) -> str:
        """Environment variable that names files to be loaded, for example `SYMOLO_SENSOR_FILES`."""
        return f"SYMOLO_{self.noun.upper()}_FILES"

    def load(self, path: str | Path) -> type[Member]:
        """Add the member of a Python file.

        A file that is loaded already changes nothing; if its content has changed since, the new one takes its place.

        Raises:
            InputError: There is no such file, it cannot be executed, or its class is not complete.
        """
        file = Path(path).resolve()
        if not file.is_file():
            allowed = f"a Python file with one {self.noun}"
            raise InputError(f"{self.noun} file: no such file", got=str(path), allowed=allowed)
        try:
            text = read_named_file(file, FileKind.CODE)
        except UnsafeFileError:
            raise
        except OSError as error:
            raise InputError(f"{self.noun} file: cannot be read: {error.strerror}", where=str(path)) from None
        same = next((known for known in self._loaded.values() if known.text == text), None)
        if same is not None:
            return same.member
        member = self._only_member(self._executed(file, text), place_of)
        others = (*self._shipped, *(known.member for known in self._loaded.values() if known.path != file))
        if member.name in {other.name for other in others}:
            cure = "give the class another name"
            raise InputError(f"{self.noun} {member.name}: the name is taken", where=place_of(member), cure=cure)
        if file in self._loaded:
            self.unload(file)
        self._loaded[file] = UserFile(member, file, text)
        return member

    def executed(self, file: Path, text: bytes) -> type[Member]:
        """Return the member of a text that this program wrote itself, without adding it to the family.

        Args:
            file: Path for messages, in which the name gets an ending; nothing is read from it.
            text: Python code.

        Raises:
            InputError: Its class is not complete.
        """
        # Messages have the line of a class, and Python remembers the lines of a file that it saw first.
        renamed = file.with_stem(f"{file.stem}_{sha256(text).hexdigest()[:8]}")
        module = self._executed(renamed, text)
        try:
            return self._only_member(module, place_of)
        finally:
            del sys.modules[module.__name__]
            linecache.cache.pop(str(renamed), None)

    @contextmanager
    def holding(self, member: type[Member], file: Path, text: bytes) -> Iterator[None]:
        """Have one more member, as if it came from a file of the user, until the context ends."""
        self._loaded[file] = UserFile(member, file, text)
        try:
            yield
        finally:
            del self._loaded[file]

    def unload(self, path: str | Path) -> None:
        """Forget the member of a file that was loaded."""
        sys.modules.pop(self._loaded.pop(Path(path).resolve()).member.__module__, None)

    def fault_of(self, error: Exception) -> InputError | None:
        """Return the message for an error that code of a loaded file led to; None where no such code was under way."""
        for file in self._loaded.values():
            if call := last_call(error, file.path):
                what = f"{self.noun} file: in {call.name}: {type(error).__name__}: {error}"
                return InputError(what, where=f"{file.path}:{call.lineno}")
        return None

    def load_from_environment(self) -> None:
        """Load the files that the environment variable names.

        Raises:
            InputError: As for `load`.
        """
        for path in os.environ.get(self.variable, "").split(os.pathsep):
            if path:
                self.load(path)

    def environment(self) -> dict[str, str]:
        """Return the environment variable with which another process loads the same files."""
        return {self.variable: os.pathsep.join(map(str, self._loaded))} if self._loaded else {}

    @cached_property
    def _shipped(self) -> tuple[type[Member], ...]:
        return tuple(
            self._only_member(importlib.import_module(f"{package}.{name}"), _module_of)
            for package in self.packages
            for name in getattr(importlib.import_module(package), self.table)
        )

    def _executed(self, file: Path, text: bytes) -> ModuleType:
        name = f"{self.noun}_file_{file.stem}_{sha256(str(file).encode() + text).hexdigest()[:8]}"
        spec = spec_from_file_location(name, file, loader=_TextLoader(file, text))
        if spec is None or spec.loader is None or file.suffix != ".py":
            raise InputError(f"{self.noun} file", got=str(file), allowed="a Python file, which ends in .py")
        module = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except (Exception, SystemExit) as error:  # a user's file may raise whatever it likes
            del sys.modules[name]
            call = last_call(error, file)
            what, line = str(error), call.lineno if call else None
            if isinstance(error, SyntaxError) and error.filename == str(file):
                what, line = error.msg, error.lineno
            where = f"{file}:{line}" if line else str(file)
            allowed, close = _members_instead(error)
            what = f"{self.noun} file: {type(error).__name__}: {what}"
            raise InputError(what, where=where, allowed=", ".join(allowed), nearest=close) from error
        return module

    def _only_member(self, module: ModuleType, place: Callable[[type], str]) -> type[Member]:
        """Return the member that a module defines, after the check that it is complete; `place` is for messages."""
        classes = [
            value
            for value in vars(module).values()
            if isinstance(value, type)
            and not isinstance(value, GenericAlias)  # which Python 3.10 counts as a class
            and issubclass(value, self.base)
            and value.__module__ == module.__name__
        ]
        if len(classes) != 1:
            names = ", ".join(member.__name__ for member in classes) or "none"
            where = place(classes[1]) if classes else str(module.__file__)
            allowed = f"one class that derives from {self.base.__name__}"
            raise InputError(f"{self.noun} file", where=where, got=names, allowed=allowed)
        self.check(classes[0], place(classes[0]))
        return classes[0]


def last_call(error: BaseException, file: str | Path) -> traceback.FrameSummary | None:
    """Return function and line of a file that were under way at an error, the last one; None where none was."""
    calls = [call for call in traceback.extract_tb(error.__traceback__) if call.filename == str(file)]
    return calls[-1] if calls else None


def _members_instead(error: BaseException) -> tuple[tuple[str, ...], str]:
    """Return the members of the enumeration in which a name was not found, and the nearest; none for other errors."""
    if not isinstance(error, AttributeError):
        return (), ""
    kind = error.obj
    if not (isinstance(kind, type) and issubclass(kind, Enum)):
        return (), ""
    members = tuple(f"{kind.__name__}.{name}" for name in kind.__members__)
    return members, nearest(f"{kind.__name__}.{error.name}", members)


def _module_of(member: type) -> str:
    return str(sys.modules[member.__module__].__file__)


def place_of(member: type) -> str:
    """Return file and line of a class."""
    file = _module_of(member)
    try:
        linecache.checkcache(file)
        return f"{file}:{inspect.getsourcelines(member)[1]}"
    except (OSError, TypeError):
        return file


def name_in_lower_case(member: type) -> str:
    """Return the name of a class in lower case with underscores: `SupplySag` is `supply_sag`."""
    return re.sub(r"(?<=.)(?=[A-Z])", "_", member.__name__).lower()


@cache
def _by_name(classes: tuple[type[Member], ...]) -> Mapping[str, type[Member]]:
    return MappingProxyType({member.name: member for member in classes})


@cache
def optional_sections(name: str, sections: tuple[tuple[str, type[Section]], ...]) -> type[Section]:
    """Return a section in which each of these sections is optional, under its key."""
    fields: dict[str, Any] = {key: (section | None, Field(default_factory=absent)) for key, section in sections}
    return create_model(name, __base__=Section, **fields)
