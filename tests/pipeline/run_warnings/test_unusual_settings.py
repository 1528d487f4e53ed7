"""Settings that are within their bounds and probably in another unit."""

import itertools

import pytest

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.references import shipped_names
from pipeline.run_warnings.simulated_run import plan_warnings, run_warnings
from pipeline.run_warnings.unusual_settings import unusual_settings
from pipeline.stages.simulate import simulate
from tests.release_fixtures import ONE_ROUTE

ARC = "{kind: arc, center: [0.30, 0.50], radius_m: 0.25, start_deg: 0, end_deg: 1.5708}"
CART = "[{{name: Cart, center: [-0.2, 0.3], motion: {{waypoints: [{{t_s: {t_s}, turn_deg: {turn_deg}}}]}}}}]"
CAMERA = "{{kind: camera, x_m: 0, z_m: 0.15, period_s: 1, width_px: 32, height_px: 24, pitch_up_deg: {pitch_up_deg}}}"


def warnings_of(*settings):
    return plan_warnings(draw_all(load_scenario("smoke", [ONE_ROUTE, *settings])))


@pytest.mark.parametrize(
    ("setting", "ending"),
    [
        ("robot.sensors.lidar.ray_step_deg=0.0175", "within 6.3 degrees; if it is in radians, write ray_step_deg: 1"),
        ("robot.sensors.lidar={rays: 270, ray_step_deg: -0.0175}", "if it is in radians, write ray_step_deg: -1"),
        ("robot.tof.beam_sigma_deg=0.122", "if it is in radians, write beam_sigma_deg: 7"),
        ("robot.sensors.sonar={kind: ultrasonic, field_of_view_deg: 0.524}", "radians, write field_of_view_deg: 30"),
        ("robot.camera.pitch_down_deg=0.52", "if it is in radians, write pitch_down_deg: 30"),
        (
            f"arena.line.pieces=[{{kind: straight, start: [0.55, -0.7], end: [0.55, 0.5]}}, {ARC}]",
            "arena.line.pieces.1.end_deg 1.5708 looks like radians; if it is in radians, write end_deg: 90",
        ),
        ("robot.sensors.imu.gyroscope.bias_sd_rad_s=0.3", "if it is in deg/s, write bias_sd_rad_s: 0.00524"),
        ("robot.sensors.imu.gyroscope.range_rad_s=250", "if it is in deg/s, write range_rad_s: 4.36"),
        ("robot.encoder.dropout_probability=1", "if it is in per cent, write dropout_probability: 0.01"),
        ("robot.tof.dropout_probability=1", "if it is in per cent, write dropout_probability: 0.01"),
        ("robot.tof.quantisation_m=0.1", "if it is in mm, write quantisation_m: 0.0001"),
        ("stop.time_limit_s=6000", "if it is in ms, write time_limit_s: 6"),
        ("render.jpeg_quality=1", "if it is in parts of one, write jpeg_quality: 100"),
        ("look.tape.paint.hue_deg=0.5", "if it is in turns, write hue_deg: 180"),
        ("rates.camera_hz=0.2", "one image in 5 s; if it is the time between two images, write camera_hz: 5"),
        # 0.9 kg at wheels of 32.5 mm have 9.5e-4 kg m2.
        ("robot.motor.rotor_inertia_kg_m2=1", "as if the robot were 1053 times as heavy; if it is in kg cm2, write "),
        ("robot.drive.track_m=0.07", "if it is the distance of a wheel from the middle, write track_m: 0.14"),
        ("robot.drive.wheel_diameter_m=0.0325", "may cut bends; if wheel_diameter_m is the radius, write 0.065"),
        # (6 V - R Tc / K) / (K + R B / K) = 17.4 rad/s at wheels of 32.5 mm.
        (
            "robot.controller.avoidance.speed_m_s=1.5",
            "avoidance.speed_m_s asks a wheel for 1.5 m/s, and the motors reach 0.57 m/s at 6 V with wheels of 0.065 m",
        ),
        (f"arena.obstacles={CART.format(t_s=2, turn_deg=3.14159)}", "if it is in radians, write turn_deg: 180"),
        (
            f"arena.obstacles={CART.format(t_s=2000, turn_deg=90)}",
            "2000 means that Cart does not reach it before the run ends at 6 s; if it is in ms, write t_s: 2",
        ),
        (
            "robot.power={battery_voltage_V: 12, motor_voltage_limit_V: 24}",
            "24 is more than the battery has: the motors get up to 12 V (robot.power.battery_voltage_V)",
        ),
        ("robot.line_sensor.height_m=0.03", "line sensor is farther from the floor than the 9.5 mm of its data sheet"),
        ("robot.camera.height_above_base_m=1.2", "means that the camera is 1.2 m above a body of 0.18 m"),
        ("robot.camera.roll_deg=0.0873", "if it is in radians, write roll_deg: 5"),
        ("robot.camera.yaw_left_deg=0.3491", "if it is in radians, write yaw_left_deg: 20"),
        (f"robot.sensors.rear={CAMERA.format(pitch_up_deg=-0.44)}", "if it is in radians, write pitch_up_deg: -25"),
        # 400 ug/sqrt(Hz) and 5 mg of the data sheet of the MPU-6050, with 9.80665 m/s^2 for 1 g.
        (
            "robot.sensors.imu={accelerometer: {noise_density_m_s2_rtHz: 0.4}}",
            "the accelerometer is very noisy; if it is in mg/sqrt(Hz), write noise_density_m_s2_rtHz: 0.00392",
        ),
        ("robot.sensors.imu.accelerometer.bias_sd_m_s2=5", "if it is in mg, write bias_sd_m_s2: 0.049"),
        ("robot.sensors.imu.gyroscope.misalignment_sd_rad=0.3", "in degrees, write misalignment_sd_rad: 0.00524"),
        ("robot.tof.delay_s=0.5", "readings that are old; if it is in ms, write delay_s: 0.0005"),
        # Eight sensors, 0.03 m apart, are 0.21 m wide.
        (
            "robot.line_sensor.pitch_m=0.03",
            "0.21 m, is wider than the body, 0.17 m; if it is the distance of the outer ones, write pitch_m: 0.00429",
        ),
        # Half of 0.17 m less the 0.03 m at which the sensor is mounted.
        ("robot.controller.wall.target_distance_m=0.012", "reaches 0.055 m farther to the side than the sensor"),
        # 1e-6 * 2.8535 / 0.31057^2 = 3.0e-5 s.
        ("robot.motor.rotor_inertia_kg_m2=1e-6", "up to speed within 0.03 ms, and small motors need 3 ms or more"),
        ("robot.drive.wheel_friction=0.009", "the wheels slide as on ice"),
        (
            "arena.obstacles=[{name: b, center: [3, 3], size: [8, 0.08, 0.12]}]",
            "beyond the floor, which ends at 4 m (arena.floor.half_extent_m); if its 8 m are cm, write 0.08",
        ),
        (
            "robot.effects.wheel_radius_asymmetry.asymmetry=0.6",
            "for two wheels of the same type, one per cent is much; if it is in per cent, write asymmetry: 0.006",
        ),
    ],
)
def test_a_number_in_another_unit_is_named_with_the_number_to_write(setting, ending):
    (warning,) = warnings_of(setting)
    assert setting.partition("=")[0].rpartition(".")[2] in warning
    assert ending in warning


@pytest.mark.parametrize(
    "setting",
    [
        "robot.sensors.lidar={rays: 8, ray_step_deg: 0.5}",
        "robot.sensors.lidar={rays: 1000, ray_step_deg: 0.1}",
        "robot.tof.beam_sigma_deg=1",
        "robot.camera.pitch_down_deg=0.6",
        "robot.camera.pitch_down_deg=0",
        "robot.camera.pitch_down_deg=5",
        "robot.camera.roll_deg=0.35",
        "robot.camera.roll_deg=5",
        "robot.camera.yaw_left_deg=0.09",
        "robot.camera.yaw_left_deg=2.09",
        f"robot.sensors.rear={CAMERA.format(pitch_up_deg=-5)}",
        f"robot.sensors.rear={CAMERA.format(pitch_up_deg=0.5)}",
        "robot.sensors.imu={accelerometer: {noise_density_m_s2_rtHz: 0.01, bias_sd_m_s2: 0.78}}",
        "robot.sensors.imu.gyroscope.misalignment_sd_rad=0.05",
        "robot.tof.delay_s=0.12",
        "robot.line_sensor.pitch_m=0.02",
        "robot.motor.rotor_inertia_kg_m2=0",
        "robot.motor.rotor_inertia_kg_m2=5e-5",
        "robot.drive.wheel_friction=0.1",
        "robot.drive.wheel_friction={uniform: [0.01, 0.02]}",
        "arena.obstacles=[{name: b, center: [3, 3], size: [3, 0.08, 0.12]}]",
        f"arena.obstacles={CART.format(t_s=90, turn_deg=1)}",
        "robot.power={battery_voltage_V: 12, motor_voltage_limit_V: 12}",
        "robot.encoder.dropout_probability=0.5",
        "robot.tof.dropout_probability={uniform: [0.9, 1]}",
        "robot.tof.quantisation_m=0",
        "stop.time_limit_s=1800",
        "render.jpeg_quality=2",
        "look.tape.paint.hue_deg=0",
        "rates.camera_hz=0",
        "rates.camera_hz=0.5",
        "robot.motor.rotor_inertia_kg_m2=0.02",
        "robot.drive.track_m=0.1",
        "robot.controller.avoidance.speed_m_s=0.5",
        "robot.line_sensor.height_m=0.009",
        "robot.camera.height_above_base_m=0.8",
        "robot.effects.wheel_radius_asymmetry.asymmetry=0.1",
        "robot.effects.wheel_radius_asymmetry.asymmetry={uniform: [0.5, 0.6]}",
    ],
)
def test_unusual_numbers_that_may_be_meant_and_drawn_ones_get_no_warning(setting):
    assert warnings_of(setting) == ()


def test_the_record_of_a_run_has_the_warning():
    (spec,) = draw_all(
        load_scenario("smoke", [ONE_ROUTE, "stop.time_limit_s=1", "robot.encoder.dropout_probability=1"])
    )
    assert any(
        text.endswith("write dropout_probability: 0.01") for text in run_warnings(spec, simulate(spec).recording)
    )


@pytest.mark.parametrize(("robot", "look"), list(itertools.product(shipped_names("robot"), shipped_names("look"))))
def test_shipped_robots_and_looks_have_usual_numbers(robot, look):
    for spec in draw_all(load_scenario("smoke", [f"robot={robot}", f"look={look}"])):
        assert list(unusual_settings(spec)) == []
