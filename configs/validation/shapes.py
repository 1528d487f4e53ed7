"""The schema as a file sees it: what is allowed at a field path, in words, and whether it may be drawn.

Everything is derived from the JSON Schema that pydantic makes of the models, so that the models are the only source.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import CoreModeRef, DefsRef, GenerateJsonSchema

from configs.effects.registry import effects_section
from configs.robot_controller import controllers_section
from configs.robot_sensors import sensors_section
from configs.schema.base import FILE_KEY, FIXED_KEY, Section
from symolo.core.yaml.tree import ALTERNATIVES, FieldPath, Node, merge, node_of

_BOUNDS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
_PLAIN_WORDS = {"boolean": "true or false", "string": "text", "null": "nothing", "array": "a list"}
_PLAIN_TYPES = frozenset({bool, int, float, str, type(None)})
_MAX_NAMES = 40


class FullNames(GenerateJsonSchema):
    """Names each definition in full. Nobody reads the names, and the search for short ones takes half of the time."""

    def get_defs_ref(self, core_mode_ref: CoreModeRef) -> DefsRef:
        """Return the full name, as the only one to choose from."""
        name = super().get_defs_ref(core_mode_ref)
        # pydantic promises no such table; without it, it searches as it always did.
        choices = getattr(self, "_prioritized_defsref_choices", {})
        if name in choices:
            choices[name] = [name]
        return name

    def encode_default(self, dft: Any) -> Any:  # noqa: ANN401 - any default of a field
        """Return a default as JSON has it; a plain one as it is, for which pydantic would build a serialiser."""
        return dft if type(dft) in _PLAIN_TYPES else super().encode_default(dft)


@dataclass(frozen=True)
class Shape:
    """What is allowed at one field path, by the JSON Schema of the models."""

    schema: Mapping[str, Any]
    """JSON Schema whose `$ref` at the top is resolved; those inside it are not."""
    definitions: Mapping[str, Any]
    _known: dict[str | int, "Shape"] = field(default_factory=dict, init=False, repr=False, compare=False)
    """Shapes below this one that were asked for, by key, and its variants, by tag: reading a file asks for most."""

    @classmethod
    def from_model(cls, model: type[BaseModel], generator: type[GenerateJsonSchema] = FullNames) -> "Shape":
        """Return the shape of a model, with the effects, sensors and controllers that there are now."""
        if generator is FullNames:
            return _shape(model, _family_sections())
        return _whole_shape(model, _family_sections(), generator)

    @cached_property
    def fields(self) -> dict[str, Any]:
        """JSON Schema of each field; empty if this is not a mapping with known fields."""
        return self.schema.get("properties", {})

    @cached_property
    def tag_key(self) -> str:
        """Field that selects one of several mappings, or an empty string."""
        return self.schema.get("discriminator", {}).get("propertyName", "")

    @property
    def tags(self) -> tuple[str, ...]:
        return tuple(self.schema.get("discriminator", {}).get("mapping", {}))

    @cached_property
    def types(self) -> set[str]:
        """JSON types of a leaf's values."""
        return {option.get("type", "") for option in self.schema.get("anyOf", [self.schema])}

    @cached_property
    def is_leaf(self) -> bool:
        return self.types <= {"number", "integer", "boolean", "string", "null"} and not self.tag_key

    @property
    def is_integer(self) -> bool:
        return "integer" in self.types and "number" not in self.types

    @property
    def is_number(self) -> bool:
        return "number" in self.types

    @property
    def not_drawn(self) -> str:
        """Reason why no distribution is allowed; empty if one is."""
        if FIXED_KEY in self.schema:
            return self.schema[FIXED_KEY]
        if FILE_KEY in self.schema:
            return ""
        if "const" in self.schema or len(self.schema.get("enum", [1, 2])) < 2:
            return "it has one value only"
        if self.types <= {"string", "null"} and "enum" not in self.schema:
            return "text is not drawn"
        return ""

    def child(self, key: str | int, node: Node | None = None) -> "Shape | None":
        """Return the shape below a key; `node` is the mapping, whose tag selects one of several shapes."""
        here = self.variant(node)
        return None if here is None else here.below(key)

    def below(self, key: str | int) -> "Shape | None":
        """Return the shape below a key of a mapping or list that has one shape."""
        fixed = self.schema.get("prefixItems", [])
        place = key if isinstance(key, str) else min(key, len(fixed))
        if place in self._known:
            return self._known[place]
        if isinstance(place, str):
            free = self.schema.get("additionalProperties")
            inner = self.fields.get(place, free if isinstance(free, dict) else None)
        else:
            inner = fixed[place] if place < len(fixed) else self.schema.get("items")
        if not inner:
            return None
        return self._known.setdefault(place, self._resolved(inner))

    def at(self, path: FieldPath, root: Node) -> "Shape | None":
        """Return the shape at a path below this one."""
        shape: Shape | None = self
        node: Node | None = root
        for key in path:
            if shape is None:
                return None
            shape = shape.child(key, node)
            node = node.child(key) if node else None
        return shape

    def known_keys(self, node: Node | None = None) -> Iterator[str]:
        here = self.variant(node)
        yield from here.fields if here else (self.tag_key,)

    def paths(self, above: FieldPath = ()) -> Iterator[FieldPath]:
        """Yield the paths of all fields below this shape, except those inside lists."""
        for key in self.fields:
            yield (*above, key)
            inner = self.child(key)
            if inner is not None:
                yield from inner.paths((*above, key))

    @cached_property
    def leaves_with_files(self) -> "tuple[tuple[FieldPath, Shape], ...]":
        """Fields below this shape whose value may be the name of a file."""
        leaves = ((path, self.at(path, Node({}, ""))) for path in self.paths())
        return tuple((path, leaf) for path, leaf in leaves if leaf is not None and FILE_KEY in leaf.schema)

    @cached_property
    def top_places(self) -> dict[str, tuple[FieldPath, ...]]:
        """Shortest `paths` that end with each key; cached, because a file may have a thousand unknown keys."""
        places: dict[str, tuple[FieldPath, ...]] = {}
        for path in self.paths():
            key = str(path[-1])
            others = places.get(key, ())
            if not others or len(path) < len(others[0]):
                places[key] = (path,)
            elif len(path) == len(others[0]):
                places[key] = (*others, path)
        return places

    def words(self) -> str:
        """Return in words what is allowed, for a message."""
        schema = self.schema
        if self.tag_key:
            return f"a mapping whose '{self.tag_key}' is one of {', '.join(self.tags)}"
        if self.fields:
            return f"a mapping with the fields {shown_names(list(self.fields))}"
        if "const" in schema:
            return str(schema["const"])
        if FILE_KEY in schema:
            known = f"one of {shown_names(schema['enum'])}, or " if "enum" in schema else ""
            return f"{known}the name of a file in the folder that look.assets names"
        if "enum" in schema:
            return f"one of {shown_names(schema['enum'])}"
        if "anyOf" in schema:
            return " or ".join(self._resolved(option).words() for option in schema["anyOf"])
        return self._words_of_type()

    def _words_of_type(self) -> str:
        schema = self.schema
        if "prefixItems" in schema:
            items = [self._resolved(item).words() for item in schema["prefixItems"]]
            each = f"each {items[0]}" if len(set(items)) == 1 else ", ".join(items)
            return f"a list of {len(items)}, {each}"
        if "pattern" in schema:
            return "a name of letters, digits, '_' and '-', at most 64, beginning with a letter or digit"
        if schema.get("type") in {"number", "integer"}:
            kind = "number" if schema["type"] == "number" else "whole number"
            bounds = [f"{sign} {schema[key]}" for key, sign in _BOUNDS.items() if key in schema]
            return f"{kind} {' and '.join(bounds)}".strip()
        min_items = schema.get("minItems")
        ending = f" with at least {min_items} item{'s' if min_items > 1 else ''}" if min_items else ""
        return _PLAIN_WORDS.get(schema.get("type", ""), "a mapping") + ending

    def variant(self, node: Node | None) -> "Shape | None":
        """Return the shape that the tag of a mapping selects; this one if it has no tag, None if the tag is unknown."""
        if not self.tag_key:
            return self
        tag = node.child(self.tag_key) if node else None
        if tag is None or tag.value not in self.tags:
            return None
        if tag.value not in self._known:
            self._known[tag.value] = self._resolved({"$ref": self.schema["discriminator"]["mapping"][tag.value]})
        return self._known[tag.value]

    def _resolved(self, schema: Mapping[str, Any]) -> "Shape":
        if "anyOf" in schema:  # `X | None` is X if X is not a leaf
            solid = [option for option in schema["anyOf"] if option.get("type") != "null"]
            if len(solid) == 1:
                schema = {**{k: v for k, v in schema.items() if k != "anyOf"}, **solid[0]}
        if "$ref" in schema:
            schema = {**self.definitions[schema["$ref"].rsplit("/", 1)[1]], **schema}
            schema = {key: value for key, value in schema.items() if key != "$ref"}
        return Shape(schema, self.definitions)


def _family_sections() -> tuple[type[Section], ...]:
    """Return the sections to which files of a user may add, with the effects, sensors and controllers of now."""
    return effects_section(), sensors_section(), controllers_section()


@cache
def _shape(model: type[BaseModel], sections: tuple[type[Section], ...]) -> Shape:
    """Return the shape with these family sections: the first shape of the model, in which they replace others."""
    first, first_sections = _first_shape(model)
    names = {definition.get("title"): name for name, definition in first.definitions.items()}
    definitions = dict(first.definitions)
    for section in sections:
        if section not in first_sections and _title(section) in names:
            section_shape = _section_shape(section)
            definitions |= section_shape.definitions
            definitions[names[_title(section)]] = section_shape.schema
    return Shape(first.schema, definitions)


@cache
def _first_shape(model: type[BaseModel]) -> tuple[Shape, tuple[type[Section], ...]]:
    """Return the shape of a model when it is first asked for, and its family sections: the whole takes long."""
    sections = _family_sections()
    return _whole_shape(model, sections, FullNames), sections


@cache
def _section_shape(section: type[Section]) -> Shape:
    return _as_shape(section.model_json_schema(schema_generator=FullNames))


@cache
def _whole_shape(
    model: type[BaseModel], sections: tuple[type[Section], ...], generator: type[GenerateJsonSchema]
) -> Shape:
    del sections  # the schema contains them, so that one more effect, sensor or controller makes another schema
    return _as_shape(model.model_json_schema(schema_generator=generator))


def _as_shape(schema: dict[str, Any]) -> Shape:
    return Shape(schema, schema.pop("$defs", {}))


def _title(section: type[Section]) -> str:
    return section.model_config.get("title") or section.__name__


def with_defaults(node: Node, shape: Shape) -> Node:
    """Return the node with defaults for all missing fields, below mappings and lists, at the place of its mapping.

    A mapping that sets some fields of a default has the default's values of the others:
    `tape: {paint: {reflectance: 0.1}}` has the tape's tint.
    """
    if node.complete_for is shape:  # as all but a path of it is, where one field was set
        return node
    if isinstance(node.value, tuple):
        items = []
        for index, item in enumerate(node.value):
            inner = shape.child(index)
            items.append(with_defaults(item, inner) if inner else item)
        return Node(tuple(items), node.where, complete_for=shape)
    if not isinstance(node.value, dict) or node.is_distribution or shape.is_leaf:
        return node
    here = shape.variant(node)
    if here is None:
        return node
    fields = _with_missing(node, here)
    for key, value in fields.items():
        inner = here.below(key) if isinstance(value.value, dict | tuple) else None
        if inner is not None:
            fields[key] = with_defaults(value, inner)
    return Node(fields, node.where, complete_for=shape)


def _with_missing(node: Node, shape: Shape) -> dict[str, Node]:
    """Return the fields of a mapping, and the defaults of those that it lacks."""
    fields = dict(node.value) if isinstance(node.value, dict) else {}
    for key in shape.fields:
        inner = shape.below(key)
        if inner is None or "default" not in inner.schema:
            continue
        default = inner.schema["default"]
        if key not in fields:
            if ALTERNATIVES.get(key) not in fields:
                fields[key] = node_of(default, node.where)
        elif isinstance(default, dict) and isinstance(fields[key].value, dict):
            fields[key] = merge(node_of(default, node.where), fields[key])
    return fields


def shown_names(names: Sequence[object]) -> str:
    text = ", ".join(str(name) for name in names[:_MAX_NAMES])
    return text + (f" and {len(names) - _MAX_NAMES} more" if len(names) > _MAX_NAMES else "")
