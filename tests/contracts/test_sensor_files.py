"""A robot names the files of own sensors: no option is needed, their text is kept, and nothing executes it."""

import hashlib
import json
import unicodedata

import pytest
from pydantic import ValidationError

from configs.draw import draw_run
from configs.loader import load_resolved, load_scenario
from configs.schema.code_file import CodeFile
from configs.schema.scenario import RunSpec
from configs.user_files import SENSOR_FILES
from configs.validation.json_schema import scenario_json_schema
from pipeline.cli import main
from pipeline.code_files import code_file_lines, named_contents
from pipeline.rerendering.robot_section import robot_of_images
from pipeline.run_folder.stored_spec import spec_problem
from pipeline.stages.simulate import simulate
from sensors.build import listed_sensors
from sensors.registry import SENSORS
from symolo.core.errors import InputError
from tests.contracts.test_own_sensor import TOY
from tests.fuzz.folders import valid_copy

ROBOT = """
extends: nominal
name: feeling
sensor_files: [code/feeler.py]
sensors: {front: {kind: feeler, travel_m: 0.02}}
"""


@pytest.fixture
def robot(tmp_path, monkeypatch):
    (tmp_path / "code").mkdir()
    (tmp_path / "code/feeler.py").write_text(TOY)
    path = tmp_path / "feeling.yaml"
    path.write_text(ROBOT)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    yield path
    forget()


def forget():
    for file in [*SENSORS.files.values()]:
        SENSORS.unload(file.path)


def drawn(robot, *settings):
    return draw_run(load_scenario("smoke", ["stop.time_limit_s=0.2", f"robot={robot}", *settings]), "CW", 1)


def test_the_robot_file_names_it_relative_to_itself_and_the_specification_has_its_text(robot):
    spec = drawn(robot)
    content = json.loads(spec.model_dump_json())["robot"]
    sha256 = hashlib.sha256(TOY.encode()).hexdigest()
    assert content["sensor_files"] == [{"name": "feeler", "file": "feeler.py", "sha256": sha256, "text": TOY}]
    assert simulate(spec).recording["sensor_front"].values.shape[1] == 2


@pytest.mark.usefixtures("robot")
def test_a_robot_that_extends_another_has_the_files_of_both_and_records_those_that_it_needs(tmp_path):
    (tmp_path / "other.py").write_text(TOY.replace("class Feeler", "class Whisker"))
    both = tmp_path / "both.yaml"
    both.write_text("extends: feeling.yaml\nname: both\nsensor_files: [other.py]\nsensors: {whisker: {}}\n")
    assert [file.name for file in drawn(both).robot.sensor_files] == ["feeler", "whisker"]
    assert [file.name for file in drawn(both, "robot.sensors.whisker=null").robot.sensor_files] == ["feeler"]
    assert drawn("nominal").robot.sensor_files == ()


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ("[code/feelor.py]", r"feeling\.yaml:4: robot\.sensor_files: no such file: got "),
        ("code/feeler.py", r"robot\.sensor_files: got 'code/feeler\.py', allowed: a list of Python files"),
        ("[{name: feeler, sha256: a, text: b}]", "sensor_files: got .*allowed: a list .*write it to a file"),
        ("[]", r"kind: got 'feeler', allowed: .*your own needs its file: robot\.sensor_files"),
    ],
)
def test_a_wrong_name_is_refused_with_its_place(robot, files, message):
    robot.write_text(ROBOT.replace("[code/feeler.py]", files))
    with pytest.raises(InputError, match=message):
        drawn(robot)


@pytest.mark.usefixtures("robot")
def test_a_setting_names_it_relative_to_the_working_folder(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path / "code")
    assert drawn("nominal", "robot.sensor_files=[feeler.py]", "robot.sensors.feeler={}").robot.sensor_files


class TestWithoutTheFile:
    @pytest.fixture
    def text(self, robot):
        text = drawn(robot).model_dump_json()
        forget()
        return text

    def test_it_is_read_and_written_back_equal_and_not_simulated(self, text):
        spec = RunSpec.model_validate_json(text)
        assert json.loads(spec.model_dump_json()) == json.loads(text)
        assert (spec_problem(text), SENSORS.files) == ("", {})
        with pytest.raises(InputError, match=r"sensor feeler: its file feeler\.py .*not loaded, .*; .*sensor extract"):
            simulate(spec)

    def test_it_is_simulated_with_the_same_file_and_no_other(self, text, tmp_path):
        path = tmp_path / "copy.py"
        path.write_text(TOY + "# another\n")
        SENSORS.load(path)
        with pytest.raises(InputError, match=r"the file has changed since the data were made: got .*, allowed: "):
            simulate(RunSpec.model_validate_json(text))
        path.write_text(TOY)
        SENSORS.load(path)
        assert simulate(RunSpec.model_validate_json(text)).finished

    def test_a_text_that_does_not_fit_its_hash_is_a_fault(self, text):
        assert "sensor_files.0.text" in spec_problem(text.replace("One ray", "").replace("is closed", "is open"))

    def test_whoever_needs_its_columns_is_answered_where_they_are(self, text):
        """As `report` of a run that was simulated and not released, whose columns no metadata.json states yet."""
        with pytest.raises(InputError, match=r"not loaded, which states .* columns .*sensor extract.* --sensor-file"):
            listed_sensors(RunSpec.model_validate_json(text).robot)

    def test_a_kind_without_a_record_of_its_file_is_answered_by_the_setting(self, text):
        content = json.loads(text)
        del content["robot"]["sensor_files"]
        with pytest.raises(
            InputError, match=r"robot\.sensors\.front: .*got 'feeler'.*needs its file: robot\.sensor_files"
        ):
            listed_sensors(RunSpec.model_validate(content).robot)

    @pytest.mark.parametrize("kind", [["feeler"], {"feeler": 1}, 5, None])
    def test_a_kind_that_is_no_text_is_a_fault(self, text, kind):
        content = json.loads(text)
        content["robot"]["sensors"]["front"]["kind"] = kind
        assert "kind: Input should be a valid string" in spec_problem(json.dumps(content))

    def test_settings_without_a_period_are_a_fault(self, text):
        content = json.loads(text)
        del content["robot"]["sensors"]["front"]["period_s"]
        assert "robot.sensors.front.period_s" in spec_problem(json.dumps(content))

    def test_its_images_may_have_another_camera(self, text):
        """Readings and their code are those of the run; nothing of the file is needed."""
        spec = RunSpec.model_validate_json(text)
        robot, _ = robot_of_images(spec, None, ["robot.camera.pitch_down_deg=20"], 1)
        assert robot.camera.pitch_down_deg == 20
        assert robot.model_copy(update={"camera": spec.robot.camera}) == spec.robot

    def test_no_run_is_drawn_from_its_scenario(self, robot):
        tree = load_scenario("smoke", [f"robot={robot}"]).tree
        forget()
        with pytest.raises(InputError, match=r"sensor feeler: its file .* is not loaded"):
            load_resolved(tree, "metadata.json")


def test_the_files_of_simulated_runs_are_listed_and_extracted_without_loading_them(robot, tmp_path, capsys):
    run = tmp_path / "data/.stages/simulate/CW/test_1"
    run.mkdir(parents=True)
    (run / "trajectory.npz").touch()
    (run / "spec.json").write_text(drawn(robot).model_dump_json())
    forget()
    (line,) = code_file_lines(tmp_path / "data")
    assert line.startswith("sensor feeler: made with feeler.py, SHA-256 ")
    assert main(["sensor", "extract", str(tmp_path / "data"), "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out/feeler.py").read_text() == TOY
    assert SENSORS.files == {}
    (run / "spec.json").write_text(drawn("nominal").model_dump_json())
    assert main(["sensor", "extract", str(tmp_path / "data"), "--out", str(tmp_path / "none")]) == 2
    assert "contains no file of sensors of a user's own" in capsys.readouterr().err


def test_the_schema_for_editors_takes_a_list_of_paths():
    definitions = scenario_json_schema()["$defs"]
    assert definitions["RobotConfig"]["properties"]["sensor_files"]["items"]["type"] == "string"


@pytest.mark.parametrize(
    "name",
    [
        "../evil.py",
        "a/b.py",
        "a\\b.py",
        "C:evil.py",
        ".evil.py",
        "e\nvil.py",
        "e\x1b[2Jvil.py",
        "e\x9b2Jvil.py",
        "e\u202evil.py",
        "e\u2028vil.py",
        "e\u2066vil.py",
        "evil.pth",
        "x" * 252 + ".py",
    ],
)
def test_a_name_that_leads_elsewhere_or_controls_a_terminal_is_a_fault(name):
    with pytest.raises(ValidationError, match=r"file\n"):
        CodeFile(name="feeler", file=name, sha256=hashlib.sha256(b"").hexdigest(), text="")


def test_the_name_of_a_file_is_quoted_where_a_command_is_printed():
    file = CodeFile(name="feeler", file="$(rm x).py", sha256=hashlib.sha256(b"").hexdigest(), text="")
    assert "symolo --sensor-file '$(rm x).py' ..." in str(SENSOR_FILES.problem(file))


@pytest.mark.parametrize("names", [["a.py", "A.py"], ["\u00e9.py", "e\u0301.py"], ["made", "a.py", "a.py"]])
def test_no_extracted_file_hides_another_one(names):
    """The last of three gets a name with its SHA-256, which a publisher may have given to the first."""
    texts = [str(number) for number in range(len(names))]
    digests = [hashlib.sha256(text.encode()).hexdigest() for text in texts]
    names = [f"a-{digests[-1][:8]}.py" if name == "made" else name for name in names]
    parts = zip(names, digests, texts, strict=True)
    files = [CodeFile(name="feeler", file=name, sha256=digest, text=text) for name, digest, text in parts]
    contents = named_contents(files)
    assert [*contents.values()] == [text.encode() for text in texts]
    assert len({unicodedata.normalize("NFC", name).lower() for name in contents}) == len(texts)


def test_of_very_many_files_the_first_are_listed(robot, tmp_path):
    run = tmp_path / "data/.stages/simulate/CW/test_1"
    run.mkdir(parents=True)
    (run / "trajectory.npz").touch()
    content = json.loads(drawn(robot).model_dump_json())
    texts = [f"# {number}" for number in range(1000)]
    content["robot"]["sensor_files"] = [
        {"name": "feeler", "file": "a.py", "sha256": hashlib.sha256(text.encode()).hexdigest(), "text": text}
        for text in texts
    ]
    (run / "spec.json").write_text(json.dumps(content))
    forget()
    *lines, more = code_file_lines(tmp_path / "data")
    assert (len(lines), more) == (20, "made with 980 further files of sensors; `symolo sensor extract` writes all")


def test_a_record_in_the_description_that_no_file_can_have_is_a_fault(tmp_path, symolo, sign):
    root = valid_copy("dataset", tmp_path)
    content = json.loads((root / "metadata.json").read_bytes())
    content["scenario"]["robot"]["sensor_files"] = [{"name": "feeler", "file": "a.py", "sha256": 64 * "0", "text": ""}]
    (root / "metadata.json").write_text(json.dumps(content))
    sign(root)
    ended = symolo("verify", root)
    assert (ended.code, "robot.sensor_files.0: " in ended.out) == (4, True)
    ended = symolo("sensor", "extract", root, "--out", tmp_path / "out")
    assert (ended.code, "metadata.json: is damaged" in ended.err) == (2, True)
    assert not (tmp_path / "out").exists()
