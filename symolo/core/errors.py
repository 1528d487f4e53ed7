"""The three ways to fail that a user sees, each one clear line; everything else is a bug."""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

_LONGEST_VALUE = 60
_LONGEST_WHAT = 300
_LONGEST_ALLOWED = 1500
"""A log may have thousands of columns, or names of thousands of characters."""
_MAX_LISTED = 20
"""Number of faults that are listed; a damaged file may have thousands."""
_UNPRINTABLE = re.compile(
    r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff"
    r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]+"  # those that turn the direction of what follows
)


class InputError(Exception):
    """Input of the user that cannot be used; nothing was written.

    The text is one line: `where: what: got X, allowed: Y; did you mean Z; cure`.

    Args:
        what: Field path, or a short sentence that says what is wrong.
        where: `file:line` of the node that holds it, or `--set field.path`, which is not repeated as `what`.
        got: The value that is there; left out by default.
        allowed: What may stand there, in words.
        nearest: The permitted name that is closest to the one given.
        cure: What to do about it.

    Attributes:
        field: What is wrong, up to its first colon: the field path in a configuration.
    """

    def __init__(
        self, what: str, *, where: str = "", got: object = ..., allowed: str = "", nearest: str = "", cure: str = ""
    ) -> None:
        head = ": ".join(part for part in (where, _shortened(_without_repetition(what, where), _LONGEST_WHAT)) if part)
        if got is not ...:
            head += f": got {shown(got)}"
        if allowed:
            head += f"{';' if got is ... else ','} allowed: {_shortened(allowed, _LONGEST_ALLOWED)}"
        self.field = what.partition(":")[0]
        self._parts = (what, where, got, allowed, nearest, cure)
        tail = [f"did you mean {nearest}"] if nearest else []
        super().__init__(one_line("; ".join([head, *tail, *([cure] if cure else [])])))

    def below(self, section: str, path: str) -> "InputError":
        """Return the same fault of a section that stands at another path of the file."""
        key, dot, rest = self.field.partition(".")
        if key != section:
            return self
        what, where, got, allowed, close, cure = self._parts
        moved = path + dot + rest + what.removeprefix(self.field)
        return InputError(moved, where=where, got=got, allowed=allowed, nearest=close, cure=cure)


def _without_repetition(what: str, where: str) -> str:
    """Return `what` without the field path at its beginning, if `where` is a `--set` of this path."""
    path, colon, problem = what.partition(": ")
    return problem if where == f"--set {path}" else path + colon + problem


class FaultsError(InputError):
    """Several faults of the input, in a text of one line each.

    Args:
        faults: At least two.
    """

    def __init__(self, faults: Sequence[InputError]) -> None:
        self.faults, self.field = tuple(faults), ""
        lines = [f"{len(faults)} faults:", *(f"  {fault}" for fault in faults[:_MAX_LISTED])]
        more = len(faults) - _MAX_LISTED
        Exception.__init__(self, "\n".join([*lines, *([f"  and {more} more"] if more > 0 else [])]))

    def __reduce__(self) -> tuple[type["FaultsError"], tuple[tuple[InputError, ...]]]:
        """Let pickle rebuild the error unchanged in the process that started the worker."""
        return FaultsError, (self.faults,)


class FaultList:
    """Faults that are collected, so that the user sees all of them at once."""

    def __init__(self) -> None:
        self.faults: list[InputError] = []

    @contextmanager
    def noted(self) -> Iterator[None]:
        """Collect the InputError of a block, which ends there, in place of raising it."""
        try:
            yield
        except FaultsError as several:
            self.faults += several.faults
        except InputError as error:
            self.faults.append(error)

    def check(self) -> None:
        """Raise InputError if there is a fault."""
        if self.faults:
            raise together(self.faults)


def apart(error: InputError) -> tuple[InputError, ...]:
    """Return the faults of an error, of which there may be one."""
    return error.faults if isinstance(error, FaultsError) else (error,)


def together(faults: Sequence[InputError]) -> InputError:
    """Return one error with all of these faults, at least one."""
    return faults[0] if len(faults) == 1 else FaultsError(faults)


class RunFailed(Exception):  # noqa: N818 - a run that fails is an outcome with a name, and the name is the contract's
    """A run ended in a collision or did not finish its lap; it is reported and not released."""


class EnvironmentLacking(Exception):  # noqa: N818 - as above
    """The machine lacks something; the text ends with what to do about it."""


def one_line(text: str) -> str:
    """Return a text without line breaks and control characters, which a hostile file could smuggle into a terminal."""
    return _UNPRINTABLE.sub(" ", text)


MIN_ABBREVIATION = 3
"""Smallest number of letters of an abbreviation."""


def nearest(name: object, candidates: Iterable[str]) -> str:
    """Return the candidate that is most similar to `name`, or the only one of which `name` is the beginning.

    Empty if none is close.
    """
    by_lower = {candidate.lower(): candidate for candidate in candidates}
    lower = str(name)[:200].lower()
    if matches := difflib.get_close_matches(lower, by_lower, n=1, cutoff=0.6):
        return by_lower[matches[0]]
    longer = [candidate for candidate in by_lower if candidate.startswith(lower)]
    return by_lower[longer[0]] if len(longer) == 1 and len(lower) >= MIN_ABBREVIATION else ""


def shown(value: object) -> str:
    """Return a value as the user would write it, shortened."""
    if value is None:
        return "nothing (null)"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        text = "{" + ", ".join(f"{key}: {shown(item)}" for key, item in list(value.items())[:4])
        text += ", ...}" if len(value) > 4 else "}"
    elif isinstance(value, Sequence):
        text = "[" + ", ".join(shown(item) for item in value[:4]) + (", ...]" if len(value) > 4 else "]")
    else:
        text = repr(value)
    return _shortened(text, _LONGEST_VALUE + 2)


def _quoted(text: str) -> str:
    """Return a text in quotation marks, which are closed where it is shortened."""
    beginning = text[:_LONGEST_VALUE]
    while len(repr(beginning)) > _LONGEST_VALUE + 2:  # `repr` writes some characters as several
        beginning = beginning[:-1]
    return repr(beginning) + ("..." if len(text) > len(beginning) else "")


def _shortened(text: str, length: int) -> str:
    return text if len(text) <= length else text[:length] + "..."
