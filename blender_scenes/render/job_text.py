"""The text of a job for Blender: the same bytes for the same job, and refused where it is of another format."""

from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

from pydantic import TypeAdapter
from typing_extensions import Self


@dataclass(frozen=True)
class JobText:
    """What every kind of job has; a kind adds the fields that decide its files."""

    FORMAT: ClassVar[int]
    KIND: ClassVar[str]
    """What it is called in errors."""

    format: int

    def to_json(self) -> str:
        """The job as text; equal jobs give equal bytes."""
        return _adapter(type(self)).dump_json(self).decode() + "\n"

    @classmethod
    def from_json(cls, text: str) -> Self:
        """The job that `to_json` wrote.

        Raises:
            ValueError: The text is no job, or one of another format.
        """
        job = _adapter(cls).validate_json(text)
        if job.format != cls.FORMAT:
            raise ValueError(f"{cls.KIND} job of format {job.format}, expected {cls.FORMAT}; build it again")
        return job


@cache
def _adapter(kind: type[JobText]) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
