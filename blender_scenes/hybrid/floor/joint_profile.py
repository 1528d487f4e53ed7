"""The profile of a joint, wide enough for the texels of a map that samples it in their middle."""

from dataclasses import dataclass


@dataclass(frozen=True)
class JointProfile:
    """The value across a joint: `share` in the middle, 0 from `half_m` on, and a smooth step in between."""

    half_m: float
    softness: float
    """Width of the step, as a share of `half_m`."""
    share: float = 1.0


def widened(joint: JointProfile, texel_m: float, max_half_m: float) -> JointProfile:
    """Return a joint with the same mean, whose steps are as wide as a texel, but not wider than `max_half_m`.

    A joint that is narrower than a texel becomes wider and fainter. As the smooth step s(x) has s(x) + s(1 - x) = 1,
    samples at the distance of a texel sum up to the same value wherever they lie: the joint neither vanishes between
    two of them nor appears twice as wide. At each edge of a wider joint, the sum is right to a tenth of a texel.
    """
    # Half the mean: from the middle to half the height of the step.
    middle_m = joint.half_m * (1 - 0.5 * joint.softness)
    step_m = max(joint.softness * joint.half_m, min(texel_m, max_half_m))
    if middle_m >= 0.5 * step_m:
        half_m = middle_m + 0.5 * step_m
        return JointProfile(half_m, step_m / half_m, joint.share)
    return JointProfile(step_m, 1.0, joint.share * 2 * middle_m / step_m)
