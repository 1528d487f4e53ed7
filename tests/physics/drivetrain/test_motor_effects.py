"""Each motor effect against its definition in docs/reference/effects.md, by hand for a motor with round numbers."""

import math

import numpy as np
import pytest

from physics.drivetrain.bridge import Chopper
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.motor_bench import steady_states, steady_states_of_known_motion, step_responses
from physics.drivetrain.two_mass import Load, TwoMass
from physics.drivetrain.wheel_turns import counted_turns
from physics.effects.driver_and_battery.actuator_lag import ActuatorLag
from physics.effects.driver_and_battery.battery_decline import BatteryDecline
from physics.effects.driver_and_battery.bridge_coast import BridgeCoast
from physics.effects.driver_and_battery.bridge_voltage_drop import BridgeVoltageDrop
from physics.effects.driver_and_battery.current_limit import CurrentLimit
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
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
from physics.robot.model import RobotModel
from sensors.effects.motor_bench.speed_scale import SpeedScale

R, K, B, TC, J, SUPPLY_V = 3.0, 0.3, 0.002, 0.02, 2e-3, 8.0


@pytest.fixture(scope="module")
def motor(robot):
    numbers = {
        "winding_resistance_ohm": R,
        "torque_constant_N_m_A": K,
        "viscous_friction_N_m_s_rad": B,
        "coulomb_friction_N_m": TC,
        "rotor_inertia_kg_m2": J,
        "motor_side_inertia_fraction": 0.75,
        "motor_side_friction_fraction": 0.5,
    }
    power = robot.power.model_copy(update={"battery_voltage_V": SUPPLY_V})
    return robot.model_copy(update={"motor": robot.motor.model_copy(update=numbers), "power": power})


def steady(motor, effect, voltage, time_s=0.0):
    current, speed = steady_states(
        RobotModel.from_config(motor.with_effect(effect)), np.array([voltage]), np.array([time_s])
    )
    return current[0], speed[0]


@pytest.mark.parametrize("wrong", [math.nan, -math.inf])
def test_the_bench_refuses_a_voltage_that_is_no_number(motor, wrong):
    model = RobotModel.from_config(motor)
    with pytest.raises(ValueError, match=rf"voltage_V: {wrong} at trial 2, 1 such in all"):
        steady_states(model, np.array([1.0, 2.0, wrong]), np.zeros(3))
    with pytest.raises(ValueError, match=rf"voltage_V: {wrong} at row 1, trial 0, 2 such in all"):
        step_responses(model, np.array([[1.0], [wrong], [wrong]]), 0.01)


def linear(u, r=R, k=K, b=B, tc=TC):
    """K (u - K w) / R = B w + Tc sgn(u), solved for w; I from the winding."""
    w = (k * u / r - math.copysign(tc, u)) / (k**2 / r + b)
    return pytest.approx(((u - k * w) / r, w), rel=1e-9)


def responses(motor, voltages, *several):
    for effect in several:
        motor = motor.with_effect(effect)
    current, speed = step_responses(RobotModel.from_config(motor), np.array(voltages)[:, None], 0.005)
    return current[:, 0], speed[:, 0]


class TestSteadyStates:
    def test_without_effects_they_are_those_of_eq_21(self, motor):
        assert steady(motor, SpeedScale(scale=1.0), 4.0) == linear(4.0)
        assert steady(motor, SpeedScale(scale=1.0), -4.0) == linear(-4.0)
        assert steady(motor, SpeedScale(scale=1.0), 0.15) == (pytest.approx(0.05), 0.0)

    def test_scales_are_true_over_nominal(self, motor):
        assert steady(motor, WindingResistanceScale(scale=1.2), 4.0) == linear(4.0, r=3.6)
        assert steady(motor, TorqueConstantScale(scale=0.9), 4.0) == linear(4.0, k=0.27)
        assert steady(motor, ViscousFrictionScale(scale=2.0), 4.0) == linear(4.0, b=0.004)
        assert steady(motor, CoulombFrictionScale(scale=1.5), 4.0) == linear(4.0, tc=0.03)

    def test_mismatch_is_shared_by_left_and_right(self, motor):
        motors = RobotModel.from_config(motor.with_effect(TorqueConstantMismatch(mismatch=0.1))).motors
        assert (motors.left.torque_constant_N_m_A, motors.right.torque_constant_N_m_A) == pytest.approx((0.315, 0.285))

    @pytest.mark.parametrize("voltage", [4.0, -1.0])
    def test_stribeck_friction_falls_with_the_square_of_the_speed(self, motor, voltage):
        effect = StribeckFriction(extra_torque_N_m=0.03, stribeck_speed_rad_s=8.0)
        current, speed = steady(motor, effect, voltage)
        assert voltage == pytest.approx(R * current + K * speed)
        friction = TC + 0.03 * math.exp(-((speed / 8.0) ** 2))
        assert K * current == pytest.approx(B * speed + math.copysign(friction, speed))
        assert abs(speed) > 1.0

    def test_breakaway_is_at_coulomb_and_extra_torque_together(self, motor):
        effect = StribeckFriction(extra_torque_N_m=0.01, stribeck_speed_rad_s=2.0)
        breakaway = R * (TC + 0.01) / K
        assert steady(motor, effect, 0.999 * breakaway)[1] == 0.0
        assert steady(motor, effect, 1.001 * breakaway)[1] > 0.0

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_quadratic_drag_solves_a_quadratic_equation(self, motor, sign):
        c = 3e-4
        _, speed = steady(motor, QuadraticDrag(coefficient_N_m_s2_rad2=c), sign * 5.0)
        damping, drive = K**2 / R + B, K * 5.0 / R - TC
        assert speed == pytest.approx(sign * (math.sqrt(damping**2 + 4.0 * c * drive) - damping) / (2.0 * c))

    def test_asymmetric_friction_is_less_forward_and_more_in_reverse(self, motor):
        effect = FrictionAsymmetry(asymmetry=0.2)
        assert steady(motor, effect, 4.0) == linear(4.0, tc=0.8 * TC)
        assert steady(motor, effect, -4.0) == linear(-4.0, tc=1.2 * TC)

    def test_friction_warms_up_exponentially(self, motor):
        effect = FrictionWarmup(amplitude=0.5, time_constant_s=100.0)
        assert steady(motor, effect, 4.0, time_s=0.0) == linear(4.0, tc=1.5 * TC)
        assert steady(motor, effect, 4.0, time_s=100.0 * math.log(2.0)) == linear(4.0, tc=1.25 * TC)

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_the_bridge_takes_its_drop_off_the_voltage_that_drives(self, motor, sign):
        found = steady(motor, BridgeVoltageDrop(drop_V=0.5), sign * 4.0)
        current, speed = steady(motor, SpeedScale(scale=1.0), sign * 3.5)
        assert found == pytest.approx((current, speed))

    def test_below_the_drop_no_current_flows(self, motor):
        assert steady(motor, BridgeVoltageDrop(drop_V=0.5), 0.4) == (0.0, 0.0)

    def test_a_sagging_supply_adds_to_the_resistance_by_the_square_of_the_duty(self, motor):
        found = steady(motor, SupplySag(source_resistance_ohm=0.8), 4.0)
        assert found == linear(4.0, r=R + 0.8 * 0.25)

    def test_a_declining_battery_takes_its_fraction_of_the_voltage_each_minute(self, motor):
        found = steady(motor, BatteryDecline(fraction_per_minute=0.05), 4.0, time_s=120.0)
        assert found == linear(4.0 * 0.9)

    def test_an_empty_battery_gives_nothing(self, motor):
        assert steady(motor, BatteryDecline(fraction_per_minute=1.0), 4.0, time_s=90.0) == (0.0, 0.0)

    def test_a_current_limit_below_what_friction_needs_stalls_the_motor(self, motor):
        assert steady(motor, CurrentLimit(limit_A=0.06), 4.0) == (0.06, 0.0)


DUTIES = np.array([0.0, 0.1, 0.35, 0.5, 0.7, 0.9, 1.0, -0.3, -0.8])
BACK_V = np.array([-6.0, -1.0, 0.0, 2.0, 5.0, 7.5, 8.5])


def coasting_V(effect, duty, back_emf_V):
    chopper = Chopper(SUPPLY_V, duty, np.array(R), back_emf_V)
    return effect.apply(duty * SUPPLY_V - back_emf_V, chopper)


def switched_V(effect, duty, back_emf_V, parts=200):
    """Winding resistance times the mean current of the last period, stepped through switch and diodes from rest."""
    tau = effect.inductance_H * effect.switching_Hz / R
    periods = math.ceil(9.0 * tau) + 1
    current, total = np.zeros_like(duty), np.zeros_like(duty)
    for k in range(periods * parts):
        on = (k % parts) / parts < np.abs(duty) - 1e-9
        diodes_V = -np.sign(current) * (SUPPLY_V + effect.diode_V)
        goal = (np.where(on, np.sign(duty) * SUPPLY_V, diodes_V) - back_emf_V) / R
        goal = np.where(~on & (current == 0.0), 0.0, goal)
        after = goal + (current - goal) * np.exp(-1.0 / parts / tau)
        after = np.where(~on & (after * current < 0.0), 0.0, after)
        total = total + 0.5 * (current + after) / parts if k >= (periods - 1) * parts else total
        current = after
    return R * total


class TestCoastingBridge:
    @pytest.mark.parametrize("inductance_H", [1e-5, 1e-4, 1e-3])
    def test_its_mean_is_that_of_a_current_through_switch_and_diodes(self, inductance_H):
        """Time constants of 0.07, 0.7 and 7 periods; from 35 % to 100 % duty, without and with a pause."""
        effect = BridgeCoast(inductance_H=inductance_H, diode_V=1.2)
        duty, back_V = (grid.ravel() for grid in np.meshgrid(DUTIES, BACK_V))
        np.testing.assert_allclose(coasting_V(effect, duty, back_V), switched_V(effect, duty, back_V), atol=0.03)

    def test_without_inductance_the_supply_drives_for_a_share_of_the_time(self):
        effect = BridgeCoast(inductance_H=1e-12, diode_V=1.2)
        found = coasting_V(effect, DUTIES[:, None], BACK_V)
        expected = np.abs(DUTIES[:, None]) * (np.sign(DUTIES[:, None]) * SUPPLY_V - BACK_V)
        np.testing.assert_allclose(found, expected, atol=1e-6)

    def test_with_a_large_inductance_the_current_flows_without_pause_or_hardly_at_all(self):
        effect = BridgeCoast(inductance_H=0.5, diode_V=1.2)
        duty, back_V = DUTIES[1:7, None], BACK_V[:-1]
        flows_V = SUPPLY_V * (2.0 * duty - 1.0) - 1.2 * (1.0 - duty) - back_V
        np.testing.assert_allclose(coasting_V(effect, duty, back_V), np.maximum(flows_V, 0.0), atol=5e-3)

    def test_switched_off_it_lets_the_motor_run(self, motor):
        _, speed = responses(motor, [4.0] * 60 + [0.0] * 20, BridgeCoast(inductance_H=1e-4, diode_V=1.0))
        t_s = 0.005 * np.arange(1, 21)
        expected = (speed[59] + TC / B) * np.exp(-B / J * t_s) - TC / B
        np.testing.assert_allclose(speed[60:], expected, rtol=1e-3)

    def test_it_drives_a_motor_faster_than_the_mean_voltage_would(self, motor):
        """With hardly any inductance: K D (V - K w) / R = B w + Tc."""
        _, speed = steady(motor, BridgeCoast(inductance_H=1e-12, diode_V=1.0), 2.0)
        assert speed == pytest.approx((K * 2.0 / R - TC) / (B + 0.25 * K**2 / R), rel=1e-6)
        assert speed > 2.0 / K

    def test_a_measured_supply_counts_instead_of_the_nominal_one(self, motor):
        model = RobotModel.from_config(motor.with_effect(BridgeCoast(inductance_H=1e-12, diode_V=1.0)))
        _, speed = steady_states(model, np.array([2.0, 2.0]), np.zeros(2), np.array([8.0, 4.0]))
        expected = [(K * 2.0 / R - TC) / (B + duty * K**2 / R) for duty in (0.25, 0.5)]
        np.testing.assert_allclose(speed, expected, rtol=1e-6)


class TestCoastingBridgeAtAHalfEmptyBattery:
    """The duty stays as commanded, and the supply is half. With hardly any inductance: K D (S - K w) / R = B w + Tc."""

    HALF_EMPTY = BatteryDecline(fraction_per_minute=0.1)
    DUTY = np.array([1.0, 0.5])
    FINAL = DUTY * (K * 0.5 * SUPPLY_V / R)
    FINAL = (FINAL - TC) / (B + DUTY * K**2 / R)

    @pytest.fixture
    def model(self, motor):
        coast = BridgeCoast(inductance_H=1e-12, diode_V=1.0)
        return RobotModel.from_config(motor.with_effect(coast).with_effect(self.HALF_EMPTY))

    def test_on_the_bench_at_rest(self, model):
        _, speed = steady_states(model, SUPPLY_V * self.DUTY, np.full(2, 300.0))
        np.testing.assert_allclose(speed, self.FINAL, rtol=1e-6)

    def test_in_a_step_response(self, model):
        """A drive of 3 s takes 0.5 % off the battery; what is left of the run-up is far less."""
        volts = np.tile(SUPPLY_V * self.DUTY, (300, 1))
        current, speed = step_responses(model, volts, 0.01, np.full(2, 297.0))
        np.testing.assert_allclose(speed[-1], self.FINAL, rtol=3e-3)
        np.testing.assert_allclose(current[-1], (B * self.FINAL + TC) / K, rtol=5e-3)

    def test_of_wheels_in_a_log(self, model):
        volts = np.tile(SUPPLY_V * self.DUTY, (60, 1, 1))
        turned = counted_turns(model, volts, 0.05, np.array([297.0]))
        np.testing.assert_allclose(turned[-1, 0] / 0.05, self.FINAL, rtol=3e-3)

    def test_beside_a_sag(self, motor):
        """Both motors at rest at full duty: I = S / (R + 2 r) each from the half supply S."""
        several = motor.with_effect(SupplySag(source_resistance_ohm=0.8)).with_effect(self.HALF_EMPTY)
        line = Driveline.of_robot(RobotModel.from_config(several))
        held = np.full((1, 2), SUPPLY_V)
        _, voltage = line.voltage_V(held, held, 300.0, 0.01)
        current = line.current_A(voltage, np.zeros((1, 2)), line.supply_V(300.0), line.winding(300.0, 0.0))
        np.testing.assert_allclose(current, 0.5 * SUPPLY_V / (R + 2.0 * 0.8), rtol=1e-12)

    def test_an_empty_battery_drives_nothing(self, model):
        current, speed = steady_states(model, np.array([4.0]), np.array([700.0]))
        assert (current[0], speed[0]) == (0.0, 0.0)


class TestKnownMotionStates:
    """What a motor reads in rows of which it is known whether it turns; breakaway at TC R / K = 0.2 V."""

    def seen(self, motor, voltage, turns):
        states = steady_states_of_known_motion(
            RobotModel.from_config(motor), np.array(voltage), np.zeros(len(voltage)), np.array(turns)
        )
        return states.current_A, states.speed_rad_s, states.surplus

    def test_a_motor_that_stands_still_shows_its_resistance_at_any_voltage(self, motor):
        current, speed, surplus = self.seen(motor, [0.1, -0.4, 3.0], [False] * 3)
        np.testing.assert_allclose(current, np.array([0.1, -0.4, 3.0]) / R, rtol=1e-12)
        assert not speed.any()
        # The torque K u / R at rest, as a multiple of the friction.
        np.testing.assert_allclose(surplus, np.array([0.1, 0.4, 3.0]) * K / R / TC - 1.0, rtol=1e-12)

    def test_a_motor_that_turns_follows_equation_20(self, motor):
        for volts in (0.3, -2.0):
            current, speed, _ = self.seen(motor, [volts], [True])
            assert (current[0], speed[0]) == linear(volts)

    def test_below_breakaway_no_speed_is_steady(self, motor):
        current, speed, surplus = self.seen(motor, [0.15], [True])
        assert (current[0], speed[0]) == (pytest.approx(0.15 / R), 0.0)
        assert surplus[0] == pytest.approx(-0.25)

    def test_a_motor_with_more_friction_at_rest_may_turn_where_it_would_not_start(self, motor):
        """At 0.5 V, 0.05 N m cannot start it against 0.07 N m, but it keeps turning; the faster speed is stable."""
        sticky = motor.with_effect(StribeckFriction(extra_torque_N_m=0.05, stribeck_speed_rad_s=0.3))
        _, speed, surplus = self.seen(sticky, [0.5], [True])
        assert surplus[0] == pytest.approx(0.05 / 0.07 - 1.0)
        assert steady_states(RobotModel.from_config(sticky), np.array([0.5]), np.zeros(1))[1][0] == 0.0

        def surplus_N_m(w):
            return K * (0.5 - K * w) / R - B * w - TC - 0.05 * math.exp(-((w / 0.3) ** 2))

        assert surplus_N_m(speed[0]) == pytest.approx(0.0, abs=1e-9)
        assert surplus_N_m(0.99 * speed[0]) > 0.0 > surplus_N_m(1.01 * speed[0])


class TestSupplyOfTwoMotors:
    def test_both_currents_and_the_sagged_voltages_satisfy_the_definition(self, motor):
        line = Driveline.of_robot(RobotModel.from_config(motor.with_effect(SupplySag(source_resistance_ohm=0.8))))
        for volts, speeds in (((5.0, 4.0), (2.0, 1.0)), ((5.0, -3.0), (0.0, 3.0)), ((1.0, 5.0), (9.0, 2.0))):
            u, w = np.array([volts]), np.array([speeds])
            current = line.current_A(u, w, SUPPLY_V, line.winding(0.0, 0.0))
            duty = u / SUPPLY_V
            at_bridge = SUPPLY_V - 0.8 * np.sum(np.abs(duty) * np.abs(current))
            np.testing.assert_allclose(duty * at_bridge - K * w, R * current, atol=1e-12)

    @pytest.mark.parametrize("left_V", [2.6, 2.9, 3.2, 2.0])
    def test_the_bridge_takes_its_drop_off_what_the_sagging_supply_leaves(self, motor, left_V):
        """At 8.5 rad/s the left motor drives, is blocked by the drop, or feeds back."""
        several = (SupplySag(source_resistance_ohm=0.8), BridgeVoltageDrop(drop_V=0.3))
        line = Driveline.of_robot(RobotModel.from_config(motor.with_effect(several[0]).with_effect(several[1])))
        u, w = np.array([[5.0, left_V]]), np.array([[2.0, 8.5]])
        current = line.current_A(u, w, SUPPLY_V, line.winding(0.0, 0.0))
        duty = u / SUPPLY_V
        e = duty * (SUPPLY_V - 0.8 * np.sum(np.abs(duty) * np.abs(current))) - K * w
        np.testing.assert_allclose(R * current, np.sign(e) * np.maximum(np.abs(e) - 0.3, 0.0), atol=1e-12)

    def test_a_supply_asked_for_too_much_gives_no_less_than_no_voltage(self, motor):
        """Both motors plugged at full speed into 5 ohm: all that is left is their own voltage over the windings."""
        line = Driveline.of_robot(RobotModel.from_config(motor.with_effect(SupplySag(source_resistance_ohm=5.0))))
        w = np.array([[-18.0, -18.0]])
        current = line.current_A(np.array([[6.0, 6.0]]), w, SUPPLY_V, line.winding(0.0, 0.0))
        np.testing.assert_allclose(current, -K * w / R, rtol=1e-12)


class TestStepResponses:
    STEP = (4.0,) * 40

    def run_up(self, t_s, j=J, u=4.0):
        damping = K**2 / R + B
        return (K * u / R - TC) / damping * (1.0 - np.exp(-np.maximum(t_s, 0.0) * damping / j))

    T_S = 0.005 * np.arange(1, 41)

    def test_inertia_scales_the_time_constant(self, motor):
        _, speed = responses(motor, self.STEP, RotorInertiaScale(scale=1.5))
        np.testing.assert_allclose(speed, self.run_up(self.T_S, j=1.5 * J), rtol=1e-9)

    def test_a_delay_shifts_the_response(self, motor):
        _, speed = responses(motor, self.STEP, InputDelay(delay_s=0.012))
        np.testing.assert_allclose(speed, self.run_up(self.T_S - 0.012), rtol=1e-9, atol=1e-12)

    @pytest.mark.parametrize("rows", [3, 5, 8])
    def test_a_trial_that_ends_before_its_first_command_acts_stays_at_rest(self, motor, rows):
        current, speed = responses(motor, (4.0,) * rows, InputDelay(delay_s=0.040))
        assert not current.any()
        assert not speed.any()
        assert len(speed) == rows

    def test_an_actuator_lag_makes_it_second_order(self, motor):
        """Without dry friction, 1 - (a exp(-t/a) - b exp(-t/b)) / (a - b) of the final speed."""
        slippery = motor.model_copy(update={"motor": motor.motor.model_copy(update={"coulomb_friction_N_m": 0.0})})
        _, speed = responses(slippery, self.STEP, ActuatorLag(time_constant_s=0.02))
        damping = K**2 / R + B
        a, b, t = J / damping, 0.02, self.T_S
        final = K * 4.0 / R / damping
        expected = final * (1.0 - (a * np.exp(-t / a) - b * np.exp(-t / b)) / (a - b))
        # The lag is held for half a millisecond at its end value: a quarter of a millisecond early.
        np.testing.assert_allclose(speed, expected, atol=0.012 * final)

    @pytest.mark.parametrize("lag_s", [5e-4, 1.5e-3, 0.02])
    def test_wheels_turn_less_by_a_lag_however_short_it_is_beside_a_row(self, motor, lag_s):
        """Without dry friction, the angle is the integral of the speed above; the lag seems at most 0.15 ms off."""
        slippery = motor.model_copy(update={"motor": motor.motor.model_copy(update={"coulomb_friction_N_m": 0.0})})
        volts = np.full((4, 1, 2), 4.0)
        turned, lagging = (
            np.cumsum(counted_turns(RobotModel.from_config(each), volts, 0.05, np.zeros(1)), axis=0)[:, 0, 0]
            for each in (slippery, slippery.with_effect(ActuatorLag(time_constant_s=lag_s)))
        )
        damping = K**2 / R + B
        a, b, t = J / damping, lag_s, 0.05 * np.arange(1, 5)
        without = t - a * (1.0 - np.exp(-t / a))
        with_lag = t - (a**2 * (1.0 - np.exp(-t / a)) - b**2 * (1.0 - np.exp(-t / b))) / (a - b)
        np.testing.assert_allclose((turned - lagging) / (K * 4.0 / R / damping), without - with_lag, atol=1.5e-4)

    def test_a_limited_current_runs_up_along_a_ramp(self, motor):
        current, speed = responses(motor, (5.0,) * 10, CurrentLimit(limit_A=0.5))
        assert current == pytest.approx(0.5)
        final, rate = (K * 0.5 - TC) / B, B / J
        np.testing.assert_allclose(speed, final * (1.0 - np.exp(-rate * self.T_S[:10])), rtol=5e-3)

    def test_free_play_lets_the_motor_side_run_up_alone(self, motor):
        """Until it has crossed half the gap, with its shares of inertia and friction."""
        _, speed = responses(motor, (2.0, 2.0), GearBacklash(gap_rad=1.0))
        damping, drive = K**2 / R + 0.5 * B, K * 2.0 / R - 0.5 * TC
        t_s = np.array([0.005, 0.010])
        np.testing.assert_allclose(speed, drive / damping * (1.0 - np.exp(-t_s * damping / (0.75 * J))), rtol=2e-3)

    def test_contact_is_inelastic(self):
        """Two sides that meet go on together with the momentum of both."""
        nothing = np.zeros(1)
        motor_side = Load(nothing, nothing, nothing, np.array([3e-3]))
        load_side = Load(nothing, nothing, nothing, np.array([1e-3]))
        before = TwoMass(np.array([8.0]), np.array([4.0]), np.array([0.0499]))
        after = GearBacklash(gap_rad=0.1).apply(before, motor_side, load_side, 1e-3)
        assert (after.motor_rad_s[0], after.load_rad_s[0]) == pytest.approx((7.0, 7.0))
        assert after.slack_rad[0] == pytest.approx(0.05)

    def test_sides_that_drift_apart_are_not_held(self):
        nothing, mass = np.zeros(1), np.array([1e-3])
        load = Load(nothing, nothing, nothing, mass)
        before = TwoMass(np.array([4.0]), np.array([8.0]), np.array([0.05]))
        after = GearBacklash(gap_rad=0.1).apply(before, load, load, 1e-3)
        assert (after.motor_rad_s[0], after.load_rad_s[0]) == pytest.approx((4.0, 8.0))
        assert after.slack_rad[0] == pytest.approx(0.046)

    def test_a_tiny_gap_is_a_rigid_gearbox(self, motor):
        voltages = (4.0,) * 20 + (-4.0,) * 20
        rigid = responses(motor, voltages)[1]
        np.testing.assert_allclose(responses(motor, voltages, GearBacklash(gap_rad=1e-9))[1], rigid, atol=0.03)

    def test_at_a_reversal_play_moves_the_speed_faster(self, motor):
        voltages = (4.0,) * 20 + (-4.0,) * 4
        rigid, loose = responses(motor, voltages)[1], responses(motor, voltages, GearBacklash(gap_rad=0.1))[1]
        assert loose[20] < rigid[20] - 0.2


def test_several_effects_act_each_by_its_own_definition(motor):
    both = motor.with_effect(WindingResistanceScale(scale=1.2)).with_effect(BridgeVoltageDrop(drop_V=0.5))
    _, speed = steady(both, CoulombFrictionScale(scale=1.5), 4.0)
    assert speed == pytest.approx((K * 3.5 / 3.6 - 0.03) / (K**2 / 3.6 + B))
