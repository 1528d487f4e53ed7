"""The places of a driving robot between its wheels and its logged pose: travel, turning, and the logged heading."""

from collections.abc import Iterator

from configs.effects.base import Slot
from diagnosis.discovery.place import MAX_FACTOR, TIMES, LawPlace, QuantityRead, varying
from diagnosis.inference.evidence.evidence import Evidence

SETUPS = ("Setup.DRIVE",)
FLOOR = "from physics.robot.floor_place import FloorPlace"
AT_WHEEL = "from physics.robot.floor_place import FloorPlace, at_wheel"


def pose_places(evidence: Evidence) -> Iterator[LawPlace]:
    """Yield the places of a robot whose counts and poses are logged."""
    names = {observed.name for observed in evidence.observed if observed.usable.any()}
    if not {"pose_dx_m", "pose_dtheta_rad"} <= names:
        return
    forward, turn = (QuantityRead(evidence, name, drives=True) for name in ("pose_dx_m", "pose_dtheta_rad"))
    travel = LawPlace(
        Slot.TRAVEL,
        prefix="travel",
        noun="the travel of the wheels",
        first="share",
        arguments="share: Array, place: FloorPlace",
        unit="1",
        size=min(forward.visible / forward.typical, MAX_FACTOR),
        covariates=varying((forward.time("place.time_s"), *forward.place("place"))),
        imports=(FLOOR,),
        setups=SETUPS,
        is_factor=True,
    )
    yield travel
    for side in ("left", "right"):
        noun = f"the travel of the {side} wheel"
        yield travel.at(side, f'at_wheel("{side}", share)', noun, *TIMES, imports=(AT_WHEEL,))
    yield LawPlace(
        Slot.TURNING,
        prefix="turning",
        noun="the turning of the robot",
        first="share",
        arguments="share: Array, place: FloorPlace",
        unit="1",
        size=min(turn.visible / turn.typical, MAX_FACTOR),
        covariates=varying((turn.time("place.time_s"),)),
        imports=(FLOOR,),
        setups=SETUPS,
        is_factor=True,
    )
    yaw = turn.covariate("theta_rad", "yaw", "yaw of the robot [rad]", "rad", "yaw_rad", is_angle=True)
    yield LawPlace(
        Slot.POSE_HEADING,
        prefix="heading",
        noun="the logged heading",
        first="error_rad",
        arguments="error_rad: Array, yaw_rad: Array, time_s: float | Array",
        unit="rad",
        size=turn.visible,
        covariates=varying((yaw, turn.time("time_s"))),
        imports=(),
        setups=SETUPS,
    )
