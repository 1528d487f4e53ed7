"""Base of the parts of metadata.json."""

from pydantic import BaseModel, ConfigDict


def parsed_first(content: object) -> object:
    """Return the content as it is, as a validator before those of the fields of a document.

    For such a validator pydantic parses the JSON, and what is wrong with a field then refers to the parsed content.
    Without one, each such fault gets a copy of the whole document, which a file of some megabytes can make gigabytes.
    """
    return content


class Record(BaseModel):
    """A part of metadata.json; it cannot be changed, and keys that it does not list are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, from_attributes=True)
