"""A sensor in a file of the user's own is all that a sensor of the project is, from the schema to the report."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import symolo as library
from configs.draw import draw_run
from configs.loader import load_scenario
from configs.validation.json_schema import scenario_json_schema
from pipeline.run_folder.changes import changes
from pipeline.stages.simulate import simulate
from pipeline.stages.simulate_runs import simulation_key
from pipeline.user_code import environment
from pipeline.work.units import SimulateUnit
from pipeline.work.worker_main import do
from sensors.build import build_sensors
from sensors.registry import SENSORS
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from tests.release_fixtures import ONE_ROUTE

TOY = '''
"""A feeler at the robot's front."""

import math

import numpy as np
from pydantic import Field

from configs.robot_sensors import SensorSettings
from sensors.base import Sensor
from symolo.dataset.tables.column import Column


class Feeler(Sensor):
    """Contact of the feeler at the robot's front: closed where
    a wall or an obstacle is within its travel.

    It looks along one ray.
    """

    class Settings(SensorSettings):
        x_m: float = Field(default=0.08, ge=-0.5, le=0.5)
        height_m: float = Field(default=0.05, gt=0, le=0.5)
        travel_m: float = Field(default=0.01, gt=0, le=1)
        reach_m: float = Field(default=2.0, gt=0, le=10)

    columns = (
        Column("contact", "-", 0, "1 where the feeler is closed"),
        Column("clearance", "m", 3, "distance straight ahead, or the reach"),
    )

    def sample(self, world):
        x, y, yaw = world.pose()
        ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        origin = np.array([x, y, self.settings.height_m]) + self.settings.x_m * ahead
        hits = world.cast(origin[None], (origin + self.settings.reach_m * ahead)[None])
        clearance_m = hits.fraction[0] * self.settings.reach_m
        return np.array([clearance_m <= self.settings.travel_m, clearance_m])
'''
TRAVEL = "robot.sensors.feeler.travel_m"
MEANING = "Contact of the feeler at the robot's front: closed where a wall or an obstacle is within its travel."


def written(folder: Path, text: str = TOY) -> Path:
    path = folder / "feeler.py"
    path.write_text(text)
    return path


@pytest.fixture
def toy(tmp_path):
    path = written(tmp_path)
    yield SENSORS.load(path)
    SENSORS.unload(path)


@pytest.fixture(scope="module")
def released(tmp_path_factory, tiny, in_this_process):
    """A release by the command with its option, simulated by a process of its own; the file is unloaded then."""
    from pipeline.cli import main  # noqa: PLC0415

    folder = tmp_path_factory.mktemp("own")
    path, out = written(folder), folder / "data"
    arguments = ["smoke", "--out", str(out), *tiny, f"--set={ONE_ROUTE}", "--set", f"{TRAVEL}={{uniform: [0.4, 0.9]}}"]
    try:
        assert main(["--sensor-file", str(path), "simulate", *arguments]) == 0
        with in_this_process():
            assert main(["--sensor-file", str(path), "release", *arguments]) == 0
    finally:
        SENSORS.unload(path)
    return out


def drawn(*settings):
    return draw_run(load_scenario("smoke", ["stop.time_limit_s=0.5", *settings]), "CW", 1)


def test_it_is_unknown_before_it_is_loaded_and_after_it_is_unloaded(tmp_path):
    path = written(tmp_path)
    for _ in range(2):
        with pytest.raises(InputError, match=r"sensors\.feeler.* allowed.*your own needs its file: .* --sensor-file"):
            drawn(f"{TRAVEL}=0.02")
        SENSORS.load(path)
        assert drawn(f"{TRAVEL}=0.02").robot.sensors.get("feeler").travel_m == 0.02
        SENSORS.unload(path)


@pytest.mark.usefixtures("toy")
def test_it_is_a_key_of_the_schema_with_bounds_and_defaults():
    definitions = scenario_json_schema()["$defs"]
    settings, _ = definitions["RobotSensors"]["properties"]["feeler"]["anyOf"]
    properties = definitions[settings["$ref"].rsplit("/", 1)[1]]["properties"]
    number, _ = properties["travel_m"]["anyOf"]
    assert number == {"type": "number", "exclusiveMinimum": 0, "maximum": 1}
    assert properties["period_s"]["default"] == 0.05
    settings = load_scenario("smoke", [f"{TRAVEL}=0.02"]).tree["robot"]["sensors"]["feeler"]
    defaults = {"kind": "feeler", "x_m": 0.08, "height_m": 0.05, "reach_m": 2.0, "period_s": 0.05, "delay_s": 0.0}
    assert settings == {**defaults, "travel_m": 0.02}
    with pytest.raises(InputError, match=r"travel_m: got 3(\.0)?, allowed: number > 0(\.0)? and <= 1"):
        drawn(f"{TRAVEL}=3")
    with pytest.raises(InputError, match="did you mean travel_m"):
        drawn("robot.sensors.feeler.travl_m=0.02")
    with pytest.raises(InputError, match="did you mean feeler"):
        drawn("robot.sensors.feelor.travel_m=0.02")


@pytest.mark.usefixtures("toy")
def test_a_robot_has_several_of_a_kind_each_with_a_name_and_a_random_stream_of_its_own():
    names = {"front": "{kind: feeler, x_m: 0.08}", "rear": "{kind: feeler, x_m: -0.08, period_s: 0.1}"}
    spec = drawn(*(f"robot.sensors.{name}={value}" for name, value in names.items()))
    assert [(name, settings.kind, settings.x_m) for name, settings in spec.robot.sensors] == [
        ("front", "feeler", 0.08),
        ("rear", "feeler", -0.08),
    ]
    assert type(spec).model_validate_json(spec.model_dump_json()) == spec
    streams = []
    build_sensors(
        spec.robot, Arena.from_config(spec.arena), 1000, lambda name: streams.append(name) or np.random.default_rng()
    )
    assert streams[-2:] == ["front", "rear"]
    recording = simulate(spec).recording
    np.testing.assert_allclose(recording["sensor_front"].t_s, np.arange(11) * 0.05)
    np.testing.assert_allclose(recording["sensor_rear"].t_s, np.arange(6) * 0.1)


@pytest.mark.usefixtures("toy")
@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("front={travel_m: 0.01}", r"robot\.sensors\.front(\.kind)?: missing; allowed: .*one of .*feeler"),
        ("front={kind: feelor}", r"kind: got 'feelor', allowed: .*one of .*feeler.*did you mean feeler"),
        ("tof={kind: feeler}", r"got 'tof', allowed: names of small letters.*other than board, camera"),
        ("Front={kind: feeler}", r"got 'Front', allowed: names of small letters"),
        ("front={kind: feeler, period_s: 0.0333}", r"front\.period_s: got 0\.0333, allowed: a whole number of physics"),
        ("front={kind: feeler, period_s: {uniform: [0.1, 0.2]}}", r"allowed: a number or \{choice"),
    ],
)
def test_a_sensor_that_cannot_be_is_refused_with_its_place(setting, message):
    with pytest.raises(InputError, match=message):
        drawn(f"robot.sensors.{setting}")


@pytest.mark.usefixtures("toy")
def test_it_is_an_axis_of_randomisation():
    spec = drawn(f"{TRAVEL}={{uniform: [0.01, 0.03]}}")
    assert 0.01 <= spec.drawn[TRAVEL] == spec.robot.sensors.get("feeler").travel_m <= 0.03
    assert type(spec).model_validate_json(spec.model_dump_json()) == spec


def test_a_robot_without_it_has_the_same_specification_and_recording_as_before(toy):
    spec = drawn()
    assert "sensors" not in json.loads(spec.model_dump_json())["robot"]
    bare, more = (simulate(run).recording for run in (spec, drawn(f"{TRAVEL}=0.02")))
    names = [series.name for series in bare.series]
    assert [series.name for series in more.series if series.name != "sensor_feeler"] == names
    for name in names:
        np.testing.assert_array_equal(more[name].values, bare[name].values)
    assert more["sensor_feeler"].unit == "-, m"
    assert toy.name == "feeler"


@pytest.mark.usefixtures("toy")
def test_its_readings_are_the_distances_to_the_walls_of_the_arena():
    spec = drawn(f"{TRAVEL}=0.02", "robot.sensors.feeler.x_m=0")
    recording = simulate(spec).recording
    contact, clearance_m = recording["sensor_feeler"].values.T  # noqa: PD011 - no pandas
    boxes = Arena.from_config(spec.arena).boxes
    expected_m = [min([2.0, *(_distance_m(pose, box) for box in boxes)]) for pose in recording.trajectory.pose]
    np.testing.assert_allclose(clearance_m, expected_m, atol=2e-3)
    assert (contact == (clearance_m <= 0.02)).all()


def _distance_m(pose, box):
    """Distance [m] along the heading to a box on the floor by the slab method; infinite where the ray misses it."""
    turn = np.array([[math.cos(box.yaw_rad), math.sin(box.yaw_rad)], [-math.sin(box.yaw_rad), math.cos(box.yaw_rad)]])
    origin = turn @ (pose[:2] - np.array(box.center[:2]))
    ahead = turn @ np.array([math.cos(pose[2]), math.sin(pose[2])])
    half = 0.5 * np.array(box.size[:2])
    with np.errstate(divide="ignore"):
        near, far = np.sort([(-half - origin) / ahead, (half - origin) / ahead], axis=0)
    return near.max() if 0 < near.max() <= far.min() else math.inf


def test_the_dataset_holds_its_table_and_metadata_its_columns(released):
    metadata = json.loads((released / "metadata.json").read_text())
    assert metadata["sensors"] == {"feeler": {"kind": "feeler", "meaning": MEANING}}
    assert metadata["columns"]["side/feeler.csv"] == [
        {"name": "t", "unit": "ms", "meaning": "time of the sample since the start of the run", "decimals": 3},
        {"name": "contact", "unit": "-", "meaning": "1 where the feeler is closed", "decimals": 0},
        {"name": "clearance", "unit": "m", "meaning": "distance straight ahead, or the reach", "decimals": 3},
    ]
    # Each column of each table says what it is.
    assert all(column["meaning"] for columns in metadata["columns"].values() for column in columns)
    for run in metadata["runs"]:
        table = pd.read_csv(released / run["run"] / "side/feeler.csv")
        assert list(table) == ["t", "contact", "clearance"]
        np.testing.assert_array_equal(table["t"], np.arange(run["rows"]) * 50.0)
        np.testing.assert_array_equal(table["contact"], (table["clearance"] <= run["drawn"][TRAVEL]).astype(int))
        assert 0 < table["clearance"].min() <= table["clearance"].max() <= 2.0
    readme = (released / "README.md").read_text()
    assert re.search(r"\| feeler\.csv \| Contact of the feeler.*contact \[-\], clearance \[m\]", readme)


def test_status_is_up_to_date_without_the_file_and_names_it_if_it_is_not_loaded_or_has_changed(
    released, tmp_path, symolo
):
    ended = symolo("status", released)
    assert "runs: 1 of 1 released and up to date" in ended.out
    assert "sensor feeler: made with feeler.py, SHA-256 " in ended.out
    assert "not loaded; only --sensor-file feeler.py simulates its runs again" in ended.out
    for text, expected in (
        (TOY, "a file with the same content is loaded"),
        (TOY + "# changed\n", "feeler.py has changed since"),
    ):
        path = written(tmp_path, text)
        try:
            assert expected in symolo("--sensor-file", path, "status", released).out
        finally:
            SENSORS.unload(path)


def test_a_repair_that_must_simulate_names_the_file_and_needs_the_same_content(released, copy_of, tmp_path, symolo):
    copy = copy_of(released)
    table = copy / "CW/test_1/side/feeler.csv"
    content = table.read_bytes()
    table.unlink()
    ended = symolo("repair", copy)
    assert (ended.code, "sensor feeler: its file feeler.py (" in ended.out) == (4, True)
    path = written(tmp_path, TOY + "# changed\n")
    try:
        assert "the file has changed since the data were made" in symolo("--sensor-file", path, "repair", copy).out
        written(tmp_path)
        assert symolo("--sensor-file", path, "repair", copy).code == 0
    finally:
        SENSORS.unload(path)
    assert table.read_bytes() == content


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda text: text.replace("contact", "kontact"), "line 1: column kontact is not known"),
        (lambda text: re.sub(r"\n50.000,\d,", "\n50.000,nan,", text), "line 3: column contact: got 'nan', allowed:"),
        (lambda text: re.sub(r"\n50.000,\d,", "\n50.000,0.5,", text), "line 3: column contact: 0.5 is not a whole"),
        (lambda text: text.replace("\n50.000,", "\n51.000,"), "column t is not one sample every 50 ms from 0 to"),
        (lambda text: text[: text.rindex("\n", 0, -1) + 1], "column t is not one sample every 50 ms from 0 to"),
        (lambda text: text[:-1], "does not end with a line end: the file is cut off"),
    ],
)
def test_verify_finds_it_whole_and_a_damaged_table_at_fault(released, copy_of, sign, symolo, damage, message):
    assert symolo("verify", released).code == 0
    copy = copy_of(released)
    table = copy / "CW/test_1/side/feeler.csv"
    table.write_text(damage(table.read_text()))
    assert symolo("verify", copy).code == 4
    sign(copy)  # so that only the content can be at fault
    ended = symolo("verify", copy)
    assert ended.code == 4
    assert f"CW/test_1/side/feeler.csv: {message}" in ended.out + ended.err


def test_verify_finds_metadata_and_specification_that_disagree(released, copy_of, sign, symolo):
    copy = copy_of(released)
    path = copy / "metadata.json"
    metadata = json.loads(path.read_text())
    del metadata["sensors"]
    path.write_text(json.dumps(metadata))
    sign(copy)
    ended = symolo("verify", copy)
    assert ended.code == 4
    assert "CW/test_1/side/spec.json: robot.sensors are not those of metadata.json, none" in ended.out + ended.err
    metadata["sensors"] = {"feeler": {"kind": "feeler", "meaning": MEANING}}
    del metadata["columns"]["side/feeler.csv"]
    path.write_text(json.dumps(metadata))
    with pytest.raises(InputError, match=r"side/feeler\.csv has not the columns of a sensor"):
        library.load(copy)


def test_the_reader_gives_its_table_with_units_where_its_class_is_unknown(released):
    assert "feeler" not in [sensor.name for sensor in SENSORS.classes()]
    data = library.load(released)
    for run in (data["CW/test_1"], library.load(released / "CW/test_1").runs[0]):
        assert run.side_names == ("wheels", "tof", "camera", "feeler")
        table = run.side("feeler")
        assert table.attrs["units"] == {"t": "ms", "contact": "-", "clearance": "m"}
        assert [str(kind) for kind in table.dtypes] == ["float64", "int64", "float64"]
        pd.testing.assert_frame_equal(table, pd.read_csv(run.folder / "side/feeler.csv"))
        sensor = run.sensors["feeler"]
        assert (sensor.kind, sensor.settings.period_s, sensor.X_RS[0, 3]) == ("feeler", 0.05, 0.08)
        assert sensor.settings.model_extra["travel_m"] == run.spec.drawn[TRAVEL]
        pd.testing.assert_frame_equal(sensor.samples, table)
        np.testing.assert_array_equal(sensor.values("clearance"), table["clearance"])
        np.testing.assert_array_equal(sensor.delivered(run.t_s), np.arange(len(run)))
        samples = f"kind 'feeler', {len(run)} samples of t [ms], contact [-], clearance [m]"
        assert repr(sensor) == f"RunSensor('feeler', {samples})"
        assert repr(run) == f"Run(folder={run.folder!r}, name='CW/test_1')"
    assert repr(data) == f"Dataset({str(released)!r}, 1 run)"
    with pytest.raises(InputError, match="did you mean feeler"):
        data["CW/test_1"].side("feelor")


def test_every_export_of_tables_and_of_ros_holds_it(released, tmp_path, symolo):
    formats = "parquet,huggingface,mcap,ros1"
    assert symolo("export", released, "--format", formats, "--out", tmp_path / "out").code == 0
    run = library.load(released)["CW/test_1"]
    expected = run.side("feeler")
    parquet = pd.read_parquet(tmp_path / "out/parquet/feeler.parquet")
    own = parquet[parquet["run"] == run.name].drop(columns="run").reset_index(drop=True)
    pd.testing.assert_frame_equal(own, expected, check_dtype=False)
    samples = pd.read_parquet(next((tmp_path / "out/huggingface/feeler").iterdir()))
    np.testing.assert_array_equal(samples[samples["run"] == run.name]["clearance"], expected["clearance"])
    assert "- config_name: feeler" in (tmp_path / "out/huggingface/README.md").read_text()
    bag = tmp_path / "out/mcap/CW/test_1.mcap"
    with bag.open("rb") as stream:
        decoded = make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages(["/sensors/feeler"])
        messages = [message for _schema, _channel, _record, message in decoded]
    np.testing.assert_array_equal([message.data for message in messages], expected[["contact", "clearance"]])
    assert messages[0].layout.dim[0].label == "contact [-], clearance [m]"
    assert b"/sensors/feeler" in (tmp_path / "out/ros1/CW/test_1.bag").read_bytes()


def test_the_report_shows_columns_limits_and_a_plot(released, tmp_path, symolo):
    page = tmp_path / "report.html"
    assert symolo("report", released, "--out", page).code == 0
    text = page.read_text()
    tables = [run.side("feeler") for run in library.load(released)]
    low, high = (f"{limit(limit(t['clearance']) for t in tables):.3f}" for limit in (min, max))
    cells = f"clearance</td>\\s*<td>m</td>\\s*<td>{low}</td>\\s*<td>{high}</td>\\s*<td>distance straight ahead"
    assert re.search(cells, text)
    assert 'alt="feeler against time in ' in text


def test_a_run_is_simulated_again_where_the_file_changed_and_workers_load_the_same_file(toy, tmp_path):
    spec, without = drawn(f"{TRAVEL}=0.02"), drawn()
    SENSORS.load(written(tmp_path, TOY + "# changed\n"))
    changed = drawn(f"{TRAVEL}=0.02")
    (change,) = changes(spec, changed, simulation=True)
    assert re.fullmatch(r"robot\.sensor_files\.0\.sha256 [0-9a-f]{12} -> [0-9a-f]{12}", change)
    assert simulation_key(spec) != simulation_key(changed)
    assert simulation_key(without) == simulation_key(drawn())
    SENSORS.load(written(tmp_path))
    assert environment()["SYMOLO_SENSOR_FILES"] == str(tmp_path / "feeler.py")
    assert toy.name in SENSORS.by_name()


def test_a_specification_whose_sensor_is_not_loaded_is_read_but_not_simulated(tmp_path):
    path = written(tmp_path)
    SENSORS.load(path)
    spec = drawn(f"{TRAVEL}=0.02")
    SENSORS.unload(path)
    read = type(spec).model_validate_json(spec.model_dump_json())
    assert read.model_dump_json() == spec.model_dump_json()
    with pytest.raises(InputError, match=r"sensor feeler: its file feeler\.py \(.*not loaded, .*--sensor-file feeler"):
        build_sensors(read.robot, Arena.from_config(read.arena), 1000, lambda _: np.random.default_rng(0))


@pytest.mark.parametrize("result", ["np.zeros(3)", "np.array([0.0, np.nan])", "0.0"])
def test_a_reading_that_is_not_a_finite_number_for_each_column_is_refused(tmp_path, result):
    path = written(tmp_path, re.sub(r"return np.array.*", f"return {result}", TOY))
    SENSORS.load(path)
    try:
        line = 1 + path.read_text().splitlines().index("    def sample(self, world):")
        message = (
            rf"^CW/test_1: {path}:{line}: sensor feeler: the reading at 0\.000 s: got .*, allowed: a finite number for"
            " each column: contact, clearance"
        )
        with pytest.raises(InputError, match=message):
            simulate(drawn(f"{TRAVEL}=0.02"))
    finally:
        SENSORS.unload(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("class Feeler", "class Tof"), "sensor tof: the name is taken"),
        (("class Feeler", "class Imu"), "sensor imu: the name is taken"),
        (("class Feeler", "class Board"), "sensor board: the name is taken by another file"),
        (("columns = (", "kolumns = ("), "sensor feeler: columns missing.*write, for example"),
        (('"contact"', '"t"'), "sensor feeler: columns: got 't', allowed: letters"),
        (('"contact"', '"clearance"'), "sensor feeler: columns: got 'clearance', allowed: .*each name once"),
        (("def sample", "def sampled"), "sensor feeler: sample missing.*define sample"),
        (("(Sensor)", "(object)"), "got 'none', allowed: one class that derives from Sensor"),
        (
            ('"clearance", "m", 3', '"clearance", 3, "m"'),
            r"feeler\.py:29: .* unit of column clearance is 3, but must be",
        ),
        (("def sample(self", "def sample(self:"), r"feeler\.py:32: sensor file: SyntaxError"),
    ],
)
def test_a_file_that_is_not_complete_is_refused_with_its_place_and_a_cure(tmp_path, change, message):
    before = SENSORS.classes()
    with pytest.raises(InputError, match=message):
        SENSORS.load(written(tmp_path, TOY.replace(*change)))
    assert SENSORS.classes() == before


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("self.settings.height_m", "self.settings.hight_m"), r"35: sensor file: in sample: AttributeError: .*hight_m"),
        # A mistake of the file may show only in the code of the project that it calls.
        (("origin[None]", "None"), r"36: sensor file: in sample: TypeError: "),
    ],
)
def test_an_error_in_its_code_is_one_line_with_its_place_and_no_bug_of_the_project(tmp_path, change, message):
    path = written(tmp_path, TOY.replace(*change))
    SENSORS.load(path)
    try:
        spec = drawn(f"{TRAVEL}=0.02", "stop.time_limit_s=0.1").model_dump_json()
        unit = SimulateUnit(name="CW/test_1", folder=tmp_path / "run", spec=spec, key="0")
        ended = do(unit, lambda *_: None)
    finally:
        SENSORS.unload(path)
    assert (ended.error, len(ended.text.splitlines())) == ("input", 1)
    assert re.match(rf"{path}:{message}", ended.text)


def test_an_error_in_its_code_in_the_process_of_the_command_is_one_line_too(tmp_path, symolo):
    faults = "        def faults(self):\n            return self.rate_hz\n\n    columns = ("
    path = written(tmp_path, TOY.replace("    columns = (", faults))
    try:
        ended = symolo("--sensor-file", path, "plan", "smoke", "--set", f"{TRAVEL}=0.02")
    finally:
        SENSORS.unload(path)
    assert (ended.code, len(ended.err.splitlines())) == (2, 1)
    assert re.search(r"feeler\.py:\d+: sensor file: in faults: AttributeError: .*rate_hz", ended.err)
