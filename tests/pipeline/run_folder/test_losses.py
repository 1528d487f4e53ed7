"""No command takes files away from a finished release of something else unless the user says so."""

import contextlib
import json
import shutil

import pytest

from physics.control.registry import CONTROLLERS
from pipeline.run_folder.workspace import Workspace
from tests.release_fixtures import ONE_ROUTE

LISTS = ("manifest-sha256.txt", "tagmanifest-sha256.txt")
SIGNATURE = "tagmanifest-sha256.txt.minisig"
BRIGHT = "--set=look.sun.elevation_deg=70"


def state_of(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*")}


@pytest.fixture
def out(dataset, copy_of):
    return copy_of(dataset, stages=True)


@pytest.fixture
def signed(out):
    (out / SIGNATURE).write_text("untrusted comment: of a test\n")
    return out


@pytest.mark.parametrize("command", [["release"], ["assemble"], ["hil", "--simulated"], ["release", "--dry-run"]])
def test_a_finished_release_of_another_scenario_is_not_replaced(signed, symolo, tiny, command):
    before = state_of(signed)
    ended = symolo(*command, "smoke", "--out", signed, *tiny, "--set=name=other")
    assert ended.code == 2
    message = ended.err.splitlines()[-1]
    assert "contains the finished dataset smoke, and not other" in message
    assert "2 runs (CCW/test_1, CW/test_1), 12 images and the signature would be lost" in message
    assert message.endswith("name another folder with --out, or give --replace")
    assert state_of(signed) == before


def test_without_stages_it_is_protected_too(dataset, copy_of, symolo, tiny):
    out = copy_of(dataset)
    ended = symolo("release", "smoke", "--out", out, *tiny, "--set=name=other")
    assert (ended.code, "12 images" in ended.err) == (2, True)
    assert not (out / ".stages").exists()


@pytest.mark.usefixtures("hands")
def test_with_replace_it_is_replaced_and_the_lines_name_what_went(signed, symolo, tiny):
    ended = symolo("release", "smoke", "--out", signed, *tiny, "--set=name=other", f"--set={ONE_ROUTE}", "--replace")
    assert ended.code == 0
    lines = ended.err.splitlines()
    lost = "2 runs (CCW/test_1, CW/test_1), 12 images and the signature"
    assert f"--replace: the finished dataset smoke loses {lost}" in lines
    assert "removed: CCW/test_1, which does not belong to the scenario" in lines
    assert "removed: the signature, because the signed files have changed" in lines
    assert not (signed / SIGNATURE).exists()
    assert not (signed / "CCW").exists()
    assert symolo("verify", signed).code == 0


def test_runs_that_the_scenario_no_longer_has_are_not_removed_unasked(out, symolo, tiny):
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, f"--set={ONE_ROUTE}")
    assert ended.code == 2
    assert "contains the finished dataset smoke: 1 run (CCW/test_1) and 6 images would be lost" in ended.err
    assert state_of(out) == before


def test_a_sensor_of_a_file_that_is_not_named_is_not_removed_unasked(out, symolo, tiny):
    metadata = json.loads((out / "metadata.json").read_text())
    metadata["sensors"] = {
        "beam": {"kind": "beam", "meaning": "One beam."},
        "sonar": {"kind": "imu", "meaning": "Known."},
    }
    column = {"unit": "m", "meaning": "a number", "decimals": 3}
    for name in metadata["sensors"]:
        metadata["columns"][f"side/{name}.csv"] = [{**column, "name": "t"}, {**column, "name": "range"}]
    (out / "metadata.json").write_text(json.dumps(metadata))
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert ended.code == 2
    lost = "the readings of beam (neither sensor_files nor --sensor-file names its file) would be lost"
    assert f"contains the finished dataset smoke: {lost}; name another" in ended.err
    assert state_of(out) == before


def test_a_sensor_of_a_file_is_not_replaced_unasked_by_one_of_its_name_and_another_kind(out, symolo, tiny):
    metadata = json.loads((out / "metadata.json").read_text())
    metadata["sensors"] = {"imu": {"kind": "beam", "meaning": "One beam."}}
    column = {"unit": "m", "meaning": "a number", "decimals": 3}
    metadata["columns"]["side/imu.csv"] = [{**column, "name": "t"}, {**column, "name": "range"}]
    (out / "metadata.json").write_text(json.dumps(metadata))
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, "--set=robot.sensors.imu={}")
    assert (ended.code, "the readings of imu (neither sensor_files" in ended.err) == (2, True)
    assert state_of(out) == before


def test_a_dry_run_says_what_a_release_would_take_away_do_and_keep_and_writes_nothing(out, symolo, tiny):
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, f"--set={ONE_ROUTE}", "--dry-run", "--replace")
    assert "--replace: the finished dataset smoke would lose 1 run (CCW/test_1) and 6 images" in ended.err.splitlines()
    lines = ["would be lost by the next release: 1 run (CCW/test_1) and 6 images"]
    assert (ended.code, ended.out.splitlines()) == (
        0,
        [*lines, "would be kept, as far as their settings show, 1 run (CW/test_1)"],
    )
    assert lines[0] in symolo("status", out, "smoke", *tiny, f"--set={ONE_ROUTE}").out
    ended = symolo("release", "smoke", "--out", out, *tiny, BRIGHT, "--dry-run")
    assert ended.code == 0
    for text in (
        "1 run (CW/test_1): render: look.sun.elevation_deg ",
        "1 run (CCW/test_1): render: look.sun.elevation_deg ",
        "2 runs (CW/test_1, CCW/test_1): release: it is assembled again after its other stages\n",
    ):
        assert f"would be done by the next release, {text}" in ended.out
    assert "kept" not in ended.out
    assert state_of(out) == before


def test_a_dry_run_into_a_new_folder_makes_no_folder(tmp_path, symolo, tiny):
    ended = symolo("release", "smoke", "--out", tmp_path / "new", *tiny, "--dry-run")
    assert ended.code == 0
    assert "2 runs (CW/test_1, CCW/test_1): simulate: it was never begun" in ended.out
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("command", ["verify", "repair"])
def test_a_release_that_was_interrupted_is_named_so(out, symolo, command):
    for name in LISTS:
        (out / name).unlink()
    ended = symolo(command, out)
    assert (ended.code, ended.out) == (2, "")
    (line,) = ended.err.splitlines()
    assert line.endswith(
        f"{out}: the release is not finished; repeat the command that makes it, such as `symolo release`, with the "
        f"same options; `symolo status {out}` shows what is missing, and why a run failed"
    )


def test_an_interrupted_rerender_names_its_own_command(out, symolo):
    for name in LISTS:
        (out / name).unlink()
    (out / ".stages/kind").write_text("rerendered\n")
    (out / ".stages/render/CW/test_1/done.json").unlink()
    assert "; repeat `symolo rerender` with the same options; " in symolo("verify", out).err
    assert "would be done by the next rerender, 1 run (CW/test_1): render: " in symolo("status", out).out


@pytest.mark.parametrize("name", LISTS)
def test_a_finished_release_that_has_lost_a_list_is_protected_too(out, symolo, tiny, name):
    (out / name).unlink()
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, f"--set={ONE_ROUTE}")
    assert (ended.code, "1 run (CCW/test_1) and 6 images would be lost" in ended.err) == (2, True)
    assert state_of(out) == before


def test_an_unfinished_release_needs_no_flag(out, symolo, tiny):
    for name in LISTS:
        (out / name).unlink()
    assert symolo("release", "smoke", "--out", out, *tiny, f"--set={ONE_ROUTE}", "--workers=1").code == 0
    assert not (out / "CCW").exists()


def test_images_and_annotations_of_kept_runs_are_not_removed_unasked(out, symolo, tiny):
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny, "--set=rates.camera_hz=0")
    assert ended.code == 2
    assert "contains the finished dataset smoke: 12 images would be lost" in ended.err
    assert state_of(out) == before
    metadata = json.loads((out / "metadata.json").read_text())
    rear = {"period_s": 0.2, "images": 5, "image_width_px": 32, "image_height_px": 24}
    metadata["runs"][0] |= {"annotations": ["depth"], "cameras": {"rear": rear}}
    (out / "metadata.json").write_text(json.dumps(metadata))
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert (ended.code, "5 images and annotations (depth) would be lost" in ended.err) == (2, True)


def test_a_dataset_of_unknown_name_counts_as_another_one(out, symolo, tiny):
    for place in (out, out / ".stages/assemble"):
        (place / "metadata.json").write_text("damaged")
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert ended.code == 2
    assert "contains a finished dataset: 2 runs (CCW/test_1, CW/test_1) would be lost" in ended.err
    assert state_of(out) == before


@pytest.fixture
def finished_meanwhile(monkeypatch):
    """Takes the lists of a dataset away until a command has the lock, as if another one finished in between."""

    def prepare(out):
        lists = {out / name: (out / name).read_bytes() for name in LISTS}
        for path in lists:
            path.unlink()
        locked = Workspace.locked

        @contextlib.contextmanager
        def after_another(workspace, **options):
            with locked(workspace, **options):
                for path, data in lists.items():
                    path.write_bytes(data)
                yield

        monkeypatch.setattr(Workspace, "locked", after_another)

    return prepare


@pytest.mark.parametrize("command", [["release"], ["hil", "--simulated"]])
def test_what_another_command_finishes_before_the_lock_is_protected_too(
    out, symolo, tiny, release_of, finished_meanwhile, command
):
    before = release_of(out)
    finished_meanwhile(out)
    ended = symolo(*command, "smoke", "--out", out, *tiny, "--set=name=other")
    assert (ended.code, "contains the finished dataset smoke, and not other" in ended.err) == (2, True)
    assert release_of(out) == before


def test_an_import_protects_it_too(tmp_path, symolo, release_of, finished_meanwhile):
    log, out = tmp_path / "log.csv", tmp_path / "out"
    log.write_text("t_s,x_m,y_m,theta_rad\n" + "".join(f"{0.05 * i:.2f},{0.01 * i:.2f},0,0\n" for i in range(20)))
    assert symolo("import", log, "--out", out, "--yes").code == 0
    before = release_of(out)
    finished_meanwhile(out)
    ended = symolo("import", log, "--out", out, "--yes", "--name", "other")
    assert (ended.code, "and not other" in ended.err) == (2, True)
    assert release_of(out) == before


def test_an_import_of_another_log_of_the_same_name_needs_the_flag(tmp_path, symolo, release_of):
    """An imported dataset is named after its file, and its run is the same in all of them."""
    log, out = tmp_path / "log.csv", tmp_path / "out"
    arguments = ["import", log, "--out", out, "--yes"]
    rows = [f"{0.05 * i:.2f},{0.01 * i:.2f},0,0\n" for i in range(20)]
    log.write_text("t_s,x_m,y_m,theta_rad\n" + "".join(rows))
    assert symolo(*arguments).code == 0
    assert symolo(*arguments, "--licence", "MIT").code == 0
    log.write_text("t_s,x_m,y_m,theta_rad\n" + "".join(rows[:15]))
    before = release_of(out)
    ended = symolo(*arguments)
    assert (ended.code, "the finished dataset log: 1 run (imported/test_1) would be lost" in ended.err) == (2, True)
    assert release_of(out) == before
    assert symolo(*arguments, "--replace").code == 0


@pytest.mark.parametrize("seal", [SIGNATURE, "provenance.intoto.json"])
def test_a_seal_is_not_removed_where_a_file_of_the_user_has_changed(out, symolo, tiny, seal):
    """The key of a simulation contains the content of the controller's file, which spec.json does not."""
    (out / seal).write_text("{}")
    done = json.loads((out / ".stages/simulate/CW/test_1/done.json").read_text())
    (out / ".stages/simulate/CW/test_1/done.json").write_text(json.dumps(done | {"key": "0" * len(done["key"])}))
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert (ended.code, "smoke: the signature would be lost" in ended.err) == (2, True)
    assert state_of(out) == before


CONTROLLER = """
from physics.control.base import RobotController, State, Twist


class Toy(RobotController):
    def step(self, seen):
        return Twist(0.1, 0.0, State.LINE)
"""


@pytest.fixture
def with_controller(tmp_path, symolo):
    """Does a command with a controller of the user, whose file has a text of its own in each command."""
    path = tmp_path / "toy.py"
    settings = ["controller.toy={}", "stop.lap=false", "stop.time_limit_s=0.3", "rates.camera_hz=0"]

    def do(command, text):
        path.write_text(CONTROLLER + text)
        options = ["--out", tmp_path / "out", f"--set={ONE_ROUTE}", *(f"--set={setting}" for setting in settings)]
        try:
            return symolo("--controller-file", path, command, "smoke", *options)
        finally:
            CONTROLLERS.unload(path)

    return do


@pytest.mark.usefixtures("hands")
def test_a_signature_is_not_removed_where_a_controller_has_changed_since(with_controller, tmp_path, release_of):
    """In the folder of its simulation, the changed controller has become the known one."""
    out = tmp_path / "out"
    assert with_controller("release", "").code == 0
    (out / SIGNATURE).write_text("untrusted comment: of a test\n")
    before = release_of(out)
    assert with_controller("simulate", "# changed").code == 0
    for command in ("assemble", "release"):
        ended = with_controller(command, "# changed")
        assert (ended.code, "smoke: the signature would be lost" in ended.err) == (2, True)
        assert release_of(out) == before
    shutil.rmtree(out / ".stages")
    ended = with_controller("release", "# changed")
    assert (ended.code, "the signature would be lost" in ended.err) == (2, True)
    assert release_of(out) == before
    shutil.rmtree(out / ".stages")
    assert with_controller("release", "").code == 0
    assert release_of(out) == before


def test_a_drive_of_a_real_board_is_not_replaced_unasked(out, symolo, tiny):
    """No board drives the same way twice."""
    metadata = json.loads((out / "metadata.json").read_text())
    line = {"kind": "serial", "framing": "framed", "bits_per_s": 115_200, "actuation_delay_ticks": 1}
    metadata["runs"][0]["board"] = {**line, "firmware_id": "", "rows_unanswered": 0, "events": {}}
    (out / "metadata.json").write_text(json.dumps(metadata))
    assert symolo("release", "smoke", "--out", out, *tiny, BRIGHT, "--dry-run").code == 0
    done = json.loads((out / ".stages/simulate/CW/test_1/done.json").read_text())
    (out / ".stages/simulate/CW/test_1/done.json").write_text(json.dumps(done | {"key": "0" * len(done["key"])}))
    before = state_of(out)
    ended = symolo("release", "smoke", "--out", out, *tiny)
    assert (ended.code, "smoke: 1 run (CW/test_1) and 6 images would be lost" in ended.err) == (2, True)
    assert state_of(out) == before


@pytest.mark.parametrize("change", [BRIGHT, "--set=description=of something else"])
def test_a_signature_is_not_removed_unasked(signed, symolo, tiny, change):
    before = state_of(signed)
    ended = symolo("release", "smoke", "--out", signed, *tiny, change)
    assert ended.code == 2
    assert "contains the finished dataset smoke: the signature would be lost" in ended.err
    assert state_of(signed) == before


def test_a_signed_release_is_repaired_by_the_same_scenario_and_stays_signed(signed, symolo, tiny):
    (signed / "CW/test_1/data.csv").write_text("damaged")
    ended = symolo("release", "smoke", "--out", signed, *tiny)
    assert (ended.code, "removed" in ended.err) == (0, False)
    assert (signed / SIGNATURE).exists()


@pytest.mark.usefixtures("hands")
def test_a_rerendering_of_another_look_replaces_nothing_unasked(dataset, tmp_path, symolo, finished_meanwhile):
    arguments = ["rerender", dataset / "CW/test_1", "--out", tmp_path / "out", "--set=render.annotations=[]"]
    size = ["--set=render.width_px=32", "--set=render.height_px=24"]
    assert symolo(*arguments, *size, "--look", "lab").code == 0
    before = state_of(tmp_path / "out")
    ended = symolo(*arguments, *size, "--look", "night")
    assert ended.code == 2
    assert "contains the finished dataset smoke-lab, and not smoke-night: 1 run (CW/test_1) and 6 images" in ended.err
    assert state_of(tmp_path / "out") == before
    assert symolo(*arguments, *size, "--look", "night", "--replace").code == 0
    before = [path.read_bytes() for path in sorted((tmp_path / "out/CW").rglob("*.*"))]
    finished_meanwhile(tmp_path / "out")
    ended = symolo(*arguments, *size, "--look", "lab")
    assert (ended.code, "contains the finished dataset smoke-night, and not smoke-lab" in ended.err) == (2, True)
    assert [path.read_bytes() for path in sorted((tmp_path / "out/CW").rglob("*.*"))] == before
