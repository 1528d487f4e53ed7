"""The controller of a run in place of the built-in one: the section `controller` of a scenario."""

import importlib
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from configs.families import optional_sections
from configs.robot_sensors import KNOWN_ONLY, UnloadedSettings
from configs.schema.base import Section, disagreement
from symolo.core.errors import InputError
from symolo.core.yaml.tree import Node, node_of

_OPTION = "--controller-file or --controller-command"


class ControllerSettings(Section):
    """Settings of a controller; a class adds its own."""


def controllers_section() -> type[Section]:
    """Return the schema of `controller`: one key, which is the name of a controller."""
    # Controllers are in a package above this one, so they are imported by name when they are first needed.
    return optional_sections("ChosenController", importlib.import_module("physics.control.registry").settings_by_name())


def with_chosen(root: Node) -> Node:
    """Return the tree of a scenario with the controller that the command line names, if the scenario names none.

    Raises:
        InputError: The command line names several.
    """
    if not isinstance(root.value, dict) or any(root.child(key) is not None for key in ("controller", "board")):
        return root
    names = importlib.import_module("physics.control.registry").names_from_command_line()
    if len(names) > 1:
        cure = f"choose one with --set controller.{names[0]}={{}}"
        raise InputError("controller", got=", ".join(names), allowed="one controller", cure=cure)
    return (
        Node({**root.value, "controller": node_of({name: {} for name in names}, _OPTION)}, root.where)
        if names
        else root
    )


@dataclass(frozen=True)
class ChosenController:
    """Name and settings of the controller that drives."""

    name: str
    settings: ControllerSettings | UnloadedSettings
    """Settings as they are, where the class is not loaded, as for a release that somebody else made."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate against the controllers that there are at that time: a user may have loaded one more."""
        del source, handler

        def validated(value: Any, info: ValidationInfo) -> ChosenController:  # noqa: ANN401 - whatever a file holds
            if isinstance(value, ChosenController):
                return value
            section = controllers_section()
            names = [*value] if isinstance(value, dict) else []
            if len(names) == 1 and names[0] not in section.model_fields and info.context != KNOWN_ONLY:
                return cls(str(names[0]), UnloadedSettings.model_validate(value[names[0]]))
            chosen = [(name, settings) for name, settings in section.model_validate(value) if settings is not None]
            if len(chosen) != 1:
                raise disagreement("", ", ".join(names) or "no name", "the name of one controller, with its settings")
            return cls(*chosen[0])

        def as_mapping(chosen: ChosenController) -> dict[str, BaseModel]:
            return {chosen.name: chosen.settings}

        serialization = core_schema.plain_serializer_function_ser_schema(as_mapping)
        return core_schema.with_info_plain_validator_function(validated, ref=cls.__name__, serialization=serialization)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del schema
        return handler(controllers_section().__pydantic_core_schema__)
