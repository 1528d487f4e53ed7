"""The five experiments of the paper with the simulated range sensor."""

from functools import partial

from configs.schema.arena import SurfaceName
from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ValidatedPart
from diagnosis.validation.range_sensor.engine_rays import engine_rays
from diagnosis.validation.range_sensor.field_of_view import field_of_view
from diagnosis.validation.range_sensor.paper import DISTANCES_MM, STEP_HEIGHT_MM, TABLE_3, TABLE_4
from diagnosis.validation.range_sensor.stand import SensorOnStand, target
from diagnosis.validation.range_sensor.step import step
from diagnosis.validation.range_sensor.surfaces import materials, tones
from diagnosis.validation.range_sensor.tilt import ANGLES_DEG, tilt
from symolo.core.errors import InputError

READINGS = 5001
"""Readings of each surface at 100 mm, as in the paper."""
READINGS_ELSEWHERE = 60
"""Readings of each surface at every other distance, and at each angle of tilt."""


def range_sensor(readings: int = READINGS) -> ValidatedPart:
    """Return experiments 1 to 5 with the robot's sensor and all effects that act on it.

    Args:
        readings: Readings of each surface at 100 mm; no more than these are taken anywhere else.
    """
    elsewhere = min(readings, READINGS_ELSEWHERE)
    counts = (readings, elsewhere)
    return ValidatedPart(
        "range-sensor",
        (
            Experiment("tones", "Experiment 1: boards of four tones (Table 3).", partial(tones, counts=counts)),
            Experiment("materials", "Experiment 2: five materials (Table 4).", partial(materials, counts=counts)),
            Experiment(
                "step", "Experiment 3: the sensor moved across the edge of a box of 106 mm (paper Fig. 17).", step
            ),
            Experiment(
                "tilt", "Experiment 4: the sensor tilted in place (paper Fig. 18).", partial(tilt, readings=elsewhere)
            ),
            Experiment("field_of_view", "Experiment 5: width of the spot on a board (paper Fig. 19).", field_of_view),
            Experiment("engine_rays", "The same readings with the rays of PyBullet.", engine_rays),
        ),
        require_sight,
    )


def require_sight(robot: RobotConfig) -> None:
    """Refuse a sensor that does not see the boards of the experiments.

    Raises:
        InputError: It loses every reading, or sees no board at a distance or an angle that the experiments need.
    """
    if robot.tof.dropout_probability == 1.0:
        raise InputError("robot.tof.dropout_probability", got=1.0, allowed="below 1 for a sensor in an experiment")
    noiseless = SensorOnStand.from_robot(robot, seed=0).without_noise()
    for surface in (*TABLE_3, *TABLE_4):
        _see(noiseless, 100.0, surface, 0.0)
    for distance_mm in DISTANCES_MM:
        _see(noiseless, distance_mm, "white_board", ANGLES_DEG[-1])
        _see(noiseless, distance_mm + STEP_HEIGHT_MM, "white_board", 0.0)


def _see(mounted: SensorOnStand, distance_mm: float, surface: SurfaceName, yaw_deg: float) -> None:
    mounted.facing(target(1e-3 * distance_mm, surface), "check").seen_mm(distance_mm, yaw_deg=yaw_deg)
