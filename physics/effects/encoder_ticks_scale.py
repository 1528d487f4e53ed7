"""Encoders with other than the believed counts per revolution."""

from configs.schema.effects.drive import EncoderTicksScale
from physics.effects.base import Slot, Term


def scaled(values: EncoderTicksScale, counts_per_revolution: float) -> float:
    return values.scale * counts_per_revolution


TERM = Term(
    EncoderTicksScale,
    Slot.ENCODER,
    cause="another gear ratio or code wheel",
    excitation="speeds and distances that are known otherwise",
    apply=scaled,
)
