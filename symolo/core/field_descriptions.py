"""Descriptions of the fields of models: the texts below them in the source.

Pydantic reads them for `use_attribute_docstrings` whenever a model is defined, which takes a third of the time of
importing the models. Most processes need no description, so they are read here on demand.
"""

import ast
import inspect
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.abc import InspectLoader
from itertools import pairwise
from types import FunctionType

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema


class DescribedJsonSchema(GenerateJsonSchema):
    """JSON Schema of models with the descriptions of their fields."""

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        described = super().model_schema(schema)
        model = schema["cls"]
        for name, text in field_descriptions(model).items():
            key = model.model_fields[name].alias or name
            if key in described.get("properties", {}):
                described["properties"][key]["description"] = text
        return described


@cache
def field_descriptions(model: type[BaseModel]) -> Mapping[str, str]:
    """Return the descriptions of a model's fields by name; fields without one are left out."""
    return dict(_descriptions(model))


def _descriptions(model: type[BaseModel]) -> Iterator[tuple[str, str]]:
    for name, field in model.model_fields.items():
        defines = next(base for base in model.__mro__ if name in inspect.get_annotations(base))
        text = field.description or _texts(_source(defines)).get(defines.__name__, {}).get(name)
        if text:
            yield name, text


def _source(model: type) -> str:
    """Return the source of the module that defines a class; an empty text if there is none."""
    functions = (value for value in vars(model).values() if isinstance(value, FunctionType))
    module = sys.modules.get(model.__module__)
    # A law of the diagnosis is defined in a module that is nowhere listed; its functions know it.
    names = vars(module) if module else next((function.__globals__ for function in functions), {})
    loader = names.get("__loader__")
    if isinstance(loader, InspectLoader):
        return loader.get_source(names["__name__"]) or ""
    return inspect.getsource(module) if module and hasattr(module, "__file__") else ""


@cache
def _texts(source: str) -> Mapping[str, Mapping[str, str]]:
    """Return the texts below annotated names, by class and name."""
    classes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef))
    return {node.name: dict(_texts_below_names(node.body)) for node in classes}


def _texts_below_names(body: list[ast.stmt]) -> Iterator[tuple[str, str]]:
    for field, words in pairwise(body):
        match field, words:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                yield name, inspect.cleandoc(text)
            case _:
                pass
