"""Settings of a look, as a file has them."""

from dataclasses import dataclass

import yaml

from symolo.core.distributions import Scalar

Value = Scalar | dict[str, list[float]]


@dataclass(frozen=True)
class LookSetting:
    """A setting of the look with the reason for its value."""

    path: tuple[str, ...]
    value: Value
    source: str
    """What set the value; empty if nothing needs to be said."""

    @property
    def text(self) -> str:
        """Return the value as YAML."""
        return yaml_text(self.value)


def yaml_text(value: Value) -> str:
    """Return a value as YAML on one line."""
    return yaml.safe_dump(value, default_flow_style=True, width=10_000).removesuffix("...\n").strip()
