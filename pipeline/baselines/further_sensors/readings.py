"""The readings of `robot.sensors` that methods use: of one IMU, one lidar and one pair of cameras."""

from collections.abc import Callable
from dataclasses import dataclass

from configs.robot_sensors import RobotSensors
from pipeline.baselines.further_sensors.imu_log import ImuLog
from pipeline.baselines.further_sensors.lidar_log import LidarLog
from pipeline.baselines.further_sensors.stereo_log import StereoLog
from sensors.inertial.imu import Imu, ImuSettings
from sensors.ranging.lidar import Lidar, LidarSettings
from symolo.core.arrays import Array
from symolo.dataset.tables.side_tables import SideTable


@dataclass(frozen=True)
class FurtherReadings:
    """Readings beside those of data.csv; None for a kind of sensor that the robot does not have.

    Of several sensors of a kind it is the first by name.
    """

    imu: ImuLog | None = None
    lidar: LidarLog | None = None
    stereo: StereoLog | None = None

    @classmethod
    def from_tables(
        cls, sensors: RobotSensors, numbers_of: Callable[[SideTable], Array], stereo: StereoLog | None = None
    ) -> "FurtherReadings":
        """Return the readings of a robot.

        Args:
            sensors: The sensors in the description of the robot.
            numbers_of: Function that returns the numbers (samples, columns) in the table of a sensor.
            stereo: The images of a rectified pair.
        """
        imu, lidar = None, None
        for name, settings in sensors:
            if imu is None and isinstance(settings, ImuSettings):
                imu = ImuLog.from_table(settings, numbers_of(Imu.table(name, settings)))
            elif lidar is None and isinstance(settings, LidarSettings):
                lidar = LidarLog.from_table(settings, numbers_of(Lidar.table(name, settings)))
        return cls(imu, lidar, stereo)
