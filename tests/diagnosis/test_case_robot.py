"""The robot with which a drive is compared whose log states none."""

from dataclasses import replace

import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.case_robot import checked_against
from diagnosis.examples.example import FOLDER
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.nominal_robot import nominal_robot


@pytest.fixture(scope="module")
def drive():
    return read_measurement(FOLDER / "drive_log_001", IMPORTERS)


@pytest.fixture(scope="module")
def shipped():
    return draw_robot(load_section("robot", "nominal"), 0, "diagnosis")[0]


def test_the_robot_is_named_and_checked_only_where_the_data_state_none(drive, shipped):
    assert checked_against(drive, shipped) is drive
    compared = checked_against(replace(drive, nominal=None, notes=()), shipped)
    assert compared.compared_with == (
        "compared with the shipped robot, because the data state none: wheels of 65 mm, 140 mm apart, 3840 ticks per "
        "turn; name another one with --nominal"
    )


def test_wheels_that_do_not_fit_to_the_pose_are_a_check(drive, shipped):
    """A quarter of the ticks per turn makes the wheels' path four times as long."""
    right = nominal_robot(drive.nominal, shipped)
    quarter = right.with_section("encoder", {"counts_per_revolution": right.encoder.counts_per_revolution // 4})
    bare = replace(drive, nominal=None, notes=())
    assert checked_against(bare, right).checks == ()
    compared = checked_against(bare, quarter)
    assert compared.compared_with.startswith("compared with the robot of the command: wheels of")
    (check,) = compared.checks
    assert "4 times as many" in check
