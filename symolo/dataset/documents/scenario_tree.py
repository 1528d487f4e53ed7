"""The scenario in metadata.json: any settings, in the form that the descriptions of a dataset rely on."""

import json
from typing import Annotated, Any

from pydantic import AfterValidator, ValidationError

from symolo.dataset.documents.code_record import CODE_FILES, RECORDS


def _checked(tree: dict[str, Any]) -> dict[str, Any]:
    try:
        json.dumps(tree, allow_nan=False)
    except ValueError:
        raise ValueError("contains a number that is not finite, or has thousands of digits") from None
    if wrong := [key for key in ("arena", "looks") if not isinstance(tree.get(key, {}), dict)]:
        raise ValueError(f"{wrong[0]} is no mapping")
    routes = tree.get("routes", [])
    if not isinstance(routes, list) or not all(isinstance(route, dict) for route in routes):
        raise ValueError("routes is no list of mappings")
    for key in CODE_FILES:
        _check_code(tree, key)
    return tree


def _check_code(tree: dict[str, Any], key: str) -> None:
    robot = tree.get("robot")
    stated = robot.get(key) if isinstance(robot, dict) else None
    if stated is None:
        return
    try:
        RECORDS.validate_python(stated)
    except ValidationError as error:
        place = ".".join(map(str, ("robot", key, *error.errors()[0]["loc"])))
        raise ValueError(f"{place}: {error.errors()[0]['msg']}") from None


ScenarioTree = Annotated[dict[str, Any], AfterValidator(_checked)]
