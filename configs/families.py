"""A family of classes: the members of the project, and those of Python files that a user loads.

Members are in packages above this one, for example sensors, which need rays and motion. They are therefore imported by
name when they are first needed.
"""

import importlib
import os
import re
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import GenericAlias, MappingProxyType, ModuleType
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from pydantic import Field, create_model

from configs.schema.base import Section, absent
from symolo.core.errors import InputError


class Named(Protocol):
    """A class that has a name, by which configs refer to it."""

    name: ClassVar[str]


Member = TypeVar("Member", bound=Named)


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
    """Function of a class and its file, which raises InputError for a class that is not complete."""
    _loaded: dict[Path, type[Member]] = field(default_factory=dict)
    """Members of files outside the project, in the order of loading."""

    def classes(self) -> tuple[type[Member], ...]:
        """Return all members in the order of the tables; those of loaded files come last."""
        return (*self._shipped, *self._loaded.values())

    def by_name(self) -> Mapping[str, type[Member]]:
        """Return all members by their names."""
        return _by_name(self.classes())

    @property
    def files(self) -> Mapping[str, Path]:
        """Files that were loaded, by the names of their members."""
        return {member.name: file for file, member in self._loaded.items()}

    @property
    def variable(self) -> str:
        """Environment variable that names files to be loaded, for example `SYMOLO_SENSOR_FILES`."""
        return f"SYMOLO_{self.noun.upper()}_FILES"

    def load(self, path: str | Path) -> type[Member]:
        """Add the member of a Python file. A file that is loaded already changes nothing.

        Raises:
            InputError: There is no such file, it cannot be executed, or its class is not complete.
        """
        file = Path(path).resolve()
        if file not in self._loaded:
            if not file.is_file():
                allowed = f"a Python file with one {self.noun}"
                raise InputError(f"{self.noun} file: no such file", got=str(path), allowed=allowed)
            member = self._only_member(self._executed(file))
            if member.name in self.by_name():
                cure = "give the class another name"
                raise InputError(f"{self.noun} {member.name}: the name is taken", where=str(file), cure=cure)
            self._loaded[file] = member
        return self._loaded[file]

    def unload(self, path: str | Path) -> None:
        """Forget the member of a file that was loaded."""
        sys.modules.pop(self._loaded.pop(Path(path).resolve()).__module__, None)

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
            self._only_member(importlib.import_module(f"{package}.{name}"))
            for package in self.packages
            for name in getattr(importlib.import_module(package), self.table)
        )

    def _executed(self, file: Path) -> ModuleType:
        name = f"{self.noun}_file_{file.stem}_{sha256(str(file).encode()).hexdigest()[:8]}"
        spec = spec_from_file_location(name, file)
        if spec is None or spec.loader is None:
            raise InputError(f"{self.noun} file", got=str(file), allowed="a Python file, which ends in .py")
        module = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except Exception as error:  # a user's file may raise whatever it likes
            del sys.modules[name]
            lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
            what, line = (error.msg, error.lineno) if isinstance(error, SyntaxError) else (error, lines[-1])
            raise InputError(f"{self.noun} file: {type(error).__name__}: {what}", where=f"{file}:{line}") from error
        return module

    def _only_member(self, module: ModuleType) -> type[Member]:
        """Return the member that a module defines, after the check that it is complete."""
        classes = [
            value
            for value in vars(module).values()
            if isinstance(value, type)
            and not isinstance(value, GenericAlias)  # which Python 3.10 counts as a class
            and issubclass(value, self.base)
            and value.__module__ == module.__name__
        ]
        where = str(module.__file__)
        if len(classes) != 1:
            names = ", ".join(member.__name__ for member in classes) or "none"
            allowed = f"one class that derives from {self.base.__name__}"
            raise InputError(f"{self.noun} file", where=where, got=names, allowed=allowed)
        self.check(classes[0], where)
        return classes[0]


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
