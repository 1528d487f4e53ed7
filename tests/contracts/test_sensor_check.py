"""`symolo sensor check` finds what is wrong with a sensor in a file, and `symolo sensor new` writes a good one."""

import hashlib
import re
import shlex

import numpy as np
import pytest

from configs.loader import load_scenario
from pipeline.sensors.template import template
from pipeline.stages.simulate import simulate
from sensors.registry import SENSORS
from tests.contracts.test_own_sensor import drawn

GOOD = template("compass")
RETURN = "return np.array([-np.angle(np.exp(-1j * heading_rad))])"
ELSEWHERE = "world.pose = lambda: (0.0, 0.0, 0.1 * world.time_s); "
"""Code that moves the robot for all sensors."""
DIGITS = '"rad", 4, '


@pytest.fixture
def checked(tmp_path, symolo):
    """Checks the template with a replaced text."""

    def check(before="", after=""):
        path = tmp_path / "compass.py"
        assert before in GOOD
        path.write_text(GOOD.replace(before, after, 1) if before else GOOD)
        try:
            return symolo("sensor", "check", path)
        finally:
            if path in {file.path for file in SENSORS.files.values()}:
                SENSORS.unload(path)

    return check


def test_the_template_keeps_every_rule_and_its_readings_are_shown(checked):
    ended = checked()
    assert (ended.code, "FAILED" in ended.out) == (0, False)
    ((low, high),) = [map(float, ends) for ends in re.findall(r"heading \[rad\]: (\S+) to (\S+)\n", ended.out)]
    # The robot drives straight ahead from its start, which looks to -90 degrees; the noise has 1 degree.
    assert -np.pi / 2 - 0.1 < low < -np.pi / 2 < high < -np.pi / 2 + 0.1
    assert "symolo --sensor-file" in ended.out


@pytest.mark.parametrize(
    ("before", "after", "rule", "message"),
    [
        ('    """Heading of the robot, measured with a compass."""', "", "texts", "the class has no docstring"),
        ('"rad"', '" "', "texts", "column heading has no unit: write '-'"),
        ("default=1.0, ge=0", "ge=0", "settings", "noise_deg has no default"),
        (RETURN, "return np.zeros(3)", "form", r"the reading at 0\.000 s: got '\[0\. 0\. 0\.\]', allowed: a finite"),
        (RETURN, "return np.array([np.nan])", "form", r"the reading at 0\.000 s: got '\[nan\]'"),
        (RETURN, "return np.array([nothing])", "runs", r"sample fails in line \d+: NameError"),
        (DIGITS, '"rad", 0, ', "digits", "column heading has 0 digits, for whole numbers, and a reading is -1.5"),
        (RETURN, "return np.array([1e-6 * heading_rad])", "digits", "changes by .*, and 4 digits show none of it"),
        ("self.rng.standard_normal()", "np.random.standard_normal()", "repeats", "take random numbers from self.rng"),
        (
            RETURN,
            "Compass.memory = 0 if world.time_s == 0 else Compass.memory + 1; return np.array([float(Compass.memory)])",
            "several",
            "beside a second one of its kind it gives other readings",
        ),
        (
            RETURN,
            "return np.array([1.0 / (90.0 - self.settings.noise_deg)])",
            "bounds",
            r"with noise_deg=90.*, sample fails in line \d+: ZeroDivisionError",
        ),
        (RETURN, "return np.array([float(hash('a') % 10**6)])", "process", "in another process, .* other readings"),
        (RETURN, ELSEWHERE + RETURN, "others", "with the sensor, line has other values"),
    ],
)
def test_a_broken_rule_is_named_with_what_to_do(checked, before, after, rule, message):
    ended = checked(before, after)
    assert ended.code == 2
    assert re.search(rf"FAILED +{rule} .*\n +.*{message}", ended.out), ended.out
    assert re.search(rf"{'FAILED' if rule == 'process' else '-'} +process ", ended.out), ended.out
    assert "breaks a rule, see above" in ended.err


def test_an_array_that_is_returned_again_keeps_no_later_reading(tmp_path):
    path = tmp_path / "compass.py"
    again = "self.kept = getattr(self, 'kept', np.zeros(1)); self.kept[0] = world.time_s; return self.kept"
    path.write_text(GOOD.replace(RETURN, again))
    SENSORS.load(path)
    try:
        series = simulate(drawn("robot.sensors.compass={}")).recording["sensor_compass"]
    finally:
        SENSORS.unload(path)
    np.testing.assert_allclose(series.values[:, 0], series.t_s)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Compass", "allowed: small letters and digits"),
        ("imu", "a shipped sensor has this name; take another one"),
        ("none", "None cannot be the name of a class"),
        ("board", "the name is taken by another file of side/"),
    ],
)
def test_a_name_that_cannot_be_is_refused(tmp_path, monkeypatch, symolo, name, message):
    monkeypatch.chdir(tmp_path)
    ended = symolo("sensor", "new", name)
    assert (ended.code, message in ended.err) == (2, True)
    assert not list(tmp_path.iterdir())


def test_a_written_file_is_not_replaced(tmp_path, monkeypatch, symolo):
    monkeypatch.chdir(tmp_path)
    assert symolo("sensor", "new", "rear_compass").code == 0
    assert "class RearCompass(Sensor)" in (tmp_path / "rear_compass.py").read_text()
    assert symolo("sensor", "new", "rear_compass").code == 2


def test_all_kinds_are_listed_with_columns_and_units(symolo):
    out = symolo("sensor", "list").out
    assert re.search(r"^ultrasonic +Range to the first echo .*\n +columns: range \[m\]$", out, re.MULTILINE)
    assert re.search(r"^lidar .*\n +columns: range_0\.\.range_359 \[m\], .*default settings", out, re.MULTILINE)


def test_one_kind_is_shown_with_its_columns_settings_and_file(symolo):
    lines = [line.strip() for line in symolo("sensor", "show", "lidar").out.splitlines()]
    assert "defined in:  sensors/ranging/lidar.py, shipped with symolo" in lines
    assert "range_0..range_359 [m]: distance along the ray, 0 for no return" in lines
    place = lines.index("max_range_m: number > 0 and <= 100, default 8.0")
    assert lines[place + 1] == "Largest range that is measured [m]."
    assert lines[-1] == "try it:      symolo simulate smoke --set 'robot.sensors.lidar={}' --out data"
    inertial = symolo("sensor", "show", "imu").out
    assert f"accelerometer.range_m_s2: number > 0 and <= 10000, default {2 * 9.80665}" in inertial


@pytest.mark.parametrize("name", [kind.name for kind in SENSORS.shipped])
def test_every_kind_is_shown(symolo, name):
    ended = symolo("sensor", "show", name)
    assert (ended.code, ended.out.splitlines()[0]) == (0, name)


@pytest.mark.parametrize("kind", [kind for kind in SENSORS.shipped if kind.is_listed()], ids=lambda kind: kind.name)
def test_the_command_that_is_shown_gives_a_robot_such_a_sensor(symolo, kind):
    command = shlex.split(symolo("sensor", "show", kind.name).out.splitlines()[-1].partition("try it:")[2])
    assert command[:3] == ["symolo", "simulate", "smoke"]
    setting = command[command.index("--set") + 1]
    assert any(name in setting for name in load_scenario("smoke", [setting]).tree["robot"]["sensors"])


def test_a_kind_of_ones_own_is_shown_with_its_file_and_option(tmp_path, symolo):
    path = tmp_path / "compass.py"
    path.write_text(GOOD)
    try:
        out = symolo("--sensor-file", path, "sensor", "show", "compass").out
    finally:
        SENSORS.unload(path)
    assert f"defined in:  {path} (SHA-256 {hashlib.sha256(path.read_bytes()).hexdigest()})" in out
    assert f"symolo --sensor-file {path} simulate smoke --set 'robot.sensors.compass={{}}'" in out


def test_a_kind_with_a_setting_without_default_is_shown(tmp_path, symolo):
    path = tmp_path / "compass.py"
    path.write_text(GOOD.replace("offset_deg: float = Field(default=0.0, ", "offset_deg: float = Field("))
    try:
        out = symolo("--sensor-file", path, "sensor", "show", "compass").out
    finally:
        SENSORS.unload(path)
    assert "offset_deg: number >= -180 and <= 180, no default" in out
    assert "heading [rad]: heading from +x" in out
    assert "robot.sensors.compass={offset_deg: VALUE}" in out


def test_an_unknown_kind_is_answered_by_the_nearest(symolo):
    ended = symolo("sensor", "show", "lidr")
    assert (ended.code, "did you mean lidar" in ended.err, "symolo --sensor-file FILE" in ended.err) == (2, True, True)
