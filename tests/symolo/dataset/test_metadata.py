"""What metadata.json says of a run: limits as in the table, values in their own types, nothing of this machine."""

import hashlib
import json
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from pydantic import ValidationError

from configs.draw import draw_all, draw_run
from configs.loader import load_scenario
from pipeline.assembly.description import markdown
from pipeline.stages import simulate_runs
from pipeline.work.supervisor import UnitFailure
from pipeline.work.units import SimulateUnit
from symolo.core.progress import LineReport
from symolo.dataset.documents.metadata import FailedRun, Metadata, RunRecord, describe, made_with
from symolo.dataset.documents.rendering_record import ImageErrorRecord, LightPathsRecord, RenderingRecord
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.tables.rows import Rows
from symolo.verification.run_checks import check_run

CODE = {"name": "a", "file": "a.py", "sha256": hashlib.sha256(b"").hexdigest(), "text": ""}


@dataclass(frozen=True)
class Recorded:
    """What the rows take from a recording."""

    trajectory: SimpleNamespace
    values: dict

    def __getitem__(self, name):
        return SimpleNamespace(values=self.values[name])


def standing_rows(spec, tof_m, image=(1, 0)):
    trajectory = SimpleNamespace(
        t_s=np.array([0.0, 0.05]),
        pose=np.tile([spec.start.x_m, spec.start.y_m, 0.0], (2, 1)),
        state=np.zeros(2, dtype=np.int64),
        twist=np.zeros((2, 2)),
    )
    values = {"tof_m": np.array(tof_m), "line": np.ones((2, 8)), "image": np.array(image)}
    return Rows.from_recording(Recorded(trajectory, values))


def test_limits_with_more_digits_than_the_table_do_not_make_its_readings_faults(tmp_path):
    limits = ["min_range_m=0.04567891", "max_range_m=1.23456789", "no_target_m=2.345678"]
    spec = draw_run(load_scenario("smoke", [f"robot.tof.{limit}" for limit in limits]), "CW", 1)
    tof = spec.robot.tof
    rows = standing_rows(spec, [[tof.no_target_m, tof.min_range_m, tof.max_range_m], [1, 1, 1]])
    record = RunRecord.from_specification(spec, rows, None)
    (tmp_path / spec.key).mkdir(parents=True)
    (tmp_path / spec.key / "data.csv").write_bytes(rows.to_csv())
    found = [
        finding.what for finding in check_run(tmp_path, record, lambda _text: "") if finding.file.endswith("data.csv")
    ]
    assert found == []


def described(scenario, *settings, image=(1, 0)):
    loaded = load_scenario(scenario, settings)
    specs = draw_all(loaded)
    records = [RunRecord.from_specification(spec, standing_rows(spec, np.ones((2, 3)), image), None) for spec in specs]
    return markdown(describe(loaded.tree, specs, records, []), specs[0]).decode()


def test_a_description_says_whose_arena_it_shows():
    drawn, written = described("random_arenas"), described("smoke")
    assert "Each run has an arena of its own, in its side/spec.json; this one is of Lap/test_1." in drawn
    assert "arena of its own" not in written
    assert "pieces (metadata.json)" not in drawn
    assert "pieces (metadata.json)" in written


def test_a_description_has_the_look_the_camera_and_the_exposure_of_the_images():
    exposure = ("look.camera.exposure_time_s=0.01", "look.camera.manual_exposure.iso=200")
    text = described("smoke", "look.camera=machine_vision", *exposure, "robot.camera.read_out_s=0.02")
    images = text[text.index("## Images") : text.index("## Arena")]
    assert "classroom: " in images
    assert "machine_vision: " in images
    assert "| exposure | the same in all images of a run: 10 ms, ISO 200, f/2.8 |" in images
    assert "| colours | none: the sensor measures all colours together |" in images
    assert "| shutter | rolling: 20 ms from the top row to the bottom row |" in images
    automatic = described("smoke")
    assert "| field of view | 70.4 deg across, without distortion |" in automatic
    assert "| exposure | automatic; an instant, without motion blur |" in automatic
    assert "| shutter | global |" in automatic
    assert "## Images" not in described("smoke", image=(0, 0))


def test_a_description_of_several_looks_names_all_and_says_whose_values_it_shows():
    loaded = load_scenario("smoke", ("look=night",))
    specs = draw_all(loaded)
    tree = {key: value for key, value in loaded.tree.items() if key != "look"}
    looks = {name: load_scenario("smoke", (f"look={name}",)).tree["look"] for name in ("night", "lab")}
    records = [RunRecord.from_specification(spec, standing_rows(spec, np.ones((2, 3))), None) for spec in specs]
    text = markdown(describe({**tree, "looks": looks}, specs, records, []), specs[0]).decode()
    images = text[text.index("## Images") : text.index("## Arena")]
    assert "Each run has one of the looks lab, night, which its side/spec.json describes;" in images
    assert f"the values here are those of the camera of data.csv in {specs[0].key}." in images
    assert "| look | night: " in images
    assert "one of the looks" not in described("smoke")


def test_the_same_description_follows_from_the_file():
    """Whose keys are sorted, so that a lost README.md can be written again."""
    loaded = load_scenario("smoke")
    specs = draw_all(loaded)
    records = [RunRecord.from_specification(spec, standing_rows(spec, np.ones((2, 3))), None) for spec in specs]
    metadata = describe(loaded.tree, specs, records, [])
    assert markdown(Metadata.model_validate_json(metadata.to_json()), specs[0]) == markdown(metadata, specs[0])


def test_a_drawn_truth_stays_one():
    spec = draw_run(load_scenario("smoke", ["render.denoise={choice: [true]}"]), "CW", 1)
    record = RunRecord.from_specification(spec, standing_rows(spec, np.ones((2, 3))), None)
    assert record.drawn["render.denoise"] is True
    assert RunRecord.model_validate_json(record.model_dump_json()).drawn["render.denoise"] is True


def test_scipy_is_among_the_versions_and_another_one_simulates_again(monkeypatch):
    assert made_with()["scipy"][0].isdigit()
    spec = draw_run(load_scenario("smoke", []), "CW", 1)
    before = simulate_runs.simulation_key(spec)
    real = simulate_runs.versions
    monkeypatch.setattr(
        simulate_runs, "versions", lambda *names: {**real(*names), **dict.fromkeys({"scipy"} & {*names}, "0")}
    )
    assert simulate_runs.simulation_key(spec) != before


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("collision with wall A1 at 1.25 s", "collision with wall A1 at 1.25 s"),
        ("faster than 3 m/s and/or 30 rad/s", "faster than 3 m/s and/or 30 rad/s"),
        (
            "cannot open '/data/me/a b/x.exr'; the last lines of its log:\n  /usr/lib/x\n  Traceback",
            "cannot open 'x.exr'",
        ),
        ("[Errno 13] denied: /srv/data/job.json, twice\nTraceback", "[Errno 13] denied: job.json, twice"),
        (
            'ended by exit code 1; its last line: File "/srv/x y/z.py", line 3',
            'ended by exit code 1; its last line: File "z.py", line 3',
        ),
    ],
)
def test_a_problem_is_one_line_without_this_machines_folders(text, problem):
    assert FailedRun.from_error("CW/test_1", "render", text).problem == problem


def test_the_log_of_a_failed_run_goes_to_the_error_output_alone(capsys, tmp_path):
    unit = SimulateUnit(name="CW/test_1", spec="", folder=tmp_path, key="")
    text = f"cannot open {tmp_path}/x.urdf; the last lines of its log:\n  a traceback"
    (failed,) = simulate_runs.failed_runs("simulate", [UnitFailure(unit, text)], LineReport())
    assert failed.problem == "cannot open x.urdf"
    assert text in capsys.readouterr().err


def test_a_rendering_states_whether_its_error_was_measured():
    paths = LightPathsRecord(
        diffuse_bounces=32, glossy_bounces=32, transmission_bounces=32, caustics=False, clamp=256.0
    )
    rendering = RenderingRecord(method="full", samples=8, light_paths=paths)
    assert rendering.text.endswith("; error not measured")
    error = ImageErrorRecord(views=4, psnr_db=42.9, jpeg_psnr_db=39.6)
    assert rendering.model_copy(update={"error": error}).text.endswith("; estimated PSNR 42.9 dB (JPEG: 39.6 dB)")


@pytest.mark.parametrize(
    ("caustics", "clamp", "text"),
    [
        (False, 256.0, "without caustics, reflected light of one path limited to 256 times a white pixel"),
        (True, 0.0, "with caustics, reflected light not limited"),
    ],
)
def test_light_paths_are_stated_in_plain_words(caustics, clamp, text):
    paths = LightPathsRecord(
        diffuse_bounces=32, glossy_bounces=8, transmission_bounces=16, caustics=caustics, clamp=clamp
    )
    assert paths.text == f"up to 32 bounces, {text}"


@pytest.mark.parametrize("document", [Metadata, RunDocument])
def test_faults_of_a_document_share_its_content(document):
    with pytest.raises(ValidationError) as raised:
        document.model_validate_json('{"unknown": [1, 2, 3]}')
    contents = [fault["input"] for fault in raised.value.errors() if fault["type"] == "missing"]
    assert len(contents) > 3
    assert all(content is contents[0] for content in contents)


def test_of_many_faulty_runs_the_first_is_reported():
    with pytest.raises(ValidationError) as raised:
        Metadata.model_validate_json(json.dumps({"runs": 3 * [{"run": 1}], "failed_runs": 3 * [{"run": 1}]}))
    places = {fault["loc"][:2] for fault in raised.value.errors() if len(fault["loc"]) > 1}
    assert places == {("runs", 0), ("failed_runs", 0)}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seed": float("nan")}, "scenario.*not finite"),
        ({"robot": {"mass_kg": [1, {"a": float("-inf")}]}}, "scenario.*not finite"),
        ({"arena": []}, "arena is no mapping"),
        ({"arena": None}, "arena is no mapping"),
        ({"looks": 5}, "looks is no mapping"),
        ({"routes": 5}, "routes is no list of mappings"),
        ({"routes": [5]}, "routes is no list of mappings"),
        ({"robot": {"sensor_files": ["compass.py"]}}, "robot.sensor_files.0: "),
        ({"robot": {"sensor_files": 5}}, "robot.sensor_files: "),
        ({"robot": {"effect_files": [CODE | {"text": "other"}]}}, "robot.effect_files.0: .*SHA-256"),
        ({"robot": {"effect_files": [CODE | {"file": "../a.py"}]}}, "robot.effect_files.0.file: "),
        ({"robot": {"effect_files": [CODE | {"file": "a\u202e.py"}]}}, "robot.effect_files.0.file: "),
        ({"robot": {"effect_files": [CODE, CODE | {"text": 200_001 * "#"}]}}, "robot.effect_files.1.text: .*200000"),
    ],
)
def test_a_scenario_that_no_description_can_state_is_a_fault(change, message):
    loaded = load_scenario("smoke")
    specs = draw_all(loaded)
    records = [RunRecord.from_specification(spec, standing_rows(spec, np.ones((2, 3))), None) for spec in specs]
    content = json.loads(describe(loaded.tree, specs, records, []).to_json())
    content["scenario"] |= change
    with pytest.raises(ValidationError, match=f"(?s){message}"):
        Metadata.model_validate_json(json.dumps(content))
