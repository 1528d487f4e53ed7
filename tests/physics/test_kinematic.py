"""The engine-free twin against PyBullet, against closed forms, and against its own step."""

import math
from itertools import pairwise

import numpy as np
import pytest

from configs.schema.scenario import Rates
from physics.bullet.simulation import BulletSimulation
from physics.effects.driver_and_battery.battery_decline import BatteryDecline
from physics.effects.driver_and_battery.bridge_coast import BridgeCoast
from physics.effects.driver_and_battery.bridge_voltage_drop import BridgeVoltageDrop
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.encoders.encoder_missed_ticks import EncoderMissedTicks
from physics.effects.motor_and_gearbox.coulomb_friction_scale import CoulombFrictionScale
from physics.effects.motor_and_gearbox.stribeck_friction import StribeckFriction
from physics.effects.motor_and_gearbox.torque_constant_mismatch import TorqueConstantMismatch
from physics.effects.wheels_and_floor.floor_slope import FloorSlope
from physics.effects.wheels_and_floor.turn_slip import TurnSlip
from physics.effects.wheels_and_floor.wheel_eccentricity import WheelEccentricity
from physics.effects.wheels_and_floor.wheel_radius_asymmetry import WheelRadiusAsymmetry
from physics.effects.wheels_and_floor.wheelbase_scale import WheelbaseScale
from physics.robot.model import RobotModel
from physics.twin import MAX_SCALAR_TRIALS, KinematicTwin, ReplayedWorld
from sensors.build import build_sensors
from sensors.suite import SensorSuite

PROFILE = ((0.0, 2.0, 2.0), (1.0, 2.6, 1.4), (3.0, 1.2, 2.2), (4.5, 2.0, 2.0), (5.5, -1.5, 1.5), (6.5, 0.0, 0.0))
PROFILE += ((7.0, 1.6, 1.6), (8.0, 1.0, 2.6), (9.0, -1.2, -1.2), (9.6, 0.0, 0.0), (10.0, 0.0, 0.0))
"""From when [s], right and left voltage: starts, arcs both ways, a turn on the spot, reverse, stops; no wheel slips."""
ROW_S = 0.05


def in_engine(robot, arena):
    """Poses at every row, (201, 3), and the counts at the end."""
    with BulletSimulation(robot, arena, (0.0, 0.0, 0.0), Rates()) as simulation:
        poses = [simulation.pose()]
        for (begin_s, *voltages), (end_s, *_) in pairwise(PROFILE):
            simulation.set_voltages(*voltages)
            for _ in range(round((end_s - begin_s) / ROW_S)):
                simulation.advance(50)
                poses.append(simulation.pose())
        return np.array(poses), np.array(simulation.encoder_counts())


def voltages(step_s):
    rows = [[pair] * round((end - begin) / step_s) for (begin, *pair), (end, *_) in pairwise(PROFILE)]
    return np.array([pair for part in rows for pair in part])[:, None]


def in_twin(robot, step_s=0.005):
    run = KinematicTwin(RobotModel.from_config(robot), step_s).drive(voltages(step_s), np.zeros((1, 3)))
    return run.pose[:: round(ROW_S / step_s), 0], run.counts[-1, 0]


WORN = (
    CoulombFrictionScale(scale=1.4),
    TorqueConstantMismatch(mismatch=0.05),
    SupplySag(source_resistance_ohm=0.5),
    BridgeVoltageDrop(drop_V=0.2),
    InputDelay(delay_s=0.03),
    StribeckFriction(extra_torque_N_m=0.004, stribeck_speed_rad_s=2.0),
    BatteryDecline(fraction_per_minute=0.2),
    WheelRadiusAsymmetry(asymmetry=0.02),
    WheelbaseScale(scale=1.05),
    TurnSlip(coefficient_s2_m=0.5),
    EncoderMissedTicks(side="right", fraction=0.1, threshold_rad_s=4.0),
    WheelEccentricity(side="left", amplitude=0.05, phase_rad=1.0),
    FloorSlope(gradient=0.03, direction_rad=2.0, on_the_spot=0.5),
)


class TestAgainstTheEngine:
    @pytest.mark.parametrize("several", [(), WORN], ids=["nominal", "worn"])
    def test_after_10_s_of_the_same_voltages_it_is_within_5_mm_and_half_a_degree(self, robot, open_floor, several):
        for effect in several:
            robot = robot.with_effect(effect)
        (truth, counts), (found, found_counts) = in_engine(robot, open_floor), in_twin(robot)
        assert np.hypot(*np.diff(truth[:, :2], axis=0).T).sum() > 1.0, "the profile goes somewhere"
        assert np.abs(np.diff(truth[:, 2])).sum() > 4.0
        apart = found - truth
        assert np.hypot(apart[:, 0], apart[:, 1]).max() < 0.005
        assert np.degrees(np.abs(apart[:, 2])).max() < 0.5
        np.testing.assert_allclose(found_counts, counts, atol=25)

    def test_sensors_read_the_same_along_the_same_way(self, robot, arena):
        """The twin stands where it stands in the engine, so only the way there may differ."""
        start = (0.55, -0.20, -math.pi / 2)
        quiet = robot.model_copy(update={"tof": robot.tof.model_copy(update={"noise_scale": 0.0})})
        run = KinematicTwin(RobotModel.from_config(robot)).drive(np.full((200, 1, 2), 2.0), np.array([start]))
        with BulletSimulation(robot, arena, start, Rates()) as engine:
            engine.set_voltages(2.0, 2.0)
            readings = []
            for world in (engine, ReplayedWorld(run, 0, arena, 1000)):
                sensors = build_sensors(
                    quiet, arena, 1000, lambda name: np.random.Generator(np.random.PCG64(len(name)))
                )
                suite = SensorSuite(sensors, 50)
                readings.append([suite.read_at_tick(world, tick) for tick in range(20)])
        for truth, found in zip(*readings, strict=True):
            np.testing.assert_allclose(found["tof"][:, 0], truth["tof"][:, 0], atol=0.0021)
            np.testing.assert_allclose(found["encoders"], truth["encoders"], atol=20)
            np.testing.assert_allclose(found["line"], truth["line"], atol=0.02)


class TestClosedForms:
    def test_equal_voltages_drive_straight_at_the_speed_of_the_torque_balance(self, robot):
        smooth = robot.model_copy(update={"drive": robot.drive.model_copy(update={"caster_friction": 0.0})})
        twin = KinematicTwin(RobotModel.from_config(smooth))
        run = twin.drive(np.full((600, 1, 2), 3.0), np.array([[1.0, 2.0, 0.3]]))
        m = robot.motor
        k, r = m.torque_constant_N_m_A, m.winding_resistance_ohm
        speed = (k * 3.0 / r - m.coulomb_friction_N_m) / (k**2 / r + m.viscous_friction_N_m_s_rad)
        assert run.wheel_speed_rad_s[-1, 0] == pytest.approx((speed, speed), rel=1e-9)
        assert run.current_A[-1, 0] == pytest.approx(((3.0 - k * speed) / r,) * 2, rel=1e-9)
        x, y, yaw = run.pose[-1, 0]
        assert (math.atan2(y - 2.0, x - 1.0), yaw) == pytest.approx((0.3, 0.3))

    def test_at_full_duty_a_coasting_bridge_has_no_off_time_however_empty_the_battery(self, robot):
        power = robot.power.model_copy(update={"motor_voltage_limit_V": robot.power.battery_voltage_V})
        unlimited = robot.model_copy(update={"power": power})
        declines = unlimited.with_effect(BatteryDecline(fraction_per_minute=1.0))
        coasts = declines.with_effect(BridgeCoast(inductance_H=5e-4, diode_V=1.0))
        volts = np.full((1000, 1, 2), robot.power.battery_voltage_V)
        bare, coasting = (
            KinematicTwin(RobotModel.from_config(each)).drive(volts, np.zeros((1, 3))) for each in (declines, coasts)
        )
        np.testing.assert_allclose(coasting.wheel_speed_rad_s[-1], bare.wheel_speed_rad_s[-1], rtol=1e-6)
        np.testing.assert_allclose(coasting.current_A[-1], bare.current_A[-1], rtol=1e-6)

    def test_the_mass_of_the_robot_is_in_the_run_up(self, robot):
        """Straight ahead each wheel carries half of the mass at its radius, besides rotor and disc."""
        drive_config, m = robot.drive, robot.motor
        smooth = robot.model_copy(update={"drive": drive_config.model_copy(update={"caster_friction": 0.0})})
        run = KinematicTwin(RobotModel.from_config(smooth), 0.001).drive(np.full((50, 1, 2), 3.0), np.zeros((1, 3)))
        radius = 0.5 * drive_config.wheel_diameter_m
        mass = robot.chassis.mass_kg + 2.0 * drive_config.wheel_mass_kg
        inertia = m.rotor_inertia_kg_m2 + 0.5 * drive_config.wheel_mass_kg * radius**2 + 0.5 * mass * radius**2
        k, r = m.torque_constant_N_m_A, m.winding_resistance_ohm
        damping = k**2 / r + m.viscous_friction_N_m_s_rad
        final = (k * 3.0 / r - m.coulomb_friction_N_m) / damping
        assert run.wheel_speed_rad_s[-1, 0, 0] == pytest.approx(
            final * (1.0 - math.exp(-0.05 * damping / inertia)), rel=2e-3
        )

    def test_a_turn_closes_its_circle(self, robot):
        run = KinematicTwin(RobotModel.from_config(robot)).drive(np.tile((2.4, 1.6), (3600, 1, 1)), np.zeros((1, 3)))
        settled = run.pose[1000:, 0]
        right, left = run.wheel_speed_rad_s[-1, 0] * 0.5 * robot.drive.wheel_diameter_m
        radius = 0.5 * robot.drive.track_m * (right + left) / (right - left)
        x, y, yaw = settled.T
        centers = np.stack([x - radius * np.sin(yaw), y + radius * np.cos(yaw)])
        assert np.ptp(centers, axis=1) == pytest.approx((0.0, 0.0), abs=1e-6)
        assert yaw[-1] - yaw[0] > 2.0 * math.pi

    def test_below_breakaway_nothing_moves_to_the_last_bit(self, robot):
        m = robot.motor
        breakaway = m.coulomb_friction_N_m * m.winding_resistance_ohm / m.torque_constant_N_m_A
        stuck = np.tile((0.99 * breakaway, -0.99 * breakaway), (500, 1, 1))
        run = KinematicTwin(RobotModel.from_config(robot)).drive(stuck, np.zeros((1, 3)))
        assert not run.pose.any()
        assert not run.counts.any()

    def test_the_driver_gives_no_more_than_its_limit(self, robot):
        twin = KinematicTwin(RobotModel.from_config(robot))
        runs = [twin.drive(np.full((100, 1, 2), volts), np.zeros((1, 3))) for volts in (6.0, 60.0)]
        np.testing.assert_array_equal(runs[0].pose, runs[1].pose)


def test_a_replay_ends_where_its_run_ends(robot, open_floor):
    run = KinematicTwin(RobotModel.from_config(robot)).drive(np.full((20, 1, 2), 2.0), np.zeros((1, 3)))
    world = ReplayedWorld(run, 0, open_floor, 1000)
    world.advance(100)
    with pytest.raises(ValueError, match=r"0\.101 s is after the end of the run at 0\.1 s"):
        world.advance(1)


def test_trials_do_not_touch_each_other(robot):
    for effect in WORN:
        robot = robot.with_effect(effect)
    twin = KinematicTwin(RobotModel.from_config(robot), 0.01)
    both = np.concatenate([voltages(0.01), -voltages(0.01)], axis=1)
    starts = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    together = twin.drive(both, starts)
    for lane in range(2):
        alone = twin.drive(both[:, lane : lane + 1], starts[lane : lane + 1])
        np.testing.assert_allclose(alone.pose[:, 0], together.pose[:, lane], atol=1e-12)


def test_a_trial_of_bare_motors_goes_the_same_way_alone_and_among_many(robot):
    """Few trials are stepped in plain numbers and many in arrays; both come to rest, stick and turn round here."""
    twin = KinematicTwin(RobotModel.from_config(robot), 0.01)
    shares = np.linspace(-1.5, 1.5, MAX_SCALAR_TRIALS + 3)
    many = twin.drive(voltages(0.01) * shares[:, None], np.tile([0.4, -0.2, 1.0], (len(shares), 1)))
    for trial, share in enumerate(shares):
        alone = twin.drive(voltages(0.01) * share, np.array([[0.4, -0.2, 1.0]]))
        np.testing.assert_allclose(alone.pose[:, 0], many.pose[:, trial], rtol=0, atol=1e-12)
        np.testing.assert_allclose(alone.wheel_speed_rad_s[:, 0], many.wheel_speed_rad_s[:, trial], atol=1e-11)
        np.testing.assert_array_equal(alone.wheel_speed_rad_s[:, 0] == 0.0, many.wheel_speed_rad_s[:, trial] == 0.0)
        np.testing.assert_allclose(alone.current_A[:, 0], many.current_A[:, trial], atol=1e-11)
    assert (many.wheel_speed_rad_s[1:] == 0.0).any()


@pytest.mark.parametrize("trials", [1, MAX_SCALAR_TRIALS + 1])
@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_a_voltage_that_is_no_number_is_refused_with_its_place(robot, trials, wrong):
    given = np.full((20, trials, 2), 2.0)
    given[7, trials - 1, 1] = wrong
    with pytest.raises(ValueError, match=rf"voltages_V: {wrong} at step 7, trial {trials - 1}, wheel 1, 1 such in all"):
        KinematicTwin(RobotModel.from_config(robot)).drive(given, np.zeros((trials, 3)))


def test_a_step_of_10_ms_is_fine(robot):
    fine, coarse = in_twin(robot, 0.001)[0], in_twin(robot, 0.01)[0]
    assert np.hypot(*(fine - coarse)[:, :2].T).max() < 0.0005
    assert np.degrees(np.abs((fine - coarse)[:, 2])).max() < 0.05
