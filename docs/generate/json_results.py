"""Reference of the results that commands print with `--json`."""

from collections.abc import Iterator
from typing import Any

from markdown_text import page, table, text

from pipeline.json_results import RESULTS, result_json_schema

ABOUT = """With `--json`, these commands print one object on standard output and nothing else there. The exit code is
the same as without it. If a command ends with exit code 1, 2, 3 or 5 before there is a result, it prints nothing on
standard output, and one line on standard error says why. `symolo schema --of COMMAND` prints the JSON Schema of the
object.

Keys keep their names and meanings while `format_version` stays the same; new keys may be added."""


def json_results() -> str:
    return page("Results as JSON", ABOUT, (part for command in RESULTS for part in _section(command)))


def _section(command: str) -> Iterator[str]:
    schema = result_json_schema(command)
    yield f"## {command}"
    yield text(schema["description"])
    yield table(("key", "value", "meaning"), _rows(schema, schema.get("$defs", {}), ""))


def _rows(schema: Any, parts: Any, before: str) -> Iterator[tuple[str, str, str]]:
    """Yield a row for each key; those of parts have the path to the part before them."""
    for name, value in schema["properties"].items():
        kind, inner = _kind(value, parts)
        path = f"{before}{name}"
        yield f"`{path}`", text(kind), text(value.get("description", ""))
        if inner is not None:
            yield from _rows(inner, parts, f"{path}[]." if kind.startswith("list") else f"{path}.")


def _kind(value: Any, parts: Any) -> tuple[str, Any]:
    """Return the type of a value in words, and the schema of the part that it holds, if any."""
    if "anyOf" in value:
        kinds = [_kind(one, parts) for one in value["anyOf"]]
        return " or ".join(kind for kind, _ in kinds), next((inner for _, inner in kinds if inner is not None), None)
    if "$ref" in value:
        return "object", parts[value["$ref"].rpartition("/")[2]]
    if "enum" in value:
        return " or ".join(f"`{one}`" for one in value["enum"]), None
    if value["type"] == "array":
        kind, inner = _kind(value["items"], parts)
        return f"list of {kind}s", inner
    if value["type"] == "object":
        kind, inner = _kind(value["additionalProperties"], parts)
        return f"object with {kind}s", inner
    return {"string": "text", "boolean": "true or false", "integer": "integer", "number": "number", "null": "null"}[
        value["type"]
    ], None
