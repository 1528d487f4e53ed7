"""The motor bench: a robot's right motor with rotor and gearbox, off load, beside Table 1 and closed forms."""

from dataclasses import dataclass

from configs.schema.robot import RobotConfig
from diagnosis.validation.motor.energy import EnergyBench, energy_bench
from diagnosis.validation.motor.steady_states import Candidate, SteadyBench, steady_bench
from diagnosis.validation.motor.steps import StepBench, step_bench
from diagnosis.validation.motor.stiction import StictionBench, stiction_bench
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.robot.model import RobotModel
from symolo.core.errors import InputError


@dataclass(frozen=True)
class MotorBench:
    steady: SteadyBench
    steps: StepBench
    stiction: StictionBench
    energy: EnergyBench


def check_motor(robot: RobotConfig) -> None:
    """Refuse a motor that cannot be on a bench.

    Raises:
        InputError: Its rotor has no inertia, so that off load nothing has a time constant.
    """
    if robot.motor.rotor_inertia_kg_m2 == 0.0:
        raise InputError("robot.motor.rotor_inertia_kg_m2", got=0.0, allowed="above 0 for a motor off load")


def motor_bench(robot: RobotConfig) -> MotorBench:
    """Everything that the bench measures; all but the energy with the robot's effects."""
    model = RobotModel.from_config(robot)
    return MotorBench(
        steady=steady_bench(model),
        steps=step_bench(model),
        stiction=stiction_bench(model),
        energy=energy_bench(model.motors.right, voltage_limit_V(robot.power)),
    )


def summary(bench: MotorBench) -> list[str]:
    """A short table for people, a line each."""
    return [*_steady_lines(bench.steady), "", *_step_lines(bench.steps), "", *_rest_lines(bench)]


def _steady_lines(steady: SteadyBench) -> list[str]:
    candidates = (steady.robot, steady.literal_fit, steady.printed_variant, steady.table_2)
    numbers = f"{'R':>8}{'K':>8}{'B':>9}{'Tq':>8}{'speed, rad/s':>17}{'current, mA':>17}"
    units = f"{'ohm':>8}{'N m/A':>8}{'N m s':>9}{'N m':>8}" + 2 * f"{'rms':>8}{'worst':>9}"
    return [f"{'model less Table 1':26}{numbers}", f"{'':26}{units}", *map(_candidate_line, candidates)]


def _candidate_line(found: Candidate) -> str:
    speed, current, of = found.speed_residual_rad_s, found.current_residual_A, found.parameters
    return (
        f"{found.name:26}{of.winding_resistance_ohm:8.4f}{of.torque_constant_N_m_A:8.4f}"
        f"{of.viscous_friction_N_m_s_rad:9.5f}{of.coulomb_friction_N_m:8.4f}"
        f"{speed.rms:8.3f}{speed.largest:+9.3f}{1e3 * current.rms:8.2f}{1e3 * current.largest:+9.2f}"
    )


def _step_lines(steps: StepBench) -> list[str]:
    closed = _ms(steps.time_constant_s + steps.input_delay_s) + _ms(steps.rise_10_90_percent_s)
    lines = [
        f"{'step from rest':26}{'settles at':>15}{'63 % after':>15}{'10-90 % in':>15}",
        f"{'closed form':41}{closed}",
    ]
    for response in steps.responses:
        times = _ms(response.time_to_63_percent_s) + _ms(response.rise_10_90_percent_s)
        lines.append(f"{response.voltage_V:<5.2f} V{'':19}{response.settled_rad_s:9.3f} rad/s{times}")
    return lines


def _ms(time_s: float | None) -> str:
    return f"{'-':>15}" if time_s is None else f"{1e3 * time_s:12.2f} ms"


def _rest_lines(bench: MotorBench) -> list[str]:
    stiction, energy = bench.stiction, bench.energy
    breaks = f"{_mV(stiction.breakaway_V)}, closed form {_mV(stiction.breakaway_closed_form_V)}"
    stops = f"{_mV(stiction.stops_V)}, closed form {_mV(stiction.stops_closed_form_V)}"
    held = f"fastest wheel held below breakaway: {stiction.fastest_held_rad_s} rad/s"
    balance = f"{energy.throughput_J:.3f} J of electrical work, imbalance {1e6 * energy.largest_imbalance_J:.2g} uJ"
    return [
        f"breaks away at {breaks}; stops at {stops}; known to {_mV(stiction.resolution_V)}",
        f"{held}; voltage to and fro: {stiction.starts} starts, {stiction.reversals} reversals",
        f"energy: {balance}, least friction heat in a row {energy.min_friction_heat_J:.2g} J",
    ]


def _mV(voltage_V: float | None) -> str:
    return "-" if voltage_V is None else f"{1e3 * voltage_V:.1f} mV"
