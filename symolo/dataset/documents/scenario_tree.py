"""The scenario in metadata.json: any settings, in the form that the descriptions of a dataset rely on."""

import json
from typing import Annotated, Any

from pydantic import AfterValidator


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
    return tree


ScenarioTree = Annotated[dict[str, Any], AfterValidator(_checked)]
