"""JSON Schema of a scenario file, for editors: the models, and what a file may contain in addition.

In addition to the models, a file may name its arena, robot and look, extend another by `extends:`, leave out what that
one contains, and have a distribution at any leaf that may be drawn.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from configs.posterior.schema import (
    ChannelNoise,
    FittedNumber,
    FixedField,
    LoadedPosterior,
    MeasuredRange,
    RobotHypothesis,
)
from configs.references import SECTIONS, shipped_names
from configs.scaling import MAX_SCALE, MIN_SCALE, MODELS
from configs.schema.arena import ArenaConfig
from configs.schema.base import FILE_KEY
from configs.schema.scenario import Scenario
from configs.user_files import KEYS
from configs.validation.shapes import Shape
from symolo.core.field_descriptions import DescribedJsonSchema

_NUMBERS = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
_NORMAL = {
    "type": "object",
    "properties": {key: {"type": "number"} for key in ("mean", "sd", "low", "high")},
    "required": ["mean", "sd"],
    "additionalProperties": False,
}
_OPTIONS = {"type": "array", "items": {"type": ["number", "string", "boolean"]}, "minItems": 1}
_FOLDER = {
    "type": "string",
    "description": "Folder of your images and panoramas, relative to the YAML file that names it.",
}
_SCALE = {
    "type": "number",
    "minimum": MIN_SCALE,
    "maximum": MAX_SCALE,
    "description": "Factor on all lengths of what it extends; masses, motors, speeds and gains follow from it.",
}
_FOLDER_OF_MESHES = "Folder of your meshes, relative to the YAML file that names it."
_POSTERIOR_SECTIONS = tuple(
    model.__name__
    for model in (LoadedPosterior, RobotHypothesis, FixedField, FittedNumber, MeasuredRange, ChannelNoise)
)
"""Sections of a posterior, which a scenario file names; only that of a published dataset contains it."""
_KINDS = {"uniform": _NUMBERS, "log_uniform": _NUMBERS, "normal": {"anyOf": [_NUMBERS, _NORMAL]}, "choice": _OPTIONS}


def scenario_json_schema() -> dict[str, Any]:
    """Return the schema as plain data, draft 2020-12."""
    shape = Shape.from_model(Scenario, DescribedJsonSchema)
    in_lists = set(_below_lists(shape.schema, shape))
    definitions = {
        name: _mapping(schema, shape, required=name in in_lists) for name, schema in shape.definitions.items()
    }
    definitions["any_distribution"] = {"anyOf": [_one_of(kind) for kind in _KINDS]}
    definitions["choice_distribution"] = _one_of("choice")
    for kind in SECTIONS:
        name = shape.schema["properties"][kind]["$ref"].rsplit("/", 1)[1]
        definitions[name]["properties"]["extends"] = _base(kind)
        if kind in MODELS:
            definitions[name]["properties"]["scale"] = _SCALE
    definitions["LookConfig"]["properties"]["assets"] = _FOLDER
    definitions["CameraLook"]["properties"]["extends"] = _base("camera")
    fields = definitions["LookConfig"]["properties"]
    fields["camera"] = {"anyOf": [_reference("camera"), fields["camera"]]}
    for name in ("ArenaConfig", "RobotConfig"):
        definitions[name]["properties"]["assets"] = {**_FOLDER, "description": _FOLDER_OF_MESHES}
    for key in KEYS:
        field = definitions["RobotConfig"]["properties"][key]
        paths = {"type": "array", "items": {"type": "string", "pattern": r"\.py$"}}
        definitions["RobotConfig"]["properties"][key] = {**paths, "description": field["description"]}
    top = _mapping(shape.schema, shape, required=False)
    named = [{"type": "string", "description": "path, relative to the YAML file that names it"}, {"type": "null"}]
    named.append(
        {"type": "object", "description": "the whole posterior, as the scenario of a published dataset has it"}
    )
    top["properties"]["like"] = {"anyOf": named, "description": top["properties"]["like"]["description"]}
    for name in ("CodeFile", *_POSTERIOR_SECTIONS):
        definitions.pop(name, None)
    for kind in SECTIONS:
        field = shape.schema["properties"][kind]
        section = {key: value for key, value in field.items() if key != "description"}
        top["properties"][kind] = {"description": field["description"], "anyOf": [_reference(kind), section]}
    fields = definitions["Route"]["properties"]
    fields["arena"] = {"description": fields["arena"]["description"], "anyOf": [_reference("arena"), fields["arena"]]}
    top["properties"]["extends"] = _base("scenario")
    top["anyOf"] = [{"required": ["extends"]}, {"required": shape.schema["required"]}]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **top, "$defs": definitions}


def _one_of(kind: str) -> dict[str, Any]:
    return {"type": "object", "properties": {kind: _KINDS[kind]}, "required": [kind], "additionalProperties": False}


def _reference(kind: str) -> dict[str, Any]:
    path = {"type": "string", "pattern": r"/|\.ya?ml$", "description": "path, relative to the YAML file that names it"}
    return {"anyOf": [{"enum": list(shipped_names(kind)), "description": f"name of a shipped {kind}"}, path]}


def _base(kind: str) -> dict[str, Any]:
    about = (
        f"{kind.capitalize()} that this one changes: a shipped name, or a path relative to the YAML file that names it."
    )
    return {**_reference(kind), "description": about}


def _mapping(schema: Mapping[str, Any], shape: Shape, *, required: bool) -> dict[str, Any]:
    """Return a model's schema whose fields may be drawn and, outside lists, left out."""
    mapping = {key: value for key, value in schema.items() if required or key != "required"}
    mapping["properties"] = {key: _field(inner, shape) for key, inner in schema.get("properties", {}).items()}
    return mapping


def _field(schema: dict[str, Any], shape: Shape) -> dict[str, Any]:
    if "prefixItems" in schema:
        return {**schema, "prefixItems": [_field(item, shape) for item in schema["prefixItems"]]}
    leaf = Shape(schema, shape.definitions)
    if "$ref" in schema or not leaf.is_leaf or leaf.not_drawn:
        return schema
    about = {key: schema[key] for key in ("title", "description", "default") if key in schema}
    value = {key: item for key, item in schema.items() if key not in {*about, FILE_KEY}}
    if FILE_KEY in schema and "enum" in value:
        value = {"anyOf": [value, {"type": "string", "description": "name of a file in look.assets"}]}
    numeric = leaf.is_number or leaf.is_integer
    distribution = "any_distribution" if numeric else "choice_distribution"
    return {**about, "anyOf": [value, {"$ref": f"#/$defs/{distribution}"}]}


def _below_lists(schema: Any, shape: Shape, *, inside: bool = False) -> Iterator[str]:  # noqa: ANN401 - plain JSON
    """Yield the definitions that occur in lists: a list replaces another, so that its items must be complete.

    The arena of a route may extend another one, so that its own fields need not be.
    """
    if isinstance(schema, list):
        for item in schema:
            yield from _below_lists(item, shape, inside=inside)
    elif isinstance(schema, dict):
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            inside = inside and name != ArenaConfig.__name__
            yield from [name] if inside else []
            yield from _below_lists(shape.definitions[name], shape, inside=inside)
        for key, item in schema.items():
            if key not in {"$ref", "default", "discriminator"}:
                yield from _below_lists(item, shape, inside=inside or key == "items")
