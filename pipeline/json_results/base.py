"""Common part of all results of `--json`: the command, the version of its keys, and the exit code."""

from pydantic import BaseModel, ConfigDict


class JsonPart(BaseModel):
    """A part of a result."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)


class JsonResult(JsonPart):
    """The one object that a command prints on standard output."""

    command: str
    """Name of the command."""
    format_version: int = 1
    """Version of the keys; it grows when a key changes its meaning or disappears."""
    exit_code: int = 0
    """Exit code of the command."""

    def to_json(self) -> str:
        """Return the object as indented JSON."""
        return self.model_dump_json(indent=2)
