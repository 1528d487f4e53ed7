"""Each sensor effect against its definition in docs/reference/effects.md, worked out by hand."""

import math

import numpy as np
import pytest

from configs.effects.robot_effects import RobotEffects
from sensors.effects.motor_bench.current_sensor_gain import CurrentSensorGain
from sensors.effects.motor_bench.current_sensor_offset import CurrentSensorOffset
from sensors.effects.motor_bench.speed_filter_lag import SpeedFilterLag
from sensors.effects.motor_bench.speed_scale import SpeedScale
from sensors.effects.motor_bench.speed_time_offset import SpeedTimeOffset
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from sensors.effects.pose_log.pose_clock_drift import PoseClockDrift
from sensors.effects.pose_log.pose_time_offset import PoseTimeOffset
from sensors.effects.range_sensor.ambient_noise import AmbientNoise
from sensors.effects.range_sensor.cover_crosstalk import CoverCrosstalk
from sensors.effects.range_sensor.incidence_bias import IncidenceBias
from sensors.effects.range_sensor.log_range_error import LogRangeError
from sensors.effects.range_sensor.material_bias import MaterialBias
from sensors.effects.range_sensor.material_slope import MaterialSlope
from sensors.effects.range_sensor.near_field_error import NearFieldError
from sensors.effects.range_sensor.noise_scale import NoiseScale
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_saturation import RangeSaturation
from sensors.effects.range_sensor.range_scale import RangeScale
from sensors.effects.range_sensor.temperature_drift import TemperatureDrift
from sensors.effects.range_sensor.tilt_asymmetry import TiltAsymmetry
from sensors.effects.range_sensor.tof_mount_yaw import TofMountYaw
from sensors.effects.range_sensor.tof_range_offset import TofRangeOffset
from sensors.effects.range_sensor.tof_range_scale import TofRangeScale
from sensors.effects.range_sensor.tof_time_offset import TofTimeOffset
from sensors.effects.range_sensor.warmup_drift import WarmupDrift
from sensors.pose_log import PoseLog
from sensors.ranging.range_view import RANGE_SENSORS, RangeView
from sensors.ranging.tof import TofArray
from sensors.wheels.instruments import read_current_A, read_speed_rad_s
from symolo.dataset.codes import TofStatus

DISTANCE_M = np.array([0.05, 0.18, 0.6])
VIEW = RangeView(
    distance_m=DISTANCE_M,
    previous_distance_m=DISTANCE_M,
    incidence_rad=np.array([0.0, math.pi / 6, math.pi / 4]),
    tilt_forward_rad=np.array([0.0, -0.5, 0.1]),
    tilt_sideways_rad=np.array([0.0, 0.1, -0.7]),
    reflectance=np.array([0.85, 0.05, 0.5]),
    material_share={"wood": np.array([1.0, 0.0, 0.25])},
    temperature_C=35.0,
    reference_temperature_C=25.0,
    ambient_lux=3000.0,
    time_s=60.0,
)


def applied(values, given):
    """What the effect of these parameters makes of a value in the view above."""
    return values.apply(np.asarray(given), VIEW)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (RangeOffset(offset_m=0.01), [0.06, 0.19, 0.61]),
        (RangeScale(scale=1.1), [0.055, 0.198, 0.66]),
        (LogRangeError(coefficient_m=0.02), [0.05, 0.18, 0.6 + 0.02 * math.log(0.6 / 0.18)]),
        (TemperatureDrift(coefficient_m_per_K=1e-3), [0.06, 0.19, 0.61]),
        (MaterialBias(material="wood", offset_m=-0.008), [0.042, 0.18, 0.598]),
        (MaterialBias(material="glass", offset_m=-0.008), [0.05, 0.18, 0.6]),
        (MaterialSlope(material="wood", coefficient=0.2), [0.05 - 0.2 * 0.05, 0.18, 0.6 + 0.25 * 0.2 * 0.5]),
        (TiltAsymmetry(axis="forward", coefficient_m_per_rad=0.02), [0.05, 0.18 - 0.01, 0.602]),
        (TiltAsymmetry(axis="sideways", coefficient_m_per_rad=0.02), [0.05, 0.182, 0.6 - 0.014]),
        (IncidenceBias(coefficient=0.1), [0.05, 0.18 + 0.1 * 0.18 * 0.25, 0.6 + 0.1 * 0.6 * 0.5]),
        (
            CoverCrosstalk(strength_per_m2=0.1),
            [0.05 / (1 + 0.00025 / 0.85), 0.18 / (1 + 0.00324 / 0.05), 0.6 / (1 + 0.036 / 0.5)],
        ),
        (
            NearFieldError(amplitude_m=0.02, decay_length_m=0.1),
            [0.05 + 0.02 * math.exp(-0.5), 0.18 + 0.02 * math.exp(-1.8), 0.6 + 0.02 * math.exp(-6.0)],
        ),
        (
            WarmupDrift(amplitude_m=0.01, time_constant_s=120.0),
            DISTANCE_M + 0.01 * math.exp(-0.5),
        ),
        (TofRangeOffset(sensor="left", offset_m=0.01), [0.05, 0.19, 0.6]),
        (TofRangeScale(scale=0.9), [0.045, 0.162, 0.54]),
        (NoiseScale(scale=1.5), [0.075, 0.27, 0.9]),
        (AmbientNoise(coefficient_per_klux=1.0), 2.0 * DISTANCE_M),
    ],
    ids=lambda item: type(item).__name__,
)
def test_ranges_and_their_noise(values, expected):
    np.testing.assert_allclose(applied(values, DISTANCE_M), expected, rtol=1e-12)


class TestRangeSensorsInTheSimulation:
    """Front sensor before a wall across the way; the box of the arena says what the wall is made of."""

    @pytest.fixture
    def read(self, robot, arena_of, plane_world):
        def take(values, distance_m=0.5, surface="wood", at=(0.0, 0.0, 0.0), **settings):
            config = robot.tof.model_copy(
                update={"error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0} | settings
            )
            tof = TofArray(
                config,
                arena_of(surface),
                1000,
                np.random.Generator(np.random.PCG64(0)),
                RobotEffects().with_effect(values),
            )
            world = plane_world(wall_x_m=robot.tof.mounts.front.x_m + distance_m, at=at, time_s=60.0)
            return tof.sample(world)[0]

        return take

    @pytest.fixture
    def bare(self, read):
        return read(RangeOffset(offset_m=0.0))[0]

    def test_an_offset(self, read, bare):
        assert read(RangeOffset(offset_m=0.012))[0] == pytest.approx(bare + 0.012)
        assert read(TofRangeOffset(sensor="front", offset_m=0.012))[0] == pytest.approx(bare + 0.012)
        assert read(TofRangeOffset(sensor="left", offset_m=0.012))[0] == bare

    def test_a_material_is_that_of_the_wall(self, read, bare):
        assert read(MaterialBias(material="wood", offset_m=-0.02))[0] == pytest.approx(bare - 0.02)
        assert read(MaterialBias(material="glass", offset_m=-0.02))[0] == bare

    def test_a_slope_of_a_material_is_of_the_distance_beyond_100_mm(self, read, bare):
        slope = MaterialSlope(material="wood", coefficient=0.05)
        assert read(slope)[0] == pytest.approx(bare + 0.05 * 0.4, abs=1e-5)
        flat = MaterialSlope(material="wood", coefficient=0.0)
        assert read(slope, surface="glass")[0] == read(flat, surface="glass")[0]

    @pytest.mark.parametrize("turned_deg", [-20.0, 0.0, 20.0])
    def test_a_sideways_tilt_is_positive_to_the_left(self, read, turned_deg):
        turned = math.radians(turned_deg)
        nothing = read(TiltAsymmetry(axis="sideways", coefficient_m_per_rad=0.0), at=(0.0, 0.0, turned))[0]
        sideways = read(TiltAsymmetry(axis="sideways", coefficient_m_per_rad=0.03), at=(0.0, 0.0, turned))[0]
        forward = read(TiltAsymmetry(axis="forward", coefficient_m_per_rad=0.03), at=(0.0, 0.0, turned))[0]
        assert sideways - nothing == pytest.approx(0.03 * turned, abs=1e-12)
        assert forward - nothing == pytest.approx(0.0, abs=1e-12)

    @pytest.mark.parametrize("pitch_deg", [-15.0, 15.0])
    def test_a_forward_tilt_is_positive_upwards(self, robot, read, pitch_deg):
        mounts = robot.tof.mounts.model_copy(
            update={"front": robot.tof.mounts.front.model_copy(update={"pitch_up_deg": pitch_deg})}
        )
        readings = [
            read(TiltAsymmetry(axis="forward", coefficient_m_per_rad=size), distance_m=0.1, mounts=mounts)[0]
            for size in (0.0, 0.03)
        ]
        assert readings[1] - readings[0] == pytest.approx(0.03 * math.radians(pitch_deg), abs=1e-12)

    def test_crosstalk_takes_the_reflectance_of_the_wall(self, read):
        nothing, effect = CoverCrosstalk(strength_per_m2=0.0), CoverCrosstalk(strength_per_m2=0.1)
        for surface, reflectance in (("wood", 0.45), ("black_board", 0.05)):
            expected = read(nothing, surface=surface)[0] / (1.0 + 0.1 * 0.25 / reflectance)
            assert read(effect, surface=surface)[0] == pytest.approx(expected, rel=1e-3)

    def test_temperature_and_time_are_those_of_the_robot(self, read, bare):
        effect = TemperatureDrift(coefficient_m_per_K=1e-3)
        assert read(effect, temperature_C=5.0, reference_temperature_C=20.0)[0] == pytest.approx(bare - 0.015)
        effect = WarmupDrift(amplitude_m=0.01, time_constant_s=60.0)
        assert read(effect)[0] == pytest.approx(bare + 0.01 / math.e)

    @pytest.mark.parametrize("tilt_deg", [0.0, 20.0])
    def test_incidence_is_the_angle_of_the_axis_to_the_wall(self, read, tilt_deg):
        tilt = math.radians(tilt_deg)
        nothing, effect = IncidenceBias(coefficient=0.0), IncidenceBias(coefficient=0.2)
        at = (0.0, 0.0, tilt)
        distance = read(nothing, at=at)[0]
        expected = distance * (1.0 + 0.2 * math.sin(tilt) ** 2)
        assert read(effect, at=at)[0] == pytest.approx(expected, abs=2e-4)

    @pytest.fixture
    def seen(self, robot, arena_of, monkeypatch):
        """What the effects see of a world, each of the three sensors with its mount raised."""

        def take(world, raised_deg=0.0, **settings):
            mounts = robot.tof.mounts
            raised = {n: getattr(mounts, n).model_copy(update={"pitch_up_deg": raised_deg}) for n in RANGE_SENSORS}
            config = robot.tof.model_copy(update={"mounts": mounts.model_copy(update=raised)} | settings)
            views = []
            monkeypatch.setattr(RangeOffset, "apply", lambda _, reading, view: views.append(view) or reading)
            effects = RobotEffects().with_effect(RangeOffset(offset_m=0.0))
            tof = TofArray(config, arena_of("wood"), 1000, np.random.Generator(np.random.PCG64(0)), effects)
            tof.sample(world)
            return views[0]

        return take

    @pytest.mark.parametrize("raised_deg", [0.0, 12.0])
    @pytest.mark.parametrize("axis", [0, 1])
    def test_all_three_sensors_see_at_which_angles_they_meet_a_wall(self, seen, plane_world, axis, raised_deg):
        """Turned right by 20 degrees the axes lie 20 to the right, 25 to the left and 65 to the right of the normal.

        An axis that is raised by p is (cos p cos a, cos p sin a, sin p), with its top (-sin p cos a, ., cos p) and its
        left (-sin a, cos a, 0); the normal is (-1, 0, 0), or (0, -1, 0) in W for a wall across the y axis.
        """
        view = seen(plane_world(wall_x_m=0.3, at=(0.0, 0.0, math.radians(90.0 * axis - 20.0)), axis=axis), raised_deg)
        aside, raised = np.radians([-20.0, 25.0, -65.0]), math.radians(raised_deg)
        assert view.incidence_rad == pytest.approx(np.arccos(math.cos(raised) * np.cos(aside)), abs=1e-9)
        assert view.tilt_forward_rad == pytest.approx(np.full(3, raised), abs=1e-9)
        assert view.tilt_sideways_rad == pytest.approx(np.arctan(np.tan(aside) / math.cos(raised)), abs=1e-9)
        assert np.cos(view.normal_rad + math.radians(180.0 - 90.0 * axis)) == pytest.approx(np.ones(3))
        assert view.material_share["wood"] == pytest.approx(np.ones(3))
        assert view.reflectance == pytest.approx(np.full(3, 0.45))

    def test_of_a_wall_and_the_floor_the_view_is_the_mean_over_the_light(self, seen, plane_world):
        """Material, reflectance (1 of the floor) and normal, (-w, 0, 1 - w), with a share w of light from the wall.

        The axes of the side sensors point 45 degrees to the left and right; their own axes are those of the test above.
        """
        view = seen(plane_world(wall_x_m=0.6, floor=True), raised_deg=-8.0)
        wall = view.material_share["wood"]
        assert np.all((wall[0] > 0.1) & (wall[0] < 0.9))
        assert view.material_share["floor"] == pytest.approx(1.0 - wall)
        assert view.reflectance == pytest.approx(1.0 - 0.55 * wall)
        lifted = math.atan2(1.0 - wall[0], wall[0])
        assert view.tilt_forward_rad[0] == pytest.approx(lifted - math.radians(8.0), abs=1e-9)
        assert view.incidence_rad[0] == pytest.approx(abs(lifted - math.radians(8.0)), abs=1e-9)
        aside, raised, floor = np.radians([0.0, 45.0, -45.0]), math.radians(-8.0), 1.0 - wall
        towards = wall * math.cos(raised) * np.cos(aside) - floor * math.sin(raised)
        up = wall * math.sin(raised) * np.cos(aside) + floor * math.cos(raised)
        assert view.tilt_forward_rad == pytest.approx(np.arctan2(up, towards), abs=1e-9)
        assert view.tilt_sideways_rad == pytest.approx(np.arctan2(wall * np.sin(aside), towards), abs=1e-9)

    def test_where_nothing_is_seen_an_effect_of_the_reflectance_has_no_target(self, read):
        reading, status = read(CoverCrosstalk(strength_per_m2=0.1), distance_m=1e9)
        assert (reading, status) == (2.0, TofStatus.NO_TARGET)

    @pytest.mark.parametrize("tilt_deg", [0.0, 20.0])
    def test_the_incidence_on_a_wall_in_front_is_acute(self, read, monkeypatch, tilt_deg):
        """Its sine alone would be that of the obtuse angle to the other side of the wall, too."""
        seen = []
        monkeypatch.setattr(IncidenceBias, "apply", lambda _, reading, view: seen.append(view.incidence_rad) or reading)
        read(IncidenceBias(coefficient=0.2), at=(0.0, 0.0, math.radians(tilt_deg)))
        assert np.degrees(seen[0][0]) == pytest.approx(tilt_deg, abs=1e-3)

    def test_a_saturated_range_is_flat_through_its_noise(self, read):
        """reading <= saturation: of the reading as it is given, or the plateau would not be exactly flat."""
        saturated = read(RangeSaturation(saturation_m=0.3), noise_scale=10.0, quantisation_m=0.001)
        assert saturated == pytest.approx([0.3, TofStatus.VALID], abs=0.0)
        far, near = (RangeSaturation(saturation_m=limit_m) for limit_m in (9.0, 0.6))
        assert read(far, noise_scale=1.0)[0] == read(near, noise_scale=1.0)[0] < 0.6

    def test_a_turned_sensor_is_a_turned_robot_to_its_reading(self, robot, read):
        """About the mount: the same wall at the same distance from it, met at the same angle."""
        angle, mount = 0.25, robot.tof.mounts.front.x_m
        turned = read(TofMountYaw(sensor="front", angle_rad=angle))[0]
        nothing = TofMountYaw(sensor="front", angle_rad=0.0)
        same = read(nothing, at=(mount * (1.0 - math.cos(angle)), -mount * math.sin(angle), angle))[0]
        assert turned == pytest.approx(same, rel=1e-9)
        assert read(TofMountYaw(sensor="left", angle_rad=angle))[0] == read(nothing)[0]

    @pytest.mark.parametrize(
        ("values", "factor"),
        [
            (NoiseScale(scale=2.0), 2.0),
            (AmbientNoise(coefficient_per_klux=0.6), math.sqrt(1.0 + 0.6 * 5.0)),
        ],
    )
    def test_noise(self, robot, arena_of, plane_world, values, factor):
        config = robot.tof.model_copy(update={"quantisation_m": 0.0, "ambient_lux": 5000.0})
        world = plane_world(wall_x_m=robot.tof.mounts.front.x_m + 0.5)
        deviations = []
        for effects in (RobotEffects(), RobotEffects().with_effect(values)):
            tof = TofArray(config, arena_of(), 1000, np.random.Generator(np.random.PCG64(0)), effects)
            deviations.append(np.std([tof.sample(world)[0, 0] for _ in range(50)]))
        assert deviations[1] == pytest.approx(factor * deviations[0], rel=1e-9)

    def test_a_late_log_adds_to_the_delay(self, robot, arena_of):
        effects = RobotEffects().with_effect(TofTimeOffset(delay_s=0.04))
        config = robot.tof.model_copy(update={"delay_s": 0.01})
        tof = TofArray(config, arena_of(), 1000, np.random.Generator(np.random.PCG64(0)), effects)
        assert tof.sampling.delay_steps == 50


class TestInstruments:
    T_S = 0.005 * np.arange(1, 101)

    def test_current_is_amplified_and_shifted(self):
        effects = RobotEffects().with_effect(CurrentSensorGain(gain=1.1))
        np.testing.assert_allclose(read_current_A(effects, np.array([0.0, 2.0]), np.zeros(2)), [0.0, 2.2])
        effects = RobotEffects().with_effect(CurrentSensorOffset(offset_A=0.03))
        np.testing.assert_allclose(read_current_A(effects, np.array([0.0, 2.0]), np.zeros(2)), [0.03, 2.03])

    def test_speed_is_scaled(self):
        effects = RobotEffects().with_effect(SpeedScale(scale=0.9))
        np.testing.assert_allclose(read_speed_rad_s(effects, self.T_S[:2], np.array([[5.0], [10.0]])), [[4.5], [9.0]])

    def test_a_filtered_speed_lags_a_ramp_as_its_closed_form(self):
        """Exactly, for a ramp is straight between the rows: a (t - T (1 - exp(-t / T)))."""
        lag_s = 0.05
        effects = RobotEffects().with_effect(SpeedFilterLag(time_constant_s=lag_s))
        found = read_speed_rad_s(effects, self.T_S, 40.0 * self.T_S[:, None])[:, 0]
        expected = 40.0 * (self.T_S - lag_s * (1.0 - np.exp(-self.T_S / lag_s)))
        np.testing.assert_allclose(found, expected, atol=1e-12)

    @pytest.mark.parametrize("lag_s", [0.004, 0.02, 0.05])
    def test_a_filtered_speed_of_a_starting_wheel_is_that_of_two_lags_in_a_row(self, lag_s):
        """Closed form for a wheel with a time constant of 30 ms from rest; half a row late it would be off by 0.8."""
        wheel_s = 0.03
        effects = RobotEffects().with_effect(SpeedFilterLag(time_constant_s=lag_s))
        speed = 10.0 * (1.0 - np.exp(-self.T_S / wheel_s))
        found = read_speed_rad_s(effects, self.T_S, speed[:, None])[:, 0]
        left = (wheel_s * np.exp(-self.T_S / wheel_s) - lag_s * np.exp(-self.T_S / lag_s)) / (wheel_s - lag_s)
        np.testing.assert_allclose(found, 10.0 * (1.0 - left), atol=0.04)

    @pytest.mark.parametrize("tau_s", [0.002, 0.004658, 0.03])
    def test_the_converted_time_constant_of_a_filter_of_samples_lags_a_ramp_as_much_as_that_filter(self, tau_s):
        """The conversion of docs/reference/effects.md; the filter of samples is run here as a program runs it."""
        period_s = 0.005
        t_s = period_s * np.arange(1, 400)
        same_delay_s = period_s / (math.exp(period_s / tau_s) - 1.0)
        effects = RobotEffects().with_effect(SpeedFilterLag(time_constant_s=same_delay_s))
        continuous = read_speed_rad_s(effects, t_s, 40.0 * t_s[:, None])[-1, 0]
        of_samples = 0.0
        for speed in 40.0 * t_s:
            of_samples += (1.0 - math.exp(-period_s / tau_s)) * (speed - of_samples)
        assert continuous == pytest.approx(of_samples, abs=1e-9)

    def test_a_late_speed_is_that_of_before(self):
        effects = RobotEffects().with_effect(SpeedTimeOffset(delay_s=0.0325))
        speed = np.stack([3.0 * self.T_S, -2.0 * self.T_S], axis=1)
        expected = np.maximum(self.T_S - 0.0325, 0.0)[:, None] * np.array([3.0, -2.0])
        np.testing.assert_allclose(read_speed_rad_s(effects, self.T_S, speed), expected, atol=1e-12)

    @pytest.mark.parametrize("effect", [SpeedFilterLag(time_constant_s=0.05), SpeedTimeOffset(delay_s=0.02)])
    def test_readings_from_the_start_on_are_those_with_the_row_at_rest_left_out(self, effect):
        effects = RobotEffects().with_effect(effect)
        speed = 10.0 * (1.0 - np.exp(-self.T_S / 0.03))[:, None]
        t_s, with_rest = np.concatenate([[0.0], self.T_S]), np.concatenate([[[0.0]], speed])
        np.testing.assert_array_equal(
            read_speed_rad_s(effects, t_s, with_rest)[1:], read_speed_rad_s(effects, self.T_S, speed)
        )


class TestPoseLog:
    @pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0])
    def test_the_marker_lies_ahead_of_the_axle(self, plane_world, yaw):
        log = PoseLog(RobotEffects().with_effect(MarkerOffset(offset_m=0.04)), 1000)
        expected = (1.0 + 0.04 * math.cos(yaw), 2.0 + 0.04 * math.sin(yaw), yaw)
        assert log.sample(plane_world(at=(1.0, 2.0, yaw))) == pytest.approx(expected)

    def test_the_tracked_heading_of_a_body_askew_is_turned_and_its_place_is_not(self, plane_world):
        """The marker is ahead of the axle along the heading of the robot."""
        effects = RobotEffects().with_effect(MarkerYaw(angle_rad=-0.3)).with_effect(MarkerOffset(offset_m=0.04))
        expected = (1.0 + 0.04 * math.cos(0.7), 2.0 + 0.04 * math.sin(0.7), 0.4)
        assert PoseLog(effects, 1000).sample(plane_world(at=(1.0, 2.0, 0.7))) == pytest.approx(expected)

    def test_a_drifting_clock_logs_older_and_older_poses(self):
        """Ten per mille of 2 s are 20 ms, in addition to 47 ms."""
        effects = RobotEffects().with_effect(PoseTimeOffset(delay_s=0.047)).with_effect(PoseClockDrift(rate=0.01))
        assert [PoseLog(effects, 1000).sampling.step_read_at(step) for step in (0, 100, 2000)] == [0, 52, 1933]

    def test_a_simulation_refuses_poses_of_the_future(self):
        (fault,) = PoseClockDrift(rate=-0.001).faults(in_simulation=True)
        assert (fault.path, fault.got, fault.allowed) == (("rate",), -0.001, "0 or more")
        assert not list(PoseClockDrift(rate=-0.001).faults(in_simulation=False))

    def test_a_late_pose_is_that_of_exactly_so_long_ago(self):
        log = PoseLog(RobotEffects().with_effect(PoseTimeOffset(delay_s=0.047)), 1000)
        assert [log.sampling.step_read_at(step) for step in (0, 30, 50, 100)] == [0, 0, 3, 53]
