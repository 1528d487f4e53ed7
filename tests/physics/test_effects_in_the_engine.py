"""Motor and drive effects in PyBullet, against closed forms."""

import math
from pathlib import Path

import numpy as np
import pytest

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from configs.schema.scenario import Rates
from physics.bullet.simulation import BulletSimulation
from physics.effects.driver_and_battery.actuator_lag import ActuatorLag
from physics.effects.driver_and_battery.battery_decline import BatteryDecline
from physics.effects.driver_and_battery.bridge_coast import BridgeCoast
from physics.effects.driver_and_battery.bridge_voltage_drop import BridgeVoltageDrop
from physics.effects.driver_and_battery.current_limit import CurrentLimit
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.encoders.encoder_missed_ticks import EncoderMissedTicks
from physics.effects.encoders.encoder_ticks_scale import EncoderTicksScale
from physics.effects.motor_and_gearbox.coulomb_friction_scale import CoulombFrictionScale
from physics.effects.motor_and_gearbox.friction_asymmetry import FrictionAsymmetry
from physics.effects.motor_and_gearbox.friction_warmup import FrictionWarmup
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from physics.effects.motor_and_gearbox.quadratic_drag import QuadraticDrag
from physics.effects.motor_and_gearbox.rotor_inertia_scale import RotorInertiaScale
from physics.effects.motor_and_gearbox.stribeck_friction import StribeckFriction
from physics.effects.motor_and_gearbox.torque_constant_mismatch import TorqueConstantMismatch
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.effects.motor_and_gearbox.viscous_friction_scale import ViscousFrictionScale
from physics.effects.motor_and_gearbox.winding_resistance_scale import WindingResistanceScale
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.random_slip import RandomSlip
from physics.effects.wheels_and_floor.turn_slip import TurnSlip
from physics.effects.wheels_and_floor.wheel_eccentricity import WheelEccentricity
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from pipeline.effects.template import template
from symolo.core.errors import InputError

TICKS = 3840


@pytest.fixture
def simulate_with(simulate, robot):
    """Make simulations of the nominal robot with effects on an empty floor."""

    def make(*several, lifted=False):
        changed = robot
        for effect in several:
            changed = changed.with_effect(effect)
        return simulate(robot=changed, lifted=lifted)

    return make


def travelled(simulation):
    """Wheel angles, right and left [rad]."""
    return np.array([state[0] for state in simulation._wheel_states()])


class TestMotorsOffLoad:
    @pytest.fixture
    def settled(self, simulate_with):
        def settle(voltage, *several):
            simulation = simulate_with(*several, lifted=True)
            simulation.set_voltages(voltage, voltage)
            simulation.advance(1500)
            return simulation.currents()[0], simulation.wheel_speeds()[0]

        return settle

    @pytest.mark.parametrize("voltage", [4.0, -2.0])
    @pytest.mark.parametrize(
        ("effect", "resistance", "constant", "viscous", "coulomb"),
        [
            (WindingResistanceScale(scale=1.3), 1.3, 1.0, 1.0, 1.0),
            (TorqueConstantScale(scale=0.9), 1.0, 0.9, 1.0, 1.0),
            (TorqueConstantMismatch(mismatch=0.2), 1.0, 0.9, 1.0, 1.0),
            (ViscousFrictionScale(scale=2.0), 1.0, 1.0, 2.0, 1.0),
            (CoulombFrictionScale(scale=1.8), 1.0, 1.0, 1.0, 1.8),
            (FrictionWarmup(amplitude=0.5, time_constant_s=10_000.0), 1.0, 1.0, 1.0, 1.5),
        ],
        ids=lambda item: type(item).__name__,
    )
    def test_scales(self, settled, robot, voltage, effect, resistance, constant, viscous, coulomb):
        nominal = robot.motor
        r, k = resistance * nominal.winding_resistance_ohm, constant * nominal.torque_constant_N_m_A
        b, tc = viscous * nominal.viscous_friction_N_m_s_rad, coulomb * nominal.coulomb_friction_N_m
        speed = (k * voltage / r - math.copysign(tc, voltage)) / (k**2 / r + b)
        assert settled(voltage, effect) == pytest.approx(((voltage - k * speed) / r, speed), rel=2e-4)

    def test_windings_that_change(self, simulate_with, robot):
        """A warm winding, an old magnet and a loose plug after some seconds, each with the law of its template."""
        slots = {Slot.WINDING_HEAT: 0.02, Slot.TORQUE_CONSTANT: 0.01, Slot.RESISTANCE: 0.01}
        kinds = [EFFECTS.executed(Path("law.py"), template(f"law{k}", slot).encode()) for k, slot in enumerate(slots)]
        laws = [
            kind.start().model_copy(update={next(iter(kind.parameters())): value})
            for kind, value in zip(kinds, slots.values(), strict=True)
        ]
        simulation = simulate_with(*laws, lifted=True)
        simulation.set_voltages(4.0, 4.0)
        simulation.advance(400)
        m, t = robot.motor, simulation.time_s
        r = m.winding_resistance_ohm * (1.0 + 0.02 * 16.0 * -math.expm1(-t / 60.0)) * (1.0 + 0.01 * t)
        k = m.torque_constant_N_m_A / (1.0 + 0.01 * t)
        speed = (k * 4.0 / r - m.coulomb_friction_N_m) / (k**2 / r + m.viscous_friction_N_m_s_rad)
        assert simulation.wheel_speeds()[0] == pytest.approx(speed, rel=3e-3)
        assert simulation.currents()[0] == pytest.approx((4.0 - k * speed) / r, rel=1e-2)

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_bridge_supply_and_friction(self, settled, robot, sign):
        """The torque balance of the definitions at whatever speed the engine has settled."""
        m, supply_V = robot.motor, robot.power.battery_voltage_V
        several = (
            BridgeVoltageDrop(drop_V=0.4),
            SupplySag(source_resistance_ohm=0.6),
            FrictionAsymmetry(asymmetry=0.2),
            StribeckFriction(extra_torque_N_m=0.01, stribeck_speed_rad_s=9.0),
            QuadraticDrag(coefficient_N_m_s2_rad2=1e-4),
        )
        current, speed = settled(sign * 4.0, *several)
        assert abs(speed) > 4.0
        duty = 4.0 / supply_V
        sagged = duty * (supply_V - 0.6 * 2.0 * duty * abs(current))
        across = sagged - m.torque_constant_N_m_A * abs(speed) - 0.4
        assert abs(current) == pytest.approx(across / m.winding_resistance_ohm, rel=1e-6)
        friction = m.coulomb_friction_N_m * (1.0 - 0.2 * sign) + 0.01 * math.exp(-((speed / 9.0) ** 2))
        friction += 1e-4 * speed**2 + m.viscous_friction_N_m_s_rad * abs(speed)
        assert m.torque_constant_N_m_A * abs(current) == pytest.approx(friction, rel=1e-4)

    def test_a_declining_battery_slows_the_wheels(self, simulate_with, robot):
        simulation = simulate_with(BatteryDecline(fraction_per_minute=1.0), lifted=True)
        simulation.set_voltages(4.0, 4.0)
        simulation.advance(12_000)
        m = robot.motor
        r, k = m.winding_resistance_ohm, m.torque_constant_N_m_A
        damping = k**2 / r + m.viscous_friction_N_m_s_rad
        # The voltage falls by a sixtieth each second; the speed follows a time constant behind.
        late_s = m.rotor_inertia_kg_m2 / damping
        expected = (k * 4.0 * (1.0 - (12.0 - late_s) / 60.0) / r - m.coulomb_friction_N_m) / damping
        assert simulation.wheel_speeds()[0] == pytest.approx(expected, rel=1e-3)

    def test_a_declining_battery_leaves_a_coasting_bridge_its_duty(self, simulate, robot):
        """At full duty there is no off time, so that coasting changes nothing."""
        power = robot.power.model_copy(update={"motor_voltage_limit_V": robot.power.battery_voltage_V})
        declines = robot.model_copy(update={"power": power}).with_effect(BatteryDecline(fraction_per_minute=1.0))
        speeds = []
        for several in (declines, declines.with_effect(BridgeCoast(inductance_H=5e-4, diode_V=1.0))):
            simulation = simulate(robot=several, lifted=True)
            simulation.set_voltages(robot.power.battery_voltage_V, robot.power.battery_voltage_V)
            simulation.advance(6_000)
            speeds.append(simulation.wheel_speeds()[0])
        assert speeds[1] == pytest.approx(speeds[0], rel=1e-6)

    def test_a_current_limit_holds_in_a_reversal(self, simulate_with):
        simulation = simulate_with(CurrentLimit(limit_A=0.7), lifted=True)
        found = []
        for voltage in (5.0, -5.0):
            simulation.set_voltages(voltage, -voltage)
            for _ in range(50):
                simulation.advance(5)
                found.append(simulation.currents())
        assert np.abs(found).max() == pytest.approx(0.7)
        assert np.min(found) == -np.max(found)

    def test_breakaway_is_at_both_torques(self, simulate_with, robot):
        m = robot.motor
        breakaway = (m.coulomb_friction_N_m + 0.01) * m.winding_resistance_ohm / m.torque_constant_N_m_A
        for share, moves in ((0.98, False), (1.02, True)):
            simulation = simulate_with(StribeckFriction(extra_torque_N_m=0.01, stribeck_speed_rad_s=0.2), lifted=True)
            simulation.set_voltages(share * breakaway, -share * breakaway)
            simulation.advance(1000)
            assert (abs(travelled(simulation)[0]) > 0.01) == moves

    def test_a_command_acts_after_its_delay(self, simulate_with):
        late, prompt = simulate_with(InputDelay(delay_s=0.037)), simulate_with()
        for simulation in (late, prompt):
            simulation.set_voltages(3.0, 3.0)
        late.advance(37)
        assert np.abs(travelled(late)).max() < 1e-6
        late.advance(100)
        prompt.advance(100)
        np.testing.assert_allclose(travelled(late), travelled(prompt), rtol=1e-3)

    def test_a_lagging_actuator_moves_the_wheels_late_by_its_time_constant(self, simulate_with):
        lagging = simulate_with(ActuatorLag(time_constant_s=0.05), lifted=True)
        prompt = simulate_with(lifted=True)
        for simulation in (lagging, prompt):
            simulation.set_voltages(3.0, -3.0)
            simulation.advance(1000)
        behind = (travelled(prompt) - travelled(lagging)) / prompt.wheel_speeds()
        assert behind == pytest.approx(0.05, abs=0.003)

    def test_inertia_stretches_the_run_up(self, simulate_with, robot):
        heavy, nominal = simulate_with(RotorInertiaScale(scale=2.0), lifted=True), simulate_with(lifted=True)
        for simulation in (heavy, nominal):
            simulation.set_voltages(3.0, -3.0)
            simulation.advance(1000)
        m = robot.motor
        damping = m.torque_constant_N_m_A**2 / m.winding_resistance_ohm + m.viscous_friction_N_m_s_rad
        behind = (travelled(nominal)[0] - travelled(heavy)[0]) / nominal.wheel_speeds()[0]
        assert behind == pytest.approx(m.rotor_inertia_kg_m2 / damping, rel=0.03)

    def test_backlash_is_refused(self, simulate_with):
        with pytest.raises(InputError, match="one mass"):
            simulate_with(GearBacklash(gap_rad=0.02))


class TestDriving:
    def test_larger_wheels_go_further_than_odometry_believes(self, simulate_with, robot):
        simulation = simulate_with(WheelRadiusScale(scale=1.04))
        simulation.set_voltages(2.0, 2.0)
        simulation.advance(3000)
        believed = np.mean(simulation.encoder_counts()) / TICKS * math.pi * robot.drive.wheel_diameter_m
        assert simulation.pose()[0] == pytest.approx(1.04 * believed, rel=1e-3)

    def test_unlike_wheels_turn_the_robot_by_the_difference_of_their_travel(self, simulate_with, robot):
        simulation = simulate_with(WheelRadiusAsymmetry(asymmetry=0.04))
        simulation.set_voltages(2.0, 2.0)
        simulation.advance(3000)
        right, left = travelled(simulation) * 0.5 * robot.drive.wheel_diameter_m
        expected = (0.98 * right - 1.02 * left) / robot.drive.track_m
        assert simulation.pose()[2] == pytest.approx(expected, rel=5e-3)
        assert simulation.pose()[2] < -0.1

    def test_a_wider_wheelbase_turns_less(self, simulate_with, robot):
        simulation = simulate_with(WheelbaseScale(scale=1.1))
        simulation.set_voltages(1.5, -1.5)
        simulation.advance(3000)
        right, left = travelled(simulation) * 0.5 * robot.drive.wheel_diameter_m
        assert simulation.pose()[2] == pytest.approx((right - left) / (1.1 * robot.drive.track_m), rel=2e-3)

    @pytest.mark.parametrize("voltages", [(3.0, 2.0), (1.6, 2.6)])
    def test_slip_takes_its_share_of_a_turn(self, simulate_with, robot, voltages):
        simulation = simulate_with(TurnSlip(coefficient_s2_m=0.8))
        simulation.set_voltages(*voltages)
        simulation.advance(1000)
        begin_yaw, begin = simulation.pose()[2], travelled(simulation)
        simulation.advance(2000)
        right, left = (travelled(simulation) - begin) * 0.5 * robot.drive.wheel_diameter_m
        v, w = 0.5 * (right + left) / 2.0, (right - left) / robot.drive.track_m / 2.0
        turned = simulation.pose()[2] - begin_yaw
        assert turned == pytest.approx(2.0 * w / (1.0 + 0.8 * abs(v * w)), rel=5e-3)
        assert simulation.twist() == pytest.approx((v, turned / 2.0), rel=5e-3)

    def test_slip_leaves_the_path_smooth(self, simulate_with):
        """The pose moves along its own heading: forward speed times time is the length of the way."""
        simulation = simulate_with(TurnSlip(coefficient_s2_m=2.0))
        simulation.set_voltages(3.0, 2.0)
        simulation.advance(1000)
        for _ in range(20):
            x, y, yaw = simulation.pose()
            simulation.advance(10)
            to_x, to_y, to_yaw = simulation.pose()
            heading = math.atan2(to_y - y, to_x - x)
            assert math.remainder(heading - 0.5 * (yaw + to_yaw), 2 * math.pi) == pytest.approx(0.0, abs=2e-3)
            assert math.hypot(to_x - x, to_y - y) == pytest.approx(0.01 * simulation.twist()[0], rel=5e-3)

    def test_an_eccentric_wheel_swings_the_heading_by_its_angle(self, simulate_with, robot):
        """The left wheel travels r (w + A sin(w + phase)) in a turn w; the body twists as fast as its pose turns."""
        simulation = simulate_with(WheelEccentricity(side="left", amplitude=0.1, phase_rad=0.7))
        simulation.set_voltages(1.5, 1.5)
        radius_m, track_m = 0.5 * robot.drive.wheel_diameter_m, robot.drive.track_m
        yaws, expected = [], []
        for _ in range(30):
            simulation.advance(50)
            right, left = travelled(simulation)
            swing = 0.1 * (math.sin(left + 0.7) - math.sin(0.7))
            yaws.append(simulation.pose()[2])
            expected.append(radius_m * (right - left - swing) / track_m)
        np.testing.assert_allclose(yaws, expected, atol=2e-3)
        assert max(expected) - min(expected) > 0.03
        before = simulation.pose()[2]
        simulation.advance(2)
        assert simulation.twist()[1] == pytest.approx((simulation.pose()[2] - before) / 0.002, abs=0.02)

    def test_random_slip_turns_the_body_as_far_as_its_wheels_slip(self, robot, open_floor):
        """Over s = 0.1 m, far beyond its length, the heading error has the standard deviation q sqrt(2 s) / b."""
        slipping = robot.with_effect(RandomSlip(slip_m_sqrt_m=0.01, length_m=0.002))
        radius_m, track_m = 0.5 * robot.drive.wheel_diameter_m, robot.drive.track_m
        errors = {}
        for run, seed, end_m in (("first", 1, 2.0), ("again", 1, 0.3), ("another", 2, 2.0)):
            rng = np.random.Generator(np.random.PCG64(seed))
            with BulletSimulation(slipping, open_floor, (0.0, 0.0, 0.0), Rates(), rng) as simulation:
                simulation.set_voltages(3.0, 3.0)
                error, way_m = [], [0.0]
                while way_m[-1] < end_m:
                    simulation.advance(20)
                    right, left = travelled(simulation)
                    error.append(simulation.pose()[2] - radius_m * (right - left) / track_m)
                    way_m.append(0.5 * radius_m * (right + left))
            errors[run] = np.interp(np.arange(0.1, end_m, 0.1), way_m[1:], error)
        np.testing.assert_array_equal(errors["first"][:2], errors["again"][:2])
        changes = np.concatenate([np.diff(errors["first"]), np.diff(errors["another"])])
        # 36 changes: a standard error of 12 %.
        assert np.sqrt(np.mean(changes**2)) == pytest.approx(0.01 * math.sqrt(0.2) / track_m, rel=0.35)

    @pytest.mark.parametrize(
        ("voltages", "on_the_spot", "share"),
        [((2.0, 2.0), 1.0, 1.0), ((2.0, -2.0), 1.0, 1.0), ((2.0, 2.0), 0.3, 1.0), ((2.0, -2.0), 0.3, 0.3)],
    )
    def test_on_a_slope_a_robot_creeps_downhill_whatever_its_heading(
        self, simulate_with, robot, voltages, on_the_spot, share
    ):
        slope = FloorSlope(gradient=0.05, direction_rad=2.0, on_the_spot=on_the_spot)
        level, sloping = (simulate_with(*several) for several in ((), (slope,)))
        for simulation in (level, sloping):
            simulation.set_voltages(*voltages)
            simulation.advance(1500)
        travel_m = 0.5 * robot.drive.wheel_diameter_m * np.abs(travelled(sloping)).mean()
        crept = np.array(sloping.pose()) - level.pose()
        expected = 0.05 * share * travel_m * np.array([math.cos(2.0), math.sin(2.0), 0.0])
        np.testing.assert_allclose(crept, expected, atol=1e-3)
        speed_m_s, _ = level.twist()
        creep_m_s = 0.05 * share * 0.5 * robot.drive.wheel_diameter_m * np.abs(sloping.wheel_speeds()).mean()
        along = creep_m_s * math.cos(2.0 - sloping.pose()[2])
        assert sloping.twist()[0] - speed_m_s == pytest.approx(along, abs=2e-3)

    def test_encoders_have_their_true_counts(self, simulate_with):
        simulation = simulate_with(EncoderTicksScale(scale=1.1))
        simulation.set_voltages(2.0, 2.0)
        simulation.advance(2000)
        expected = travelled(simulation) / (2.0 * math.pi) * 1.1 * TICKS
        np.testing.assert_allclose(simulation.encoder_counts(), expected, atol=0.51)

    def test_one_encoder_loses_its_fraction_above_the_threshold(self, simulate_with):
        """Far above it all of the fraction is lost, far below nothing, on the other side nothing ever."""
        for voltage, lost in ((3.0, 0.2), (0.35, 0.0)):
            simulation = simulate_with(EncoderMissedTicks(side="left", fraction=0.2, threshold_rad_s=4.0))
            simulation.set_voltages(voltage, voltage)
            simulation.advance(1000)
            begin, turned = np.array(simulation.encoder_counts()), travelled(simulation)
            simulation.advance(2000)
            true = (travelled(simulation) - turned) / (2.0 * math.pi) * TICKS
            counted = simulation.encoder_counts() - begin
            assert counted[0] == pytest.approx(true[0], abs=1.1)
            assert counted[1] == pytest.approx((1.0 - lost) * true[1], abs=1.1)
