"""Measured cases written by hand, small enough to check by eye."""

from collections.abc import Callable
from pathlib import Path

import pytest

MOTOR = """\
motor:
  winding_resistance_ohm: {value: 3.0, tolerance: 0.03}
  torque_constant_N_m_A: {value: 0.3, tolerance: 0.002}
  viscous_friction_N_m_s_rad: {value: 0.002, tolerance: 0.0001}
  coulomb_friction_N_m: {value: 0.02, tolerance: 0.001}
  supply_voltage_V: 7.4
"""
GEARED = """\
  rotor_inertia_kg_m2: {value: 0.003, tolerance: 6e-05}
  motor_side_inertia_fraction: 0.6
  motor_side_friction_fraction: 0.5
"""
TOF_NOISE = "polynomial_mm: [1.4, 4.88, 2.51, 1.15]"
NOMINAL = {
    "motor_steady": f"kind: motor_steady\n{MOTOR}noise: {{current_A: 0.001, omega_rad_s: 0.04}}\n",
    "motor_step": (
        f"kind: motor_step\n{MOTOR}{GEARED}sample_rate_Hz: 200\n"
        "noise: {current_A: 0.012, omega_rad_s: 0.1, lag1_correlation: 0.3}\n"
    ),
    "tof_bench": (
        "kind: tof_bench\ntof:\n  range_offset_m: {value: 0, tolerance: 0.0005}\n"
        "  range_scale: {value: 1, tolerance: 0.002}\n  reference_temperature_C: 25\n  resolution_m: 0.001\n"
        f"  reflectance: {{wood: 0.45, plastic: 0.6}}\nnoise:\n  {TOF_NOISE}\n  polynomial_origin_m: 0.18\n"
    ),
    "drive_log": (
        f"kind: drive_log\n{MOTOR}  rotor_inertia_kg_m2: {{value: 0.003, tolerance: 6e-05}}\n"
        "robot:\n  wheel_radius_m: {value: 0.03, tolerance: 4e-05}\n"
        "  wheel_separation_m: {value: 0.16, tolerance: 0.0006}\n  encoder_ticks_per_revolution: 1920\n"
        "tof:\n  range_offset_m: {value: 0, tolerance: 0.0005}\n  max_range_m: 1.2\n  mount:\n"
        "    front: {x_m: 0.06, y_m: 0, yaw_rad: 0}\n    left: {x_m: 0.045, y_m: 0.05, yaw_rad: 0.785}\n"
        "    right: {x_m: 0.045, y_m: -0.05, yaw_rad: -0.785}\nworld: {room_x_m: 2.0, room_y_m: 1.6}\n"
        "noise:\n  wheel_speed_rad_s: 0.045\n  pose_xy_m: 0.001\n  pose_theta_rad: 0.003\n"
        "  travel_m_per_sqrt_m: 0.0006\n"
        f"  tof_{TOF_NOISE}\n  tof_polynomial_origin_m: 0.18\n"
    ),
}
HEADER = {
    "motor_steady": "row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s",
    "motor_step": "trial,split,session_time_s,t_s,u_cmd_V,current_A,omega_rad_s",
    "tof_bench": "row,split,t_s,distance_m,material,incidence_rad,temperature_C,ambient_lux,reading_m",
    "drive_log": (
        "trial,split,session_time_s,t_s,v_cmd_m_s,w_cmd_rad_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks,"
        "tof_front_m,tof_left_m,tof_right_m,x_m,y_m,theta_rad"
    ),
}
ROWS = {
    "motor_steady": (
        "1,1,fit,0.0,0.0,0.0002,0.0",
        "2,1,fit,3.0,2.5,0.0812,7.52",
        "3,1,holdout,6.0,5.0,0.0958,15.71",
        "4,2,fit,9.0,5.0,0.0961,",
        "5,2,fit,12.0,2.5,0.0809,7.55",
    ),
    "motor_step": (
        "1,fit,0.005,0.005,0.0,0.01,-0.1",
        "1,fit,0.010,0.010,3.0,0.98,0.6",
        "1,fit,0.020,0.020,3.0,,1.9",
        "2,holdout,2.005,0.005,0.0,0.0,0.0",
        "2,holdout,2.010,0.010,-3.0,-0.99,-0.5",
    ),
    "tof_bench": (
        "1,fit,0.0,0.320,wood,0.0,24.6,902,0.321",
        "2,fit,2.0,0.140,plastic,0.7854,32.3,5384,",
        "3,holdout,4.0,0.540,wood,0.0,15.5,308,8.190",
    ),
    "drive_log": (
        "1,fit,0.00,0.00,0.0,0.0,0.5,0.5,0,0,0.9,,1.1,1.0,0.8,3.1",
        "1,fit,0.05,0.05,0.1,0.0,0.5,0.5,4,5,0.9,8.190,1.1,1.0004,0.8,3.1",
        "1,fit,0.10,0.10,0.1,0.0,,,9,11,0.9,8.191,1.1,1.001,,3.1",
        "2,holdout,5.00,0.00,0.1,0.0,0.5,0.5,0,0,0.9,,1.1,1.0,0.8,0.1",
        "2,holdout,5.05,0.05,0.1,0.0,0.5,0.5,4,5,0.9,,1.1,1.0004,0.8,0.1",
    ),
}
KINDS = tuple(ROWS)


@pytest.fixture
def case(tmp_path: Path) -> Callable[..., Path]:
    """Write a case of a kind, the rows of data.csv and the text of nominal.yaml changed where that is asked for."""

    def write(kind: str, *, data: str | bytes | None = None, nominal: str | None = None) -> Path:
        folder = tmp_path / kind
        folder.mkdir(exist_ok=True)
        (folder / "nominal.yaml").write_text(NOMINAL[kind] if nominal is None else nominal)
        text = text_of(kind) if data is None else data
        (folder / "data.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
        return folder

    return write


def text_of(kind: str) -> str:
    return "\n".join((HEADER[kind], *ROWS[kind])) + "\n"


@pytest.fixture
def text() -> Callable[[str], str]:
    """The good data.csv of a kind."""
    return text_of
