"""JSON Schema of metadata.json, for tools in other languages and for editors."""

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from symolo.core.field_descriptions import DescribedJsonSchema
from symolo.dataset.documents.metadata import METADATA, Metadata


def metadata_json_schema() -> dict[str, Any]:
    """Return the schema as plain data, draft 2020-12."""
    schema = Metadata.model_json_schema(schema_generator=DescribedJsonSchema, mode="validation")
    # Keys of JSON cannot be numbers, so those of the states are texts.
    schema["properties"]["states"]["propertyNames"] = {"pattern": r"^\d+$"}
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "title": METADATA}
