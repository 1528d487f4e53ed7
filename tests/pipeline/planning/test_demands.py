"""What a scenario demands beyond the ranges in which a diagnosis measured the robot."""

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.posterior.schema import LoadedPosterior
from pipeline.planning.demands import demand_lines, demands_of, source_line


def posterior(**measured):
    ranges = [{"covariate": q, "quantity": q, "low": low, "high": high} for q, (low, high) in measured.items()]
    hypothesis = {key: [] for key in ("left_out", "not_determined", "fixed", "numbers", "factor", "effect_ranges")}
    hypotheses = [
        {"name": name, "weight": weight, **hypothesis} for name, weight in (("no effect", 0.75), ("sag", 0.25))
    ]
    return LoadedPosterior.model_validate(
        {
            "version": 1, "source": "bench (motor_steady)", "robot": "nominal", "something_else": 0.03,
            "unexplained": "", "hypotheses": hypotheses, "measured": ranges, "noise": [], "sha256": "0" * 64,
        }
    )  # fmt: skip


@pytest.fixture(scope="module")
def spec():
    controller = "robot.controller"
    settings = [f"{controller}.line.k1_m_s=0.3", f"{controller}.corner.turn_rate_rad_s=2.0"]
    return draw_run(load_scenario("smoke", settings), "CW", 1)


def test_speeds_of_the_wheels_and_their_steady_voltage_follow_from_the_speeds_of_the_robot(spec):
    """A steady motor needs the voltage of its back-EMF and that of the current for its friction."""
    demands = {(each.quantity, each.cause): each.value for each in demands_of(spec) if each.value > 0.0}
    drive, motor = spec.robot.drive, spec.robot.motor
    line, corner = "robot.controller.line.k1_m_s", "robot.controller.corner.turn_rate_rad_s"
    assert demands["v_m_s", line] == 0.3
    speed = 0.3 / (0.5 * drive.wheel_diameter_m)
    assert demands["wheel_speed_rad_s", line] == pytest.approx(speed)
    current = (motor.viscous_friction_N_m_s_rad * speed + motor.coulomb_friction_N_m) / motor.torque_constant_N_m_A
    volts = motor.torque_constant_N_m_A * speed + motor.winding_resistance_ohm * current
    assert demands["voltage_V", line] == pytest.approx(volts)
    assert demands["wheel_speed_rad_s", corner] == pytest.approx(
        2.0 * 0.5 * drive.track_m / (0.5 * drive.wheel_diameter_m)
    )


def test_only_what_leaves_the_measured_range_or_was_not_measured_has_a_line(spec):
    inside = {"voltage_V": (-9.0, 9.0), "wheel_speed_rad_s": (-20.0, 20.0), "w_rad_s": (-3.0, 3.0), "tof_m": (0.0, 3.0)}
    assert demand_lines(posterior(v_m_s=(0.0, 0.5), **inside), [spec]) == ()
    assert demand_lines(posterior(v_m_s=(0.1, 0.2), **inside), [spec]) == (
        "v_m_s was measured from 0.1 to 0.2; demanded: 0.3 (robot.controller.line.k1_m_s)",
    )
    assert demand_lines(posterior(**inside), [spec]) == (
        "v_m_s was not measured; the scenario demands up to 0.3 (robot.controller.line.k1_m_s)",
    )
    assert demand_lines(None, [spec]) == ()


def test_the_source_of_the_robots_has_the_weight_of_each_hypothesis():
    text = "like bench (motor_steady): no effect 75 %, sag 25 %; probability that the truth is something else 3 %"
    assert source_line(posterior()) == text
    assert source_line(None) == ""
    replaced = ["robot.power.battery_voltage_V"]
    assert source_line(posterior(), replaced) == f"{text}; in place of what the scenario draws: {replaced[0]}"
