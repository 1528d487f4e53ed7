"""Refusals of numbers that are probably in another unit than that of their field."""

import pytest

from configs.loader import load_scenario
from symolo.core.errors import InputError


@pytest.mark.parametrize(
    ("setting", "ending"),
    [
        ("robot.drive.track_m=190", "is it in metres? 190 mm are 0.19"),
        ("robot.drive.wheel_diameter_m=80", "is it in metres? 80 mm are 0.08"),
        ("robot.drive.caster_x_m=-70", "is it in metres? -70 mm are -0.07"),
        ("robot.tof.period_s=33", "is it in seconds? 33 ms are 0.033, a rate of 33 Hz is 0.0303"),
        ("robot.sensors.imu.period_s=200", "is it in seconds? 200 ms are 0.2, a rate of 200 Hz is 0.005"),
        ("robot.chassis.mass_kg=1700", "is it in kilograms? 1700 g are 1.7"),
        ("robot.power.battery_voltage_V=7400", "is it in volts? 7400 mV are 7.4"),
        ("robot.encoder.counts_per_revolution=2248.86", "to 2249, with which wheels and odometry are then simulated"),
        ("robot.controller.line.k1_m_s=180", "is it in metres per second? 180 cm/s are 1.8, 180 mm/s are 0.18"),
        ("robot.tof.dropout_probability=5", "is it a part of 1? 5 % are 0.05"),
        ("robot.effects.wheel_radius_asymmetry.asymmetry=2", "is it a part of 1? 2 % are 0.02"),
        ("robot.effects.wheel_radius_scale.scale=98.5", "is it a factor? 98.5 % are 0.985"),
        ("robot.effects.wheel_radius_scale.scale=0.015", "is it a factor? with a deviation of 0.015 it is 1.015"),
        ("robot.effects.tof_mount_yaw={sensor: front, angle_rad: 3}", "is it in radians? 3 deg are 0.0523599"),
        ("robot.camera.field_of_view_deg=1.22", "is it in degrees? 1.22 rad are 69.9009"),
        ("robot.camera.focal_length_mm=0.03", "is it in millimetres? 0.03 m are 30"),
        ("robot.camera.sensor_width_mm=0.00423", "is it in millimetres? 0.00423 m are 4.23"),
        ("robot.tof.dropout_probability=1.2", "number >= 0 and <= 1"),
        ("robot.wheel_loop.integral_V_rad=300", "number >= 0 and <= 100"),
        ("robot.chassis.clearance_m=0.3", "number >= 0.002 and <= 0.2"),
        ("robot.motor.coulomb_friction_N_m=20", "number >= 0 and <= 10"),
        ("look.camera.vignetting=50", "is it a part of 1? 50 % are 0.5"),
        ("look.tape.paint.saturation=90", "is it a part of 1? 90 % are 0.9"),
        ("arena.line.reflectance=10", "is it a part of 1? 10 % are 0.1"),
        ("splits={by: run, shares: {train: 70, test: 0.3}}", "is it a part of 1? 70 % are 0.7"),
        ("look.sun.elevation_deg=0.6", "is it in degrees? 0.6 rad are 34.3775"),
        ("look.sun.illuminance_klx=20000", "is it in kilolux? 20000 lx are 20"),
        ("look.lamps.flux_klm=6000", "is it in kilolumens? 6000 lm are 6"),
        ("robot.camera.distortion.k1=-2", "number >= -1 and <= 1"),
        ("look.sun.elevation_deg=95", "number >= 1 and <= 90"),
    ],
)
def test_a_number_that_is_not_allowed_is_followed_by_what_it_may_mean(setting, ending):
    with pytest.raises(InputError) as error:
        load_scenario("symolo", [setting])
    assert str(error.value).endswith(ending)
