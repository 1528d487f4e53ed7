"""The robot of a measurement before anything is fitted: nominal parameters, and the tolerances between units."""

from dataclasses import replace

from configs.loader import shipped_robot
from configs.schema.robot import RobotConfig
from diagnosis.importers.cases.drive_checks import CountedWheels, drive_checks
from diagnosis.measured.case_files.nominal import NominalLog
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import Nuisance, command_timing, creep_on_the_spot, nuisances
from diagnosis.together import joint_robot
from diagnosis.usual_tolerances import usual, usual_of_log
from logs.columns.drive import COUNTED


def base_robot_of(measurement: Measurement, robot: RobotConfig | None) -> RobotConfig:
    """Return the robot whose parameters the measurement replaces where it defines them; the shipped one by default."""
    if isinstance(measurement.nominal, NominalLog):
        return measurement.nominal.robot
    return robot or shipped_robot()


def nominal_of(measurement: Measurement, base_robot: RobotConfig) -> RobotConfig:
    """Return a robot with the nominal parameters of the measurement."""
    if measurement.cases:
        return joint_robot(measurement, base_robot)
    return base_robot if measurement.nominal is None else nominal_robot(measurement.nominal, base_robot)


def spreads_of(measurement: Measurement, robot: RobotConfig) -> tuple[Nuisance, ...]:
    """Return the nuisances that the measurement states, or else the usual ones."""
    if (case := measurement.nominal) is not None:
        return usual_of_log(case) if isinstance(case, NominalLog) else nuisances(case)
    drive_nuisances = (command_timing(), creep_on_the_spot()) if measurement.kind is CaseKind.DRIVE_LOG else ()
    return (*usual(robot), *drive_nuisances)


def checked_against(measurement: Measurement, robot: RobotConfig) -> Measurement:
    """Return the measurement; if it states no robot, with this one and with notes on what does not fit to it.

    Importers of measured cases have written such notes by the robot of the case.
    """
    if measurement.nominal is not None or measurement.kind is not CaseKind.DRIVE_LOG or not measurement.has(*COUNTED):
        return measurement
    drive, ticks = robot.drive, robot.encoder.counts_per_revolution
    is_shipped = robot == base_robot_of(measurement, None)
    origin = "the shipped robot, because the data state none" if is_shipped else "the robot of the command"
    text = (
        f"compared with {origin}: wheels of {1000.0 * drive.wheel_diameter_m:.4g} mm, {1000.0 * drive.track_m:.4g} mm "
        f"apart, {ticks:g} ticks per turn{'; name another one with --nominal' if is_shipped else ''}"
    )
    checks = drive_checks(CountedWheels(0.5 * drive.wheel_diameter_m, ticks, drive.track_m), measurement)
    return replace(measurement, compared_with=text, notes=(*checks, *measurement.notes))
