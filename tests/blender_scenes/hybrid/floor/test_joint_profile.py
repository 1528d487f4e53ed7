"""Joints sampled at the distance of a texel: the mean of the samples is that of the joint, wherever they lie."""

import numpy as np
import pytest

from blender_scenes.hybrid.floor.joint_profile import JointProfile, widened

TILE_M = 0.1
JOINTS = [JointProfile(0.00025, 0.5), JointProfile(0.002, 0.3), JointProfile(0.0008, 1.0), JointProfile(0.003, 0.0)]


def _value(joint: JointProfile, away_m: np.ndarray) -> np.ndarray:
    """Return `svm_brick` of Cycles (intern/cycles/kernel/svm/brick.h) across a joint, times the share."""
    share = 1 - np.abs(away_m) / joint.half_m
    if not joint.softness:
        return joint.share * (share > 0)
    step = np.clip(share / joint.softness, 0, 1)
    return joint.share * step * step * (3 - 2 * step)


def _sampled_width_m(joint: JointProfile, texel_m: float, shift: float) -> float:
    return float(_value(joint, (np.arange(-60, 60) + shift) * texel_m).sum() * texel_m)


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("shift", [0.0, 0.2, 0.5, 0.9])
def test_a_joint_narrower_than_a_texel_has_its_width_wherever_the_texels_lie(joint, shift):
    width_m = 2 * joint.half_m * (1 - 0.5 * joint.softness)
    texel_m = 1.25 * width_m
    assert _sampled_width_m(widened(joint, texel_m, 0.5 * TILE_M), texel_m, shift) == pytest.approx(width_m)


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("shift", [0.0, 0.2, 0.5, 0.9])
def test_a_wider_joint_has_it_but_for_a_tenth_of_a_texel_at_each_edge(joint, shift):
    """A sample in a step has the value of a smooth step, which differs from that of a straight one by up to 0.096."""
    width_m = 2 * joint.half_m * (1 - 0.5 * joint.softness)
    texel_m = 0.6 * width_m
    assert _sampled_width_m(widened(joint, texel_m, 0.5 * TILE_M), texel_m, shift) == pytest.approx(
        width_m, abs=2 * 0.097 * texel_m
    )


def test_a_joint_that_is_wider_than_its_texels_remains_as_it_is():
    joint = JointProfile(0.003, 0.5)
    assert widened(joint, 0.001, TILE_M) == joint


def test_a_joint_ends_in_the_middle_of_a_narrow_tile_and_keeps_its_mean():
    wide = widened(JointProfile(0.002, 0.0), 0.2, 0.5 * TILE_M)
    assert wide.half_m == 0.5 * TILE_M
    across_m = np.linspace(-0.5 * TILE_M, 0.5 * TILE_M, 10001)
    assert _value(wide, across_m).mean() * TILE_M == pytest.approx(0.004, rel=0.001)
