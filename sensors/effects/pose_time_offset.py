"""Poses that are logged late."""

from configs.schema.effects.drive import PoseTimeOffset
from physics.effects.base import Slot, Term


def later(values: PoseTimeOffset, delay_s: float) -> float:
    return delay_s + values.delay_s


TERM = Term(
    PoseTimeOffset,
    Slot.POSE_DELAY,
    cause="exposure, transmission and clock of the external camera",
    excitation="fast turns and starts, beside the encoders",
    apply=later,
)
