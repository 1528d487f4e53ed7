"""A parameter of the camera that may differ from its nominal value, with the tolerance that needs no explanation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class CameraNumber:
    name: str
    unit: str
    tolerance: float
    """Standard deviation between cameras of one kind, in `unit`."""
    means: str
    comes_of: str
    can_be_named: bool = True
