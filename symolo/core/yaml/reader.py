"""Strict YAML: plain mappings, lists and scalars, each with the line it stands on.

The scalars are those of YAML 1.2 (`1e5` is a number, `yes` and `012` are text). Duplicate keys, anchors, aliases,
tags, merge keys and a second document are refused, and so is a file that is too large or too deep.
"""

import contextlib
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from symolo.core.errors import FaultList, InputError, shown
from symolo.core.files.plain_files import open_named_file
from symolo.core.yaml.tree import FieldPath, Node, Scalar, dotted

MAX_BYTES = 1 << 20
MAX_DEPTH = 32
MAX_NODES = 20_000

_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?(0|[1-9][0-9]*)?(\.[0-9]*)?([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_LARGEST_INTEGER = 2**63 - 1

_PARSER_CURES = {
    "\\t": "indent with spaces; YAML takes no tabs",
    "mapping values are not allowed": "check the indentation, and put text that contains ': ' in quotes",
    "expected <block end>": "check the indentation of this line against the lines above it",
    "could not find expected ':'": "write a colon and a space after the key",
    "while scanning a quoted scalar": "close the quotes",
    "expected ',' or": "close the bracket, or put a comma between the items",
}


@dataclass(frozen=True)
class Document:
    """A YAML file that was read."""

    path: Path
    root: Node
    """Top node of the document, whose value is a mapping."""


def displayed(path: Path) -> str:
    """Return a path as the user would type it: relative to the working directory if it is inside."""
    absolute, here = Path(path).absolute(), Path.cwd()
    return str(absolute.relative_to(here)) if absolute.is_relative_to(here) else str(absolute)


def read_yaml(path: Path) -> Document:
    """Read a file whose top level is a mapping.

    Raises:
        InputError: Something is not strict YAML; file, line and field path of the first fault are named.
    """
    name = displayed(path)
    root = _parsed_file(_read_text(path, name), name)
    if root.value is None:
        raise InputError("the file is empty", where=name, allowed="a mapping, such as 'name: example'")
    if not isinstance(root.value, dict):
        # Not what it holds: a stranger's scenario may name any file of the user's as the one that it extends.
        what = f"top level is {'a list' if isinstance(root.value, tuple) else 'a single value'}"
        raise InputError(what, where=root.where, allowed="a mapping, such as 'name: example'")
    return Document(path, root)


@lru_cache(maxsize=32)
def _parsed_file(text: str, name: str) -> Node:
    """Return the nodes of a file, which nobody changes: a program that loads many scenarios reads most files again."""
    return parse_yaml(text, name)


def parse_yaml(text: str, name: str, *, with_lines: bool = True) -> Node:
    """Parse one YAML document; without lines, every node's place is `name` itself (for `--set`)."""
    # libyaml is five times faster, but takes tabs and has fewer words for what is wrong: then the other parser speaks.
    if yaml.__with_libyaml__ and "\t" not in text:
        with contextlib.suppress(yaml.YAMLError):
            return _Builder(yaml.parse(text, Loader=yaml.CSafeLoader), name, with_lines=with_lines).document()
    try:
        return _Builder(yaml.parse(text, Loader=yaml.SafeLoader), name, with_lines=with_lines).document()
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        what = f"character {shown(chr(error.character))} is not allowed in YAML"  # pyright: ignore[reportArgumentType]
        raise InputError(what, where=f"{name}:{line}" if with_lines else name, cure="remove it") from None
    except yaml.MarkedYAMLError as error:
        # What is never closed or completed is best looked for where it began.
        begun = any(sign in str(error.problem) for sign in ("end of stream", "stream end", "could not find expected"))
        mark = error.context_mark if begun and error.context_mark else error.problem_mark
        where = f"{name}:{mark.line + 1}" if mark and with_lines else name
        problem = f"{error.context or ''} {error.problem or ''}".strip()
        cure = next((cure for sign, cure in _PARSER_CURES.items() if sign in problem), "")
        raise InputError(f"not valid YAML: {problem}", where=where, cure=cure) from None


def _read_text(path: Path, name: str) -> str:
    try:
        if path.is_dir():
            raise InputError("this is a folder", where=name, allowed="a YAML file")
        if not path.is_file():
            raise InputError("there is no such file", where=name)
        with open_named_file(path) as file:
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"cannot be read: {reason}", where=name) from None
    if len(data) > MAX_BYTES:
        raise InputError("the file is too large", where=name, allowed=f"at most {MAX_BYTES} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError("the file is not UTF-8", where=f"{name}:{line}", cure="save it as UTF-8 text") from None


@dataclass
class _Builder:
    """Builds nodes from the parser's events, so that nothing hostile is ever composed or constructed.

    We tried two libraries that keep line marks. Nodes of PyYAML 6.0.3 (`compose`) hide anchors and explicit tags, and
    its C composer crashes the process on 200,000 opening brackets, before we could refuse the depth. ruamel.yaml 0.19.1
    ends such a file with a RecursionError, and took 1.8 s for the shipped files, in place of 0.04 s for the events.
    """

    events: Iterator[Any]
    """Events of the parser, in their order."""
    name: str
    with_lines: bool
    nodes: int = field(default=0, init=False)
    faults: FaultList = field(default_factory=FaultList, init=False)
    """Faults after which reading can go on, so that all of them are reported together."""
    has_reference: bool = field(default=False, init=False)
    """Whether an anchor or an alias was noted."""

    def document(self) -> Node:
        root = self._root()
        self.faults.check()
        return root

    def _root(self) -> Node:
        root = None
        for event in self.events:
            if not isinstance(event, yaml.DocumentStartEvent):
                continue
            if root is not None:
                cure = "remove the line '---' or split the file"
                where = self._where(event)
                raise InputError("a second document begins here", where=where, allowed="one a file", cure=cure)
            root = self._node(next(self.events), ())
        return root or Node(None, self.name)

    def _where(self, event: yaml.Event) -> str:
        if not self.with_lines or event.start_mark is None:
            return self.name
        return f"{self.name}:{event.start_mark.line + 1}"

    def _node(self, event: yaml.Event, path: FieldPath) -> Node:
        where = self._where(event)
        self._refuse_extras(event, path, where)
        if isinstance(event, yaml.AliasEvent):
            what = dotted(path) or ("top level" if self.with_lines else "value")
            cure = "aliases are not read; write the value out"
            self._refuse_reference(InputError(what, where=where, got=f"*{event.anchor}", cure=cure))
            return Node(None, where)
        if isinstance(event, yaml.ScalarEvent):
            with self.faults.noted():
                return Node(_scalar(event, dotted(path), where), where)
            return Node(None, where)
        if isinstance(event, yaml.SequenceStartEvent):
            items: list[Node] = []
            while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
                items.append(self._node(event, (*path, len(items))))
            return Node(tuple(items), where)
        return Node(self._mapping(path), where)

    def _refuse_reference(self, fault: InputError) -> None:
        """Note an anchor or an alias, if it is the first one of the file: the others belong to it."""
        if not self.has_reference:
            self.faults.faults.append(fault)
        self.has_reference = True

    def _mapping(self, path: FieldPath) -> dict[str, Node]:
        children: dict[str, Node] = {}
        lines: dict[str, str] = {}
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            where = self._where(event)
            self._refuse_extras(event, path, where)
            if not isinstance(event, yaml.ScalarEvent):
                what = f"{dotted(path) or 'top level'}: a key that is a list or mapping"
                raise InputError(what, where=where, allowed="text as key")
            key = event.value
            inner = (*path, key)
            if key == "<<" and event.implicit[0]:
                cure = "YAML merge keys are not read; use 'extends:'"
                self.faults.faults.append(InputError(dotted(inner), where=where, cure=cure))
            elif key in children:
                what = f"{dotted(inner)}: the key is given twice, first at {lines[key]}"
                self.faults.faults.append(InputError(what, where=where, cure="keep one of the two"))
            lines[key] = where
            child = self._node(next(self.events), inner)
            # The key's line is where a reader looks for a field, also when its block begins a line later.
            children[key] = Node(child.value, where)
        return children

    def _refuse_extras(self, event: yaml.Event, path: FieldPath, where: str) -> None:
        self.nodes += 1
        what = dotted(path) or ("top level" if self.with_lines else "value")
        if isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent):
            if event.anchor:
                cure = "anchors are not read; remove it"
                self._refuse_reference(InputError(what, where=where, got=f"&{event.anchor}", cure=cure))
            if event.tag:
                tag, cure = event.tag.replace("tag:yaml.org,2002:", "!!"), "tags are not read; remove it"
                self.faults.faults.append(InputError(what, where=where, got=tag, cure=cure))
        if len(path) > MAX_DEPTH:
            raise InputError(f"{dotted(path[:3])}...: nested too deep", where=where, allowed=f"{MAX_DEPTH} levels")
        if self.nodes > MAX_NODES:
            raise InputError("too many values", where=where, allowed=f"at most {MAX_NODES} keys and values a file")


def _scalar(event: yaml.ScalarEvent, what: str, where: str) -> Scalar:
    """Return a scalar by the core schema of YAML 1.2 without octal, hexadecimal and numbers that are not finite."""
    text = event.value
    if not event.implicit[0]:  # quoted, or a block of text
        return text
    if text in {"", "~", "null", "Null", "NULL"}:
        return None
    if text in {"true", "True", "TRUE"}:
        return True
    if text in {"false", "False", "FALSE"}:
        return False
    if _NOT_FINITE.fullmatch(text):
        raise InputError(what, where=where, got=text, allowed="finite numbers")
    if _INTEGER.fullmatch(text):
        if len(text) > 20 or abs(int(text)) > _LARGEST_INTEGER:
            raise InputError(what, where=where, got=text, allowed=f"whole numbers up to {_LARGEST_INTEGER}")
        return int(text)
    if _FLOAT.fullmatch(text) and any(character.isdigit() for character in text.lower().split("e")[0]):
        number = float(text)
        if not math.isfinite(number):
            raise InputError(what, where=where, got=text, allowed="numbers up to 1.8e308")
        return number
    return text
