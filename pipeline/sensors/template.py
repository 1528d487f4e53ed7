"""A file with a sensor of one's own to begin with."""

from pipeline.code_files import new_class_name
from sensors.registry import SENSORS
from symolo.core.errors import InputError
from symolo.dataset.tables.sensor_tables import TAKEN_NAMES

TEXT = '''"""An example of a sensor, a compass: change it to the sensor that you have."""

import numpy as np
from pydantic import Field

from configs.robot_sensors import SensorSettings
from sensors.base import Reading, Sensor, World
from symolo.dataset.tables.column import Column

# The name of the class in lower case is the kind of the sensor: robot.sensors.{name}
# `symolo sensor check` tests the file and explains each rule.


class {class_name}(Sensor):
    """Heading of the robot, measured with a compass."""  # the meaning of the table side/{name}.csv

    class Settings(SensorSettings):  # period_s and delay_s are there; MountedSettings adds a place on the robot
        """Mounting and noise."""

        offset_deg: float = Field(default=0.0, ge=-180, le=180)
        """Rotation of the compass on the robot, counter-clockwise."""
        noise_deg: float = Field(default=1.0, ge=0, le=90)
        """Standard deviation of one sample."""

    # Name, unit, digits after the point in the file (0 for whole numbers) and meaning of each column.
    columns = (Column("heading", "rad", 4, "heading from +x of W, counter-clockwise, in (-pi, pi]"),)

    def sample(self, world: World) -> Reading:
        # One finite number for each column. Take random numbers from self.rng only, and keep what you must remember in
        # self, never in the class or the module. The page docs/sensors.md lists what `world` has.
        _, _, yaw_rad = world.pose()
        error_deg = self.settings.offset_deg + self.settings.noise_deg * self.rng.standard_normal()
        heading_rad = yaw_rad + np.radians(error_deg)
        return np.array([-np.angle(np.exp(-1j * heading_rad))])
'''


def template(name: str) -> str:
    """Return the text of a file with one sensor that keeps the contract.

    Raises:
        InputError: The name cannot be that of a sensor, or a shipped sensor or another table has it.
    """
    if name in TAKEN_NAMES:
        raise InputError("NAME", got=name, cure="the name is taken by another file of side/; take another one")
    return TEXT.format(name=name, class_name=new_class_name(name, SENSORS, "compass"))
