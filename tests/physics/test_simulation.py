import math

import numpy as np
import pybullet
import pytest

from physics.drivetrain.motor import MotorModel


def wheel_angles(simulation):
    return np.array([state[0] for state in simulation._wheel_states()])


def body_height_and_tilt(simulation):
    position, turn = pybullet.getBasePositionAndOrientation(simulation._robot, physicsClientId=simulation._client)
    roll, pitch, _ = pybullet.getEulerFromQuaternion(turn)
    return position[2], roll, pitch


def signature(simulation):
    return (simulation.pose(), simulation.twist(), simulation.wheel_speeds(), simulation.currents())


class TestBody:
    def test_the_engine_has_the_configured_masses_and_inertias(self, simulate, robot):
        simulation = simulate()
        client, body, (right, left) = simulation._client, simulation._robot, simulation._wheels
        chassis = robot.chassis
        mass, _, inertia, *_ = pybullet.getDynamicsInfo(body, -1, physicsClientId=client)
        assert mass == pytest.approx(chassis.mass_kg)
        height = chassis.base_height_m - chassis.clearance_m
        expected = chassis.mass_kg / 12.0 * (chassis.length_m**2 + chassis.width_m**2)
        assert inertia[2] == pytest.approx(expected)
        assert inertia[0] == pytest.approx(chassis.mass_kg / 12.0 * (chassis.width_m**2 + height**2))
        disc = 0.5 * robot.drive.wheel_mass_kg * (0.5 * robot.drive.wheel_diameter_m) ** 2
        for wheel in (right, left):
            inertia = pybullet.getDynamicsInfo(body, wheel, physicsClientId=client)[2]
            assert inertia[1] == pytest.approx(disc + robot.motor.rotor_inertia_kg_m2)

    def test_each_wheel_touches_the_floor_in_one_point_in_the_middle_of_its_tread(self, simulate, robot):
        simulation = simulate()
        simulation.advance(100)
        for wheel, side in zip(simulation._wheels, (-1.0, 1.0), strict=True):
            contacts = pybullet.getContactPoints(
                bodyA=simulation._robot, linkIndexA=wheel, physicsClientId=simulation._client
            )
            assert [contact[6] for contact in contacts] == [
                pytest.approx((0.0, side * 0.5 * robot.drive.track_m, 0.0), abs=1e-5)
            ]


class TestMotorInTheEngine:
    @pytest.mark.parametrize("voltage", [-5.0, 0.5, 2.0, 6.0])
    def test_wheels_off_load_settle_where_eq_20_says(self, simulate, robot, voltage):
        simulation = simulate(lifted=True)
        simulation.set_voltages(voltage, voltage)
        simulation.advance(1500)
        current, speed = MotorModel.from_config(robot.motor).steady_state(voltage)
        assert simulation.wheel_speeds() == pytest.approx((speed, speed), rel=1e-6)
        assert simulation.currents() == pytest.approx((current, current), rel=1e-6)

    def test_the_run_up_follows_eq_20(self, simulate, robot):
        heavy = robot.model_copy(update={"chassis": robot.chassis.model_copy(update={"mass_kg": 20.0})})
        simulation = simulate(robot=heavy, lifted=True)
        # One wheel each way, so that the body stays put and the wheel's own inertia is all there is.
        simulation.set_voltages(3.0, -3.0)
        motor = MotorModel.from_config(robot.motor)
        disc = 0.5 * robot.drive.wheel_mass_kg * (0.5 * robot.drive.wheel_diameter_m) ** 2
        for steps in (10, 20, 40, 80):
            simulation.advance(steps - simulation.steps)
            expected, _ = motor.step(3.0, 0.0, simulation.time_s, disc)
            assert simulation.wheel_speeds() == pytest.approx((expected, -expected), rel=0.03)

    @pytest.mark.parametrize("inertia", [0.0, 1e-6, 1e-5])
    def test_a_wheel_faster_than_the_steps_settles_where_eq_20_says(self, simulate, robot, inertia):
        """Without a rotor the time constant is 0.43 ms, and explicit steps of 1 ms would overshoot more each time."""
        light = robot.with_section("motor", {"rotor_inertia_kg_m2": inertia})
        simulation = simulate(robot=light, lifted=True)
        simulation.set_voltages(3.0, 3.0)
        simulation.advance(100)
        _, speed = MotorModel.from_config(light.motor).steady_state(3.0)
        assert simulation.wheel_speeds() == pytest.approx((speed, speed), rel=1e-6)

    @pytest.mark.parametrize("share", [-0.99, 0.5, 0.99])
    def test_a_robot_below_breakaway_stays_where_it_is(self, simulate, robot, share):
        motor = robot.motor
        breakaway = motor.coulomb_friction_N_m * motor.winding_resistance_ohm / motor.torque_constant_N_m_A
        simulation = simulate()
        simulation.set_voltages(share * breakaway, share * breakaway)
        simulation.advance(10_000)
        assert simulation.encoder_counts() == (0, 0)
        # The solver's rest, about 5e-9 rad/s: a count in four days.
        assert np.abs(wheel_angles(simulation)).max() < 1e-6
        assert np.abs(simulation.pose()).max() < 1e-7

    def test_a_lifted_wheel_moves_just_above_breakaway(self, simulate, robot):
        motor = robot.motor
        breakaway = motor.coulomb_friction_N_m * motor.winding_resistance_ohm / motor.torque_constant_N_m_A
        simulation = simulate(lifted=True)
        simulation.set_voltages(1.01 * breakaway, -1.01 * breakaway)
        simulation.advance(2000)
        right, left = simulation.wheel_speeds()
        expected = MotorModel.from_config(motor).steady_state(1.01 * breakaway)[1]
        assert (right, left) == pytest.approx((expected, -expected), rel=1e-3)

    def test_friction_stops_a_wheel_and_does_not_turn_it_back(self, simulate):
        simulation = simulate()
        simulation.set_voltages(3.0, 3.0)
        simulation.advance(500)
        simulation.set_voltages(0.0, 0.0)
        simulation.advance(500)
        stopped = simulation.encoder_counts()
        simulation.advance(2000)
        assert simulation.encoder_counts() == stopped
        assert np.abs(simulation.wheel_speeds()).max() < 1e-7

    def test_voltages_stop_at_the_driver_limit_and_at_the_battery(self, simulate, robot):
        simulation = simulate()
        simulation.set_voltages(50.0, -50.0)
        assert simulation.voltages() == (6.0, -6.0)
        weak = robot.model_copy(update={"power": robot.power.model_copy(update={"battery_voltage_V": 4.5})})
        simulation = simulate(robot=weak)
        simulation.set_wheel_speeds(100.0, -100.0)
        simulation.advance(20)
        assert simulation.voltages() == (4.5, -4.5)

    def test_mean_voltages_are_those_of_the_steps_since_they_were_last_taken(self, simulate):
        simulation = simulate()
        assert simulation.take_mean_voltages() == (0.0, 0.0)
        simulation.set_voltages(3.0, -1.0)
        simulation.advance(30)
        simulation.set_voltages(1.0, 2.0)
        simulation.advance(10)
        assert simulation.take_mean_voltages() == pytest.approx((2.5, -0.25))
        simulation.advance(20)
        assert simulation.take_mean_voltages() == pytest.approx((1.0, 2.0))


class TestDriving:
    # Bullet's friction is not quite the same in all directions, so that the heading is part of the case.
    @pytest.mark.parametrize("heading", [0.0, 0.3, 1.2, 2.5])
    def test_a_straight_drive_of_a_metre_drifts_less_than_a_tenth_of_a_millimetre(self, simulate, heading):
        simulation = simulate(start=(0.0, 0.0, heading))
        simulation.set_wheel_speeds(4.6, 4.6)
        simulation.advance(500)
        x0, y0, yaw0 = simulation.pose()
        simulation.advance(6700)
        x, y, yaw = simulation.pose()
        along = math.cos(yaw0) * (x - x0) + math.sin(yaw0) * (y - y0)
        across = math.cos(yaw0) * (y - y0) - math.sin(yaw0) * (x - x0)
        assert along > 1.0
        assert abs(across) < 1e-4
        assert abs(yaw - yaw0) < 2e-4

    def test_the_body_stays_level_and_at_its_height(self, simulate):
        simulation = simulate()
        simulation.set_wheel_speeds(5.0, 4.0)
        simulation.advance(500)
        bodies = []
        for _ in range(200):
            simulation.advance(7)
            bodies.append(body_height_and_tilt(simulation))
        assert np.ptp(np.array(bodies), axis=0).max() < 1e-6

    def test_the_distance_is_what_the_wheels_roll(self, simulate, robot):
        simulation = simulate()
        simulation.set_wheel_speeds(4.6, 4.6)
        simulation.advance(500)
        start, angle = simulation.pose()[0], wheel_angles(simulation).mean()
        simulation.advance(5000)
        rolled = 0.5 * robot.drive.wheel_diameter_m * (wheel_angles(simulation).mean() - angle)
        assert simulation.pose()[0] - start == pytest.approx(rolled, rel=1e-3)

    @pytest.mark.parametrize(("right", "left"), [(6.0, 2.0), (3.0, 5.0), (3.0, -3.0), (-4.0, -2.0)])
    def test_arcs_follow_the_kinematics(self, simulate, robot, right, left):
        simulation = simulate()
        simulation.set_wheel_speeds(right, left)
        simulation.advance(1000)
        yaw, angles = simulation.pose()[2], wheel_angles(simulation)
        speeds = []
        for _ in range(100):
            simulation.advance(30)
            speeds.append(simulation.twist())
        turned = wheel_angles(simulation) - angles
        radius = 0.5 * robot.drive.wheel_diameter_m
        assert simulation.pose()[2] - yaw == pytest.approx(radius * (turned[0] - turned[1]) / 0.14, rel=1e-3)
        v, w = np.mean(speeds, axis=0)
        assert v == pytest.approx(radius * 0.5 * (right + left), rel=5e-3, abs=2e-4)
        assert w == pytest.approx(radius * (right - left) / 0.14, rel=5e-3)

    def test_yaw_counts_whole_turns(self, simulate):
        simulation = simulate(start=(0.0, 0.0, 3.0))
        simulation.set_wheel_speeds(6.0, -6.0)
        simulation.advance(5000)
        # 2 * 0.0325 * 6 / 0.14 rad/s for 5 s, less the run-up.
        assert simulation.pose()[2] - 3.0 == pytest.approx(13.9, abs=0.4)

    def test_the_start_pose_is_that_of_the_axle(self, simulate):
        assert simulate(start=(0.55, -0.2, math.pi / 2)).pose() == pytest.approx((0.55, -0.2, math.pi / 2), abs=1e-12)

    @pytest.mark.parametrize("set_point", [-6.0, 2.0, 4.6, 9.0])
    def test_the_wheel_loop_settles_within_0_3_s(self, simulate, set_point):
        simulation = simulate()
        simulation.set_wheel_speeds(set_point, set_point)
        shares = []
        for _ in range(200):
            simulation.advance(5)
            shares.append(simulation.wheel_speeds()[0] / set_point)
        assert max(shares) < 1.15
        assert np.abs(np.array(shares[60:]) - 1.0).max() < 0.02

    def test_the_wheel_loop_takes_over_from_open_loop_without_a_jolt(self, simulate):
        simulation = simulate()
        simulation.set_voltages(2.0, 2.0)
        simulation.advance(3000)
        simulation.set_wheel_speeds(5.0, 5.0)
        speeds = []
        for _ in range(80):
            simulation.advance(5)
            speeds.append(simulation.wheel_speeds()[0])
        assert min(speeds) > 0.0
        assert max(speeds) < 6.0
        assert speeds[-1] == pytest.approx(5.0, rel=0.02)

    def test_braking_keeps_the_robot_on_its_caster(self, simulate):
        simulation = simulate()
        simulation.set_wheel_speeds(9.0, 9.0)
        simulation.advance(1000)
        simulation.set_wheel_speeds(0.0, 0.0)
        pitches = []
        for _ in range(100):
            simulation.advance(5)
            pitches.append(body_height_and_tilt(simulation)[2])
        assert np.degrees(np.abs(pitches)).max() < 0.1
        assert simulation.twist()[0] == pytest.approx(0.0, abs=1e-6)

    def test_spinning_wheels_push_with_the_friction_that_their_load_allows(self, simulate, robot):
        simulation = simulate()
        simulation.set_voltages(6.0, 6.0)
        simulation.advance(90)
        before = simulation.twist()[0]
        simulation.advance(20)
        drive, chassis, g = robot.drive, robot.chassis, 9.81
        assert 0.5 * drive.wheel_diameter_m * min(simulation.wheel_speeds()) > simulation.twist()[0] + 0.05
        # Forces, and moments about the caster's contact; the wheels' own inertia is 1 % of it.
        wheels_kg = 2.0 * drive.wheel_mass_kg
        mass = chassis.mass_kg + wheels_kg
        center_x = chassis.mass_kg * chassis.center_of_mass_x_m / mass
        center_z = (chassis.mass_kg * chassis.center_of_mass_z_m + wheels_kg * 0.5 * drive.wheel_diameter_m) / mass
        base = -drive.caster_x_m
        share = (base + center_x) / base
        grip = drive.wheel_friction + drive.caster_friction
        acceleration = g * (grip * share - drive.caster_friction) / (1.0 + grip * center_z / base)
        assert (simulation.twist()[0] - before) / 0.02 == pytest.approx(acceleration, rel=0.03)

    def test_the_rotor_behind_the_gears_does_not_lift_the_robot(self, simulate):
        simulation = simulate()
        simulation.set_voltages(6.0, 6.0)
        simulation.advance(1000)
        simulation.set_voltages(-6.0, -6.0)
        tilts = []
        for _ in range(100):
            simulation.advance(5)
            tilts.append(body_height_and_tilt(simulation)[2])
        assert np.degrees(np.abs(tilts)).max() < 10.0


class TestEncoders:
    def test_counts_are_whole_and_follow_the_wheel(self, simulate, robot):
        simulation = simulate()
        simulation.set_wheel_speeds(5.0, -3.0)
        simulation.advance(1000)
        expected = wheel_angles(simulation) / (2 * math.pi) * robot.encoder.counts_per_revolution
        counts = simulation.encoder_counts()
        assert all(isinstance(count, int) for count in counts)
        assert np.abs(counts - expected).max() <= 0.5


class TestTouching:
    def test_a_box_is_touched_only_once_the_chassis_reaches_it(self, simulate, robot, one_block):
        simulation = simulate(one_block)
        simulation.set_wheel_speeds(3.0, 3.0)
        for _ in range(400):
            simulation.advance(10)
            reach = simulation.pose()[0] + 0.5 * robot.chassis.length_m
            if simulation.touching():
                break
            assert reach < 0.3 + 1e-3
        assert reach == pytest.approx(0.3, abs=1.5e-3)

    def test_a_touch_between_two_looks_is_not_missed(self, simulate, one_block):
        simulation = simulate(one_block, start=(0.2, 0.0, 0.0))
        simulation.set_wheel_speeds(3.0, 3.0)
        simulation.advance(500)
        simulation.set_wheel_speeds(-3.0, -3.0)
        simulation.advance(1500)
        assert simulation.touching() == ("block",)
        assert simulation.touching() == ()

    def test_a_block_holds_the_robot_up(self, simulate, robot, one_block):
        simulation = simulate(one_block)
        simulation.set_wheel_speeds(3.0, 3.0)
        simulation.advance(5000)
        assert simulation.pose()[0] + 0.5 * robot.chassis.length_m < 0.302

    def test_the_floor_is_no_obstacle(self, simulate):
        simulation = simulate()
        simulation.set_wheel_speeds(3.0, 3.0)
        simulation.advance(1000)
        assert simulation.touching() == ()


class TestReproducibility:
    @staticmethod
    def drive(simulation):
        simulation.set_wheel_speeds(6.0, 3.0)
        simulation.advance(700)
        simulation.set_voltages(-2.0, 3.0)
        simulation.advance(700)
        return signature(simulation)

    def test_two_runs_are_the_same_to_the_last_bit(self, simulate, arena):
        start = (0.55, -0.2, math.pi / 2)
        assert self.drive(simulate(arena, start)) == self.drive(simulate(arena, start))

    def test_simulations_side_by_side_do_not_disturb_each_other(self, simulate, arena, one_block):
        alone = self.drive(simulate())
        first, second, third = simulate(), simulate(one_block), simulate(arena)
        for simulation in (first, second, third):
            simulation.set_wheel_speeds(6.0, 3.0)
        for _ in range(70):
            for simulation in (third, first, second):
                simulation.advance(10)
        for simulation in (first, second):
            simulation.set_voltages(-2.0, 3.0)
        for _ in range(7):
            second.advance(100)
            first.advance(100)
        assert signature(first) == alone

    def test_how_the_steps_are_cut_up_does_not_matter(self, simulate):
        whole, pieces = simulate(), simulate()
        for simulation in (whole, pieces):
            simulation.set_wheel_speeds(5.0, 4.0)
        whole.advance(1000)
        for steps in (1, 6, 3, 90, 13, 887):
            pieces.advance(steps)
        assert whole.steps == pieces.steps == 1000
        assert whole.time_s == 1.0
        assert signature(whole) == signature(pieces)
