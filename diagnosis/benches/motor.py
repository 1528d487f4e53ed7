"""The motor bench: steady states beside Table 1."""

from dataclasses import dataclass

from configs.schema.robot import RobotConfig
from diagnosis.benches.motor_steady import Candidate, SteadyBench, steady_bench
from physics.robot_model import RobotModel


@dataclass(frozen=True)
class MotorBench:
    steady: SteadyBench


def motor_bench(robot: RobotConfig) -> MotorBench:
    """Everything that the bench measures on the robot's right motor, with all of the robot's terms."""
    return MotorBench(steady=steady_bench(RobotModel.from_config(robot)))


def summary(bench: MotorBench) -> list[str]:
    """A short table for people, a line each."""
    steady = bench.steady
    head = f"{'against Table 1':26}{'rms':>10}{'largest':>10}{'rms':>10}{'largest':>10}"
    rows = [_residuals(found) for found in (steady.robot, steady.literal_fit, steady.printed_variant, steady.table_2)]
    return [f"{'':26}{'speed, rad/s':>20}{'current, mA':>20}", head, *rows]


def _residuals(found: Candidate) -> str:
    speed, current = found.speed_residual_rad_s, found.current_residual_A
    return (
        f"{found.name:26}{speed.rms:10.3f}{speed.largest:+10.3f}{1e3 * current.rms:10.2f}{1e3 * current.largest:+10.2f}"
    )
