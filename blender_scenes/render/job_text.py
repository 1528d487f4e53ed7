"""The text of a job for Blender: the same bytes for the same job; text of another format is refused."""

from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

from pydantic import TypeAdapter
from typing_extensions import Self


@dataclass(frozen=True)
class JobText:
    """Base of all kinds of job; a kind adds the fields on which its files depend."""

    FORMAT: ClassVar[int]
    KIND: ClassVar[str]
    """Name of the kind in error messages."""

    format: int

    def to_json(self) -> str:
        """Return the job as text; equal jobs give equal text."""
        return _adapter(type(self)).dump_json(self).decode() + "\n"

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the job that `to_json` wrote.

        Raises:
            ValueError: The text is not a job, or a job of another format.
        """
        job = _adapter(cls).validate_json(text)
        if job.format != cls.FORMAT:
            raise ValueError(f"{cls.KIND} job of format {job.format}, expected {cls.FORMAT}; build it again")
        return job


@cache
def _adapter(kind: type[JobText]) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
