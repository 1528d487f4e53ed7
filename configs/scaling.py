"""A robot or an arena of another size: every number is scaled by the unit in its name.

The factors keep the Froude number v^2 / (g l), so that a scaled robot in a scaled arena does the same as before in
another time: lengths grow with the factor s, times with s^(1/2), masses with s^3 (Langhaar, Dimensional Analysis and
Theory of Models, 1951, chapter 5). Everything else follows from these three. Numbers of devices that are bought, such
as the reach of a range sensor or the voltage of a battery, are not scaled.
"""

from collections.abc import Mapping
from types import MappingProxyType

from configs.schema.arena import ArenaConfig
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.validation.shapes import Shape, with_defaults
from symolo.core.errors import InputError
from symolo.core.yaml.tree import FieldPath, Node

MODELS: Mapping[str, type[Section]] = MappingProxyType({"arena": ArenaConfig, "robot": RobotConfig})
"""Kinds of file that can be scaled."""
MIN_SCALE, MAX_SCALE = 0.1, 10.0
DIGITS = 6
"""Significant digits of a scaled number."""

_EXPONENTS: Mapping[str, float] = MappingProxyType(
    {
        "N_m_s_rad": 4.5,
        "N_m_A": 0.5,  # also V s/rad: the same voltage gives the speed of the wheel, which is a frequency
        "N_m": 4.0,
        "kg_m2": 5.0,
        "kg": 3.0,
        "V_s_rad": 0.5,
        "ohm": -3.5,
        "rad_s": -0.5,
        "1_s": -0.5,
        "m_s": 0.5,
        "per_m": -1.0,
        "m": 1.0,
        "t_s": 0.5,
    }
)
"""Power of the factor by the unit at the end of a name; the first that fits counts."""
_LENGTHS = frozenset({"start", "end", "center", "size", "offset", "points", "places"})
"""Names of lists of lengths."""
_DEVICES: tuple[FieldPath, ...] = (
    *(("tof", name) for name in ("min_range_m", "max_range_m", "no_target_m", "quantisation_m")),
    ("encoder",),
    ("power",),
    ("effects",),
    ("effect_ranges",),
)
"""Paths of what is not scaled in a robot."""
_PLACES = frozenset({"x_m", "y_m", "z_m", "places"})
"""Settings of a sensor of `robot.sensors` that are scaled: where it is. The device itself is bought."""


def scaled(kind: str, root: Node, factor: Node | None) -> Node:
    """Return a robot or an arena, complete with its defaults, at another size; without a factor as it is.

    Raises:
        InputError: The factor is not a number within its limits, or a file of this kind cannot be scaled.
    """
    if factor is None:
        return root
    if kind not in MODELS:
        raise InputError("scale", where=factor.where, cure=f"leave it out: only {' and '.join(MODELS)} have a size")
    s = factor.value
    if isinstance(s, bool) or not isinstance(s, int | float) or not MIN_SCALE <= s <= MAX_SCALE:
        allowed = f"a number from {MIN_SCALE:g} to {MAX_SCALE:g}, without a distribution"
        raise InputError("scale", where=factor.where, got=factor.plain(), allowed=allowed)
    return _scaled(with_defaults(root, Shape.from_model(MODELS[kind])), float(s), ())


def _scaled(node: Node, s: float, path: FieldPath, exponent: float = 0.0) -> Node:
    if any(path[: len(device)] == device for device in _DEVICES):
        return node
    if path[:1] == ("sensors",) and len(path) > 2 and path[2] not in _PLACES:
        return node
    if isinstance(node.value, dict):
        keep = node.is_distribution or exponent != 0.0
        return Node(
            {
                key: _scaled(child, s, (*path, key), exponent if keep else _exponent(key, child, path))
                for key, child in node.value.items()
            },
            node.where,
        )
    if isinstance(node.value, tuple):
        items = enumerate(node.value)
        return Node(tuple(_scaled(child, s, (*path, index), exponent) for index, child in items), node.where)
    if exponent == 0.0 or isinstance(node.value, bool) or not isinstance(node.value, int | float):
        return node
    return Node(float(f"{node.value * s**exponent:.{DIGITS}g}"), node.where)


def _exponent(key: str, child: Node, path: FieldPath) -> float:
    if path[-1:] == ("mesh",):
        return 1.0 if key == "scale" else 0.0
    if key in _LENGTHS and isinstance(child.value, tuple):
        return 1.0
    return next((power for unit, power in _EXPONENTS.items() if key == unit or key.endswith(f"_{unit}")), 0.0)
