"""A controller of the user, a class in a file or a program at a pipe, drives a run as the built-in one does."""

import json
import re
import shutil
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.robot_controller import ChosenController
from physics.control.program import PROGRAM
from physics.control.registry import CONTROLLERS
from physics.drivetrain.motor import MotorModel
from pipeline.stages.simulate import simulate
from pipeline.user_code import environment, hashes_of_files, not_loaded
from symolo.core.errors import InputError, RunFailed

EXAMPLES = Path(__file__).parents[2] / "examples"
TOY = """
from pydantic import Field

from physics.control.base import ControllerSettings, Observation, RobotController, State, Twist, Voltages


class Toy(RobotController):
    class Settings(ControllerSettings):
        speed_m_s: float = Field(default=0.1, ge=-1, le=1)

    def start(self):
        self.seen = []

    def step(self, seen: Observation):
        self.seen.append(seen)
        return Twist(self.settings.speed_m_s, 0.0, State.RIGHT_WALL)
"""
SHORT = ("stop.lap=false", "stop.time_limit_s=1")


def written(folder, text=TOY):
    path = folder / "toy.py"
    path.write_text(text)
    return path


@pytest.fixture
def toy(tmp_path):
    path = written(tmp_path)
    yield CONTROLLERS.load(path)
    CONTROLLERS.unload(path)


@pytest.fixture
def load(tmp_path):
    paths = []

    def loaded(step):
        body = textwrap.indent(textwrap.dedent(step).strip(), "        ")
        paths.append(written(tmp_path, TOY.partition("    def step")[0] + "    def step(self, seen):\n" + body))
        return CONTROLLERS.load(paths[-1])

    yield loaded
    for path in paths:
        CONTROLLERS.unload(path)


@pytest.fixture
def program(tmp_path):
    """Write a program, which drives from then on."""

    def use(text):
        path = tmp_path / "program.py"
        path.write_text(textwrap.dedent(text))
        PROGRAM.choose(f"{sys.executable} {path}")

    yield use
    PROGRAM.command = ()


def drawn(*settings, scenario="smoke"):
    return draw_run(load_scenario(scenario, [*SHORT, *settings]), "CW", 1)


def of_program(**settings):
    limits = [f"controller.program.{name}={value}" for name, value in settings.items()]
    return drawn(*(limits or ["controller.program={}"]))


def test_the_built_in_controller_is_one_of_them():
    bare, named = (simulate(drawn(*more)).recording for more in ((), ("controller.built_in={}",)))
    for one, other in zip(bare.series, named.series, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
    assert "controller" not in json.loads(drawn().model_dump_json())


def test_a_loaded_file_drives_where_the_scenario_names_no_controller(toy):
    spec = drawn()
    assert spec.controller == ChosenController("toy", toy.Settings())
    recording = simulate(spec).recording
    assert set(recording.trajectory.state) == {1}
    assert recording["command"].values.tolist() == [[0.1, 0.0]] * 21
    assert recording.trajectory.twist[-1, 0] == pytest.approx(0.1, abs=0.003)


@pytest.mark.usefixtures("toy")
def test_its_settings_are_keys_with_bounds_that_may_be_drawn():
    spec = drawn("controller.toy.speed_m_s={uniform: [0.05, 0.15]}")
    assert 0.05 <= spec.drawn["controller.toy.speed_m_s"] == spec.controller.settings.speed_m_s <= 0.15
    with pytest.raises(InputError, match=r"speed_m_s: got 3(\.0)?, allowed: number >= -1"):
        drawn("controller.toy.speed_m_s=3")
    with pytest.raises(InputError, match=r"unknown key.*did you mean speed_m_s"):
        drawn("controller.toy.speed=0.1")
    with pytest.raises(InputError, match=r"controller: got 'toy, program', allowed: the name of one controller"):
        drawn("controller={toy: {}, program: {}}")
    with pytest.raises(InputError, match="none, since the board drives"):
        drawn("controller.toy={}", "board.kind=simulated")
    assert drawn("board.kind=simulated").controller is None


@pytest.mark.usefixtures("toy")
def test_the_specification_is_read_where_the_class_is_not_loaded_and_does_not_drive(tmp_path):
    spec = drawn()
    CONTROLLERS.unload(tmp_path / "toy.py")
    read = type(spec).model_validate_json(spec.model_dump_json())
    assert read.model_dump_json() == spec.model_dump_json()
    with pytest.raises(InputError, match=r"controller\.toy: no such controller.*--controller-file"):
        simulate(read)
    assert [*not_loaded(read)] == ["controller toy is not loaded; name its file: symolo --controller-file FILE ..."]
    CONTROLLERS.load(tmp_path / "toy.py")
    assert [*not_loaded(read)] == []


def test_it_observes_what_the_sensors_deliver_and_not_the_effects_of_its_robot(load):
    load("""
        self.seen = [*self.seen, seen]
        type(self).last = self
        return Twist(0.1, 0.0)
    """)
    spec = drawn("robot.effects.wheelbase_scale.scale=1.1")
    recording = simulate(spec).recording
    controller = CONTROLLERS.by_name()["toy"].last
    assert not [*controller.robot.effects]
    assert len([*spec.robot.effects]) == 1
    np.testing.assert_array_equal([seen.line for seen in controller.seen], recording["line"].values)
    np.testing.assert_array_equal(
        [(seen.front_m, seen.left_m, seen.right_m) for seen in controller.seen], recording["tof_m"].values
    )
    np.testing.assert_array_equal([seen.encoder_counts for seen in controller.seen], recording["encoder_counts"].values)
    np.testing.assert_array_equal(
        np.cumsum([seen.encoder_increments for seen in controller.seen], axis=0), recording["encoder_counts"].values
    )
    assert [seen.t_s for seen in controller.seen] == recording.trajectory.t_s.tolist()


def test_voltages_act_without_the_wheel_loops_and_reach_the_speed_of_the_motor_equation(load):
    load("return Voltages(2.0, 2.0)")
    spec = drawn("stop.time_limit_s=3")
    recording = simulate(spec).recording
    assert (recording["voltage_V"].values == 2.0).all()
    motor, radius_m = MotorModel.from_config(spec.robot.motor), 0.5 * spec.robot.drive.wheel_diameter_m
    stall = motor.torque_constant_N_m_A * 2.0 / motor.resistance_ohm
    speed = radius_m * (stall - motor.coulomb_N_m) / motor.damping_N_m_s_rad  # Eq. 20 without derivative
    np.testing.assert_allclose(recording["command"].values, [[speed, 0.0]] * 61, atol=1e-9)
    # The caster's friction takes a little of it.
    assert recording.trajectory.twist[-1, 0] == pytest.approx(speed, rel=0.03)


@pytest.mark.parametrize(
    ("step", "problem"),
    [
        ("return None", r"controller toy at 0\.00 s: step returned nothing \(null\), allowed: Twist or Voltages"),
        ("return Twist(float('nan'), 0.0)", r"v_m_s is nan, allowed: a number from -1000 to 1000"),
        ("return Twist(0.1, 2000.0)", r"w_rad_s is 2000\.0, allowed"),
        ("return Twist('fast', 0.0)", r"v_m_s is 'fast', allowed"),
        ("return Voltages(1.0, 1.0, 7)", r"state is 7, allowed: State\.LINE"),
        ("return 1 / 0", r"controller toy at 0\.00 s: toy\.py:\d+: ZeroDivisionError: division by zero"),
    ],
)
def test_a_mistake_ends_the_run_with_its_time_and_place(load, step, problem):
    load(step)
    with pytest.raises(RunFailed, match=problem):
        simulate(drawn())


def test_a_mistake_in_the_middle_of_a_run_keeps_what_was_driven(load):
    load("return Twist(0.1, 0.0) if seen.t_s < 0.5 else None")
    outcome = simulate(drawn())
    assert outcome.problems[0].startswith("controller toy at 0.50 s: step returned nothing")
    assert len(outcome.recording.trajectory.t_s) == 10


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("def step", "def stepped"), "controller toy: step missing.*define step"),
        (("class Toy", "class BuiltIn"), "controller built_in: the name is taken"),
        (("Settings(ControllerSettings)", "Settings"), "controller toy: Settings does not derive"),
        (("(RobotController)", "(object)"), "got 'none', allowed: one class that derives from RobotController"),
    ],
)
def test_a_file_that_is_not_complete_is_refused(tmp_path, change, message):
    before = CONTROLLERS.classes()
    with pytest.raises(InputError, match=message):
        CONTROLLERS.load(written(tmp_path, TOY.replace(*change)))
    assert CONTROLLERS.classes() == before


def test_a_run_is_driven_again_where_the_file_changed_and_workers_load_it(toy, tmp_path):
    before = hashes_of_files(drawn())
    assert before.keys() == {toy.name}
    written(tmp_path, TOY + "# changed\n")
    assert hashes_of_files(drawn()) != before
    assert environment()["SYMOLO_CONTROLLER_FILES"] == str(tmp_path / "toy.py")


def test_the_same_controller_as_class_and_as_program_drives_the_same_run():
    path = EXAMPLES / "line_follower.py"
    CONTROLLERS.load(path)
    try:
        by_class = simulate(drawn()).recording
    finally:
        CONTROLLERS.unload(path)
    PROGRAM.choose(f"{sys.executable} {EXAMPLES / 'line_follower_program.py'}")
    try:
        spec = drawn()
        by_program = simulate(spec).recording
        again = simulate(spec).recording
    finally:
        PROGRAM.command = ()
    assert spec.controller.name == "program"
    for one, other, third in zip(by_class.series, by_program.series, again.series, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
        np.testing.assert_array_equal(third.values, other.values)


READY = """
    import json, sys, time
    json.loads(sys.stdin.readline())
    print('{"ready": true}', flush=True)
    for line in sys.stdin:
        tick = json.loads(line)["tick"]
        good = json.dumps({"tick": tick, "v_m_s": 0.1, "w_rad_s": 0.0})
"""


@pytest.mark.parametrize(
    ("answer", "problem"),
    [
        ("sys.exit('no more ideas')", r"ended with status 1 before it answered tick 0 .*errors: no more ideas"),
        ("print('hello', flush=True)", r"answered tick 0 \(0\.00 s\) with 'hello': Invalid JSON"),
        ("print(good.replace('0.1', 'NaN'), flush=True)", r"v_m_s: Input should be a finite number"),
        ("print(good.replace('v_m_s', 'v'), flush=True)", r"v: Extra inputs are not permitted"),
        ("print(good.replace('\"tick\": 0', '\"tick\": 5'), flush=True)", r"with an answer to tick 5"),
        ("print(good[:-1] + ', \"state\": 99}', flush=True)", r"state: .*99"),
        ("print(good[:-1] + ', \"left_V\": 1}', flush=True)", r"v_m_s and w_rad_s, or right_V and left_V"),
        ("print(good + '\\n' + good, flush=True)", r"more than one line"),
        ("print('x' * 100_000, flush=True)", r"with more than 65536 bytes"),
        ("[sys.stderr.write('x' * 10_000) for _ in range(100)]; sys.exit(3)", r"ended with status 3"),
    ],
)
def test_a_program_that_dies_lies_or_floods_ends_the_run(program, answer, problem):
    program(READY + f"        {answer}\n")
    with pytest.raises(RunFailed, match=problem):
        simulate(of_program())


def test_a_program_that_is_silent_is_given_up(program):
    program(READY + "        time.sleep(60)\n")
    with pytest.raises(RunFailed, match=r"did not answer tick 0 \(0\.00 s\) within 0\.3 s"):
        simulate(of_program(answer_within_s=0.3))


def test_a_program_that_speaks_before_it_is_asked_is_refused(program):
    program("print('Loading...', flush=True)\nimport time\ntime.sleep(30)\n")
    with pytest.raises(RunFailed, match=r"the first line with 'Loading\.\.\.'|wrote 'Loading"):
        simulate(of_program())


def test_no_process_is_left(program, tmp_path):
    program(READY + f"        open({str(tmp_path / 'alive')!r}, 'w').close(); print(good, flush=True)\n")
    outcome = simulate(of_program())
    assert not outcome.problems
    assert (tmp_path / "alive").exists()
    (program_py,) = tmp_path.glob("program.py")
    commands = [path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline") if _is_readable(path)]
    assert not any(str(program_py).encode() in command for command in commands)


def _is_readable(path):
    try:
        path.read_bytes()
    except OSError:
        return False
    return True


def test_a_scenario_names_no_program_to_run(symolo, tmp_path):
    ended = symolo("simulate", "smoke", "--set", "controller.program={}", "--out", tmp_path / "out")
    assert ended.code == 2
    assert "controller.program: no program; name it before the command: symolo --controller-command" in ended.err
    assert not (tmp_path / "out/.stages/simulate").exists()
    ended = symolo("simulate", "smoke", "--set", "controller.program.command=ls", "--out", tmp_path / "out")
    assert ended.code == 2
    assert "controller.program.command: unknown key" in ended.err
    with pytest.raises(InputError, match="no such program: got 'no-such-program'"):
        PROGRAM.choose("no-such-program --fast")
    with pytest.raises(InputError, match="close the quotes"):
        PROGRAM.choose("python3 'my file.py")


@pytest.mark.usefixtures("hands")
def test_a_release_names_its_controller(tmp_path, tiny, symolo):
    path, out = shutil.copy(EXAMPLES / "line_follower.py", tmp_path), tmp_path / "data"
    settings = [*tiny, "--set=stop.lap=false", "--workers", "1"]
    try:
        assert symolo("--controller-file", path, "release", "smoke", "--out", out, *settings).code == 0
    finally:
        CONTROLLERS.unload(path)
    metadata = json.loads((out / "metadata.json").read_text())
    controller = metadata["runs"][0]["controller"]
    assert controller["name"] == "line_follower"
    assert re.fullmatch("[0-9a-f]{64}", controller["files"]["line_follower"])
    assert metadata["scenario"]["controller"] == {"line_follower": {"gain_rad_s": 0.9, "speed_m_s": 0.18}}
    ended = symolo("verify", out)
    assert (ended.code, "no fault" in ended.out) == (0, True)
