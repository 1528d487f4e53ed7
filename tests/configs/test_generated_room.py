"""Random arenas that are too small for the robot: refused with a remedy, and accepted once it is applied."""

import re

import pytest

from configs.loader import load_scenario
from symolo.core.errors import FaultsError, InputError


def refusals(settings):
    with pytest.raises((InputError, FaultsError)) as error:
        load_scenario("random_arenas", settings)
    return [str(fault) for fault in getattr(error.value, "faults", [error.value])]


@pytest.mark.parametrize(
    ("settings", "names", "scale"),
    [
        # 0.6 of the width is 0.24 m of 0.16 m; 0.19 m and half the diagonal are 0.409 m of 0.35 m.
        (["robot.chassis.width_m=0.4"], ["beside_m: too little", "passing_m: too little"], "2.36"),
        # 0.6 of the width is 0.168 m; half the diagonal is 0.166 m, and nothing is passed.
        (
            ["robot.chassis.width_m=0.28", "arena.generate.min_obstacles=0", "arena.generate.max_obstacles=0"],
            ["beside_m: too"],
            "1.65",
        ),
        # Half the diagonal is 0.190 m.
        (["robot.chassis.length_m=0.34"], ["passing_m: too little room"], "1.89"),
    ],
)
def test_a_random_arena_that_is_too_small_for_the_robot_is_refused_with_the_scale_that_fits(settings, names, scale):
    messages = refusals(settings)
    assert len(messages) == len(names)
    for name, message in zip(names, messages, strict=True):
        assert name in message
        assert f"such as `arena: {{extends: random, scale: {scale}}}`" in message
        assert "--set robot.chassis" in message
    body = [setting for setting in settings if setting.startswith("robot")]
    load_scenario("random_arenas", [*body, f"arena={{extends: random, scale: {scale}}}"])


def test_robots_up_to_the_nominal_size_and_scaled_arenas_are_as_before():
    for robot in ("nominal", "fleet", "worn", "micromouse"):
        load_scenario("random_arenas", [f"robot={robot}"])
    load_scenario("random_arenas", ["robot=scout", "arena={extends: random, scale: 1.95}"])


SIDE = "robot.controller.avoidance.side_m"
PASSING, BESIDE = (f"arena.generate.clearance.{name}" for name in ("passing_m", "beside_m"))


def settings_of(length_m, width_m, *others):
    return [*others, f"robot.chassis.length_m={length_m}", f"robot.chassis.width_m={width_m}"]


def remedies(messages):
    """Ways to repair an arena, each as the last settings of a command, by the advice of the messages alone."""
    scales = {scale for text in messages for scale in re.findall(r"extends: random, scale: ([0-9.]+)", text)}
    assert len(scales) <= 1
    scaled = [f"arena={{extends: random, scale: {scale}}}" for scale in scales]
    limits = [limit for text in messages for limit in re.findall(r"(\S+) to ([0-9.]+) or (more|less)", text)]
    clearances = [f"{name}={number}" for name, number, way in limits if way == "more"]
    yield scaled, clearances
    for name, number, way in limits:
        if way == "less":
            yield scaled, [*(item for item in clearances if not item.startswith(PASSING)), f"{name}={number}"]


@pytest.mark.parametrize(
    "settings",
    [
        [f"{SIDE}=0.4"],
        [f"{SIDE}=0.23"],
        [f"{PASSING}=0.2"],
        [f"{PASSING}=0.3", f"{SIDE}=0.35"],
        [f"{BESIDE}=0.05"],
        [f"{BESIDE}=0.05", f"{PASSING}=0.05"],
        settings_of(0.2, 0.19, f"{SIDE}=0.9"),
        settings_of(0.5, 0.17, f"{PASSING}=0.4"),
        settings_of(0.4, 0.5, f"{PASSING}=0.7", f"{BESIDE}=0.1", f"{SIDE}=0.6"),
        settings_of(0.17, 0.165, f"{SIDE}=0.31"),
        settings_of(1.0, 1.0, f"{SIDE}=1.0"),
        settings_of(1.0, 1.0, f"{BESIDE}=0.2", "arena.generate.max_obstacles=0", "arena.generate.min_obstacles=0"),
        ["arena={extends: random, scale: 0.5}"],
        ["arena={extends: random, scale: 1.5}", f"{SIDE}=0.45"],
        settings_of(0.7, 0.5, "arena={extends: random, scale: 1.5}"),
        settings_of(0.36, 0.34, "arena={extends: random, scale: 2}", f"{PASSING}=0.3"),
        settings_of(0.36, 0.34, "arena={extends: random, scale: 2}", f"{SIDE}=0.6"),
    ],
)
def test_an_arena_is_accepted_after_any_remedy_of_its_refusal(settings):
    own = [text for text in settings if not text.startswith("arena={")]
    messages = refusals(settings)
    for scaled, limits in remedies(messages):
        assert scaled or limits
        arena = scaled or [text for text in settings if text.startswith("arena={")]
        load_scenario("random_arenas", [*arena, *own, *limits])


@pytest.mark.parametrize(
    ("settings", "advice"),
    [
        # 0.4 m and half the diagonal, 0.1238 m, are 0.5238 m; 0.35 m less half the diagonal is 0.2262 m.
        ([f"{SIDE}=0.4"], f"set {PASSING} to 0.524 or more, or {SIDE} to 0.226 or less"),
        # 0.19 m and half the diagonal; a path of 0.076 m would lead through the obstacle.
        ([f"{PASSING}=0.2"], f"set {PASSING} to 0.314 or more"),
        # 0.6 of 0.17 m.
        ([f"{BESIDE}=0.05"], f"set {BESIDE} to 0.102 or more"),
    ],
)
def test_a_body_no_larger_than_that_of_nominal_is_not_blamed(settings, advice):
    (message,) = refusals(settings)
    assert message.endswith(advice)
    assert "scale" not in message
