"""Names of columns: words, units and the quantities that they mean."""

import math

import pytest

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.quantities import KINDS
from logs.units.names import HeaderName, factor_to, taken_apart
from symolo.core.errors import InputError


@pytest.mark.parametrize(
    ("name", "words", "unit"),
    [
        ("time_ms", ("time",), "ms"),
        ("timestamp", ("timestamp",), ""),
        ("timeMs", ("time",), "ms"),
        ("millis", (), "ms"),
        ("t", ("t",), ""),
        ("s", ("s",), ""),
        ("x [mm]", ("x",), "mm"),
        ("x(cm)", ("x",), "cm"),
        ("heading_deg", ("heading",), "degrees"),
        ("yaw [°]", ("yaw",), "degrees"),
        ("motor_left (V)", ("motor", "left"), "V"),
        ("wheelSpeedRpm", ("wheel", "speed"), "rpm"),
        ("v_cmd_mm_s", ("v", "cmd"), "mm/s"),
        ("encL", ("enc", "l"), ""),
        ("leftTicks", ("left",), "ticks"),
        ("Drehzahl [1/min]", ("drehzahl",), "rpm"),
        ("speed (U/min)", ("speed",), "rpm"),
        ("tof front [unknown]", ("tof", "front", "unknown"), ""),
        ("x_in", ("x",), "in"),
        ("range (inch)", ("range",), "in"),
        ("time in s", ("time", "in"), "s"),
        ("time (in s)", ("time",), "s"),
        ("speed (left wheel, m/s)", ("speed", "left", "wheel"), "m/s"),
        ("x [mocap; mm]", ("x", "mocap"), "mm"),
        ("x (in mm.)", ("x",), "mm"),
        ("theta (ccw)", ("theta", "ccw"), ""),
        ("distance_in_s", ("distance", "in"), "s"),
        ("speed [in/s]", ("speed",), "in/s"),
        ("supply [kV]", ("supply", "k", "v"), ""),
        ("t [10 ms]", ("t", "10", "ms"), ""),
        ("enc [ticks/rev]", ("enc", "ticks", "rev"), ""),
        ("left_ticks_per_rev", ("left", "ticks", "per", "rev"), ""),
        ("battery_in", ("battery", "in"), ""),
        ("y [ft]", ("y",), "ft"),
        ("heading [gon]", ("heading",), "gon"),
        ("speed_kmh", ("speed",), "km/h"),
        ("speed [km/h]", ("speed",), "km/h"),
        ("speed mph", ("speed",), "mph"),
        ("v [m.s-1]", ("v",), "m/s"),
        ("v (m s^-1)", ("v",), "m/s"),
        ("v_mm_per_s", ("v",), "mm/s"),
        ("gyro [°/s]", ("gyro",), "degrees per second"),
        ("gyro °/s", ("gyro",), "degrees per second"),
        ("w [rad s⁻¹]", ("w",), "rad/s"),
        ("w (deg/sec)", ("w",), "degrees per second"),
        ("t [µs]", ("t",), "us"),
        ("t [μs]", ("t",), "us"),
        ("t_ns", ("t",), "ns"),
        ("t [min]", ("t",), "minutes"),
        ("range_min", ("range", "min"), ""),
        ("duty %", ("duty",), "percent"),
        ("duty%", ("duty",), "percent"),
        ("%time", ("time",), ""),
    ],
)
def test_a_name_is_taken_apart_into_words_and_unit(name, words, unit):
    assert taken_apart(name) == HeaderName(words, unit)


@pytest.mark.parametrize("name", ["theta (ccw)", "theta (clockwise)", "angle (odom)"])
def test_a_word_in_brackets_that_is_no_unit_is_not_taken_for_an_unknown_one(name):
    assert not taken_apart(name).unknown


@pytest.mark.parametrize(
    ("ours", "unit", "factor"),
    [("m", "cm", 0.01), ("s", "us", 1e-6), ("rad", "deg", 3.14159265358979 / 180), ("rad/s", "rpm", 0.10471975512)],
)
def test_a_unit_gives_its_factor(ours, unit, factor):
    assert factor_to(ours, unit, "here") == pytest.approx(factor)
    assert factor_to(ours, "", "here") == factor_to(ours, ours, "here") == 1.0


@pytest.mark.parametrize(
    ("ours", "unit", "factor"),
    [
        ("m", "inch", 0.0254),
        ("m", "ft", 0.3048),
        ("m", "um", 1e-6),
        ("rad", "gon", 2.0 * math.pi / 400.0),
        ("rad", "rev", 2.0 * math.pi),
        ("rad/s", "rps", 2.0 * math.pi),
        ("s", "min", 60.0),
        ("m/s", "km/h", 1000.0 / 3600.0),
        ("m/s", "mph", 1609.344 / 3600.0),
        ("m/s", "ft/s", 0.3048),
        ("m/s", "in/s", 0.0254),
    ],
)
def test_a_unit_that_is_only_stated_has_its_defined_factor(ours, unit, factor):
    """NIST SP 811, appendix B: an inch is 0.0254 m, a mile 1609.344 m, and a turn has 400 gon."""
    assert factor_to(ours, unit, "here") == pytest.approx(factor, rel=1e-15)


def test_a_unit_of_another_quantity_is_refused():
    with pytest.raises(InputError, match=r"columns.x_m: unit: got 'deg', allowed: m, mm, cm"):
        factor_to("m", "deg", "columns.x_m")


DRIVES = (
    "time_ms,uL,uR,encL,encR,x_cm,y_cm,heading_deg",
    "t [s];left motor voltage [V];right motor voltage [V];ticks left;ticks right;x [mm];y [mm];theta [rad]".replace(
        ";", ","
    ),
    "stamp,voltage_l,voltage_r,left_encoder,right_encoder,pose_x,pose_y,yaw",
    "T,MotL,MotR,CountsL,CountsR,posX_cm,posY_cm,compass",
    "Zeit [s];Spannung links [V];Spannung rechts [V];Ticks links;Ticks rechts;X [cm];Y [cm];Winkel [°]".replace(
        ";", ","
    ),
    "epoch_ms,throttle_left,throttle_right,ticks_l,ticks_r,x_m,y_m,theta_rad",
    "temps (s);tension gauche (V);tension droite (V);ticks gauche;ticks droite;x (m);y (m);theta".replace(";", ","),
    "millis,motorLeft_mV,motorRight_mV,cntLeft,cntRight,xM,yM,thetaDeg",
)


@pytest.mark.parametrize("header", DRIVES)
def test_the_columns_of_a_drive_are_recognised(header):
    names = header.split(",")
    expected = ("t_s", "u_left_V", "u_right_V", "enc_left_ticks", "enc_right_ticks", "x_m", "y_m", "theta_rad")
    assert KINDS[CaseKind.DRIVE_LOG].matched(names) == dict(sorted(zip(expected, names, strict=True), key=_order))


def _order(item):
    return KINDS[CaseKind.DRIVE_LOG].names.index(item[0])


@pytest.mark.parametrize(
    ("kind", "header", "expected"),
    [
        (CaseKind.MOTOR_STEADY, "PWM,Voltage (V),Current (mA),Speed (rpm)", ("u_cmd_V", "current_A", "omega_rad_s")),
        (CaseKind.MOTOR_STEP, "time_us,run,u,i,omega", ("t_s", "trial", "u_cmd_V", "current_A", "omega_rad_s")),
        (CaseKind.TOF_BENCH, "true distance [mm],tof [mm],target", ("distance_m", "reading_m", "material")),
        (CaseKind.TOF_BENCH, "set distance (mm),sensor (mm),surface", ("distance_m", "reading_m", "material")),
        (CaseKind.DRIVE_LOG, "t,tof_f,tof_l,tof_r", ("t_s", "tof_front_m", "tof_left_m", "tof_right_m")),
        (CaseKind.DRIVE_LOG, "t,range_mm,x,y,yaw", ("t_s", "tof_front_m", "x_m", "y_m", "theta_rad")),
        (CaseKind.DRIVE_LOG, "t,dticks_left,delta_enc_r", ("t_s", "enc_left_ticks", "enc_right_ticks")),
    ],
)
def test_the_columns_of_other_logs_are_recognised(kind, header, expected):
    assert set(KINDS[kind].matched(header.split(","))) == set(expected)


def test_words_that_are_not_known_are_no_quantity():
    header = ["gyro_z", "battery_V", "state", "line_3", "motor_temperature", "foo_mm", "error_theta", "x_target"]
    assert KINDS[CaseKind.DRIVE_LOG].matched(header) == {}


@pytest.mark.parametrize("kind", KINDS)
def test_our_own_names_are_recognised(kind):
    names = [name for name in KINDS[kind].scales if name not in {"row", "session_time_s"}]
    matches = KINDS[kind].matched(names)
    assert {quantity: column for quantity, column in matches.items() if quantity != column} == {}
    assert set(matches) == set(names)


def test_columns_of_a_motor_with_unknown_names_are_recognised_by_their_units():
    columns = ["Zeit [s]", "Spannung [V]", "Strom [mA]", "Drehzahl [1/min]"]
    assert KINDS[CaseKind.MOTOR_STEP].matched(columns) == {
        "t_s": "Zeit [s]",
        "u_cmd_V": "Spannung [V]",
        "current_A": "Strom [mA]",
        "omega_rad_s": "Drehzahl [1/min]",
    }


@pytest.mark.parametrize("others", [["battery [V]"], ["Akku [V]"], ["Spannung 1 [V]", "Spannung 2 [V]"]])
def test_a_unit_alone_names_no_supply_and_none_of_two_columns(others):
    assert "u_cmd_V" not in KINDS[CaseKind.MOTOR_STEP].matched(["Zeit [s]", "Drehzahl [1/min]", *others])


def test_a_named_column_goes_before_one_with_the_unit_alone():
    columns = ["t [s]", "pwm", "Sensor X [V]", "speed [rpm]"]
    assert KINDS[CaseKind.MOTOR_STEP].matched(columns)["u_cmd_V"] == "pwm"
