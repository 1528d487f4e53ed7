"""Bad input and usage: exit code 2, one clear line, nothing written. And what the other exit codes take."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import INTERRUPTED_TWICE, command_line
from pipeline.planning.plan import RENDER_FRAME_S, RENDER_SAMPLE_S, RENDER_START_S, ScenarioPlan, pixel_s
from pipeline.work.supervisor import WorkerError, run_units
from pipeline.work.units import SimulateUnit

DATA_CSV = "t,x,y,theta,state,v,w,d_f,d_l,d_r,L0,L1,L2,L3,L4,L5,L6,L7,img\n" + "\n".join(
    f"{50 * i},0.55,{-0.2 - 0.01 * i},-1.57,0,0.2,0,2,2,2,1,1,1,0,0,1,1,1,{{img}}" for i in range(3)
)

LONG = "a" * 300

# Arguments, and what the line must say; OUT is a folder that is not there yet, HERE one with the files made below.
BAD = {
    "no such command": (["relase", "smoke"], "'release'"),
    "no scenario": (["release", "--out", "OUT"], "SCENARIO"),
    "no output folder": (["release", "smoke"], "--out"),
    "no such option": (["release", "smoke", "--out", "OUT", "--worker", "2"], "--workers"),
    "option of all commands after the command": (
        ["release", "smoke", "--out", "OUT", "--effect-file", "own.py"],
        "write --effect-file before the command: symolo --effect-file ... release",
    ),
    "no workers": (["release", "smoke", "--out", "OUT", "--workers", "0"], "--workers"),
    "workers in words": (["release", "smoke", "--out", "OUT", "--workers", "two"], "--workers"),
    "one argument too many": (["release", "smoke", "symolo", "--out", "OUT"], "symolo"),
    "misspelt scenario": (["release", "smok", "--out", "OUT"], "did you mean smoke"),
    "no such scenario file": (["simulate", "nowhere.yaml", "--out", "OUT"], "nowhere.yaml"),
    "scenario is a folder": (["plan", "HERE"], "HERE"),
    "scenario is no YAML": (["plan", "HERE/bad.yaml"], "bad.yaml:2"),
    "scenario with another field": (["plan", "HERE/extra.yaml"], "extra.yaml:3"),
    "the same annotation twice": (
        ["plan", "smoke", "--set", "render.annotations=[depth, flow, depth]"],
        "render.annotations: got 'depth twice', allowed: each annotation once",
    ),
    "like without a posterior": (
        ["release", "smoke", "--out", "OUT", "--like", "HERE"],
        "--like: the folder has no posterior.yaml",
    ),
    "like a file of another kind": (["plan", "smoke", "--like", "HERE/extra.yaml"], "this is no posterior.yaml"),
    "set without a value": (["release", "smoke", "--out", "OUT", "--set", "render.samples"], "--set"),
    "set of no such field": (["release", "smoke", "--out", "OUT", "--set", "render.sampels=3"], "samples"),
    "set of the wrong type": (["release", "smoke", "--out", "OUT", "--set", "render.samples=many"], "'many'"),
    "set beyond its bounds": (["release", "smoke", "--out", "OUT", "--set", "render.width_px=1"], "render.width_px"),
    "set of a bad distribution": (
        ["release", "smoke", "--out", "OUT", "--set", "render.samples={uniform: [8, 1]}"],
        "render.samples",
    ),
    "misspelt quality": (["plan", "smoke", "--set", "render.quality=standart"], "did you mean standard"),
    "misspelt device": (["plan", "smoke", "--set", "render.device=gpus"], "did you mean gpu"),
    "device that varies": (["plan", "smoke", "--set", "render.device={choice: [cpu, gpu]}"], "the whole command"),
    "device by a wrong option": (["release", "smoke", "--out", "OUT", "--device", "gpus"], "'gpu'"),
    "set of rates that do not divide": (["release", "smoke", "--out", "OUT", "--set", "rates.control_hz=7"], "7"),
    "set of a look that is not there": (["release", "smoke", "--out", "OUT", "--set", "look=palace"], "palace"),
    "output is a file": (["release", "smoke", "--out", "HERE/data.csv"], "is a file"),
    "output below a file": (["release", "smoke", "--out", "HERE/data.csv/x"], "below the file"),
    "output holds other files": (["release", "smoke", "--out", "HERE"], "did not make"),
    "output may not be written": (["release", "smoke", "--out", "/proc/symolo"], "/proc"),
    "render before simulate": (["render", "smoke", "--out", "OUT"], "symolo simulate"),
    "assemble before render": (["assemble", "smoke", "--out", "OUT"], "symolo simulate"),
    "verify what is not there": (["verify", "OUT"], "no such folder"),
    "repair what is not there": (["repair", "OUT"], "no such folder"),
    "upload what is not there": (["upload", "OUT", "file:///nowhere"], "OUT: no such folder"),
    "bag what is not there": (["bag", "OUT", "--out", "OUT/bag"], "OUT: no such folder"),
    "verify a file": (["verify", "HERE/data.csv"], "is a file, not a folder"),
    "a misspelt command of a group": (["case", "ini"], "Did you mean 'init'; see symolo case --help"),
    "robot of a file that is not there": (
        ["robot", "import", "OUT.urdf", "--out", "HERE/robot.yaml"],
        "OUT.urdf: cannot be read: No such file or directory",
    ),
    "robot of a folder": (["robot", "import", "HERE", "--out", "HERE/robot.yaml"], "HERE: is a folder, not a file"),
    "arena of a file that is not there": (
        ["arena", "import", "OUT.svg", "--out", "HERE/arena.yaml"],
        "OUT.svg: cannot be read: No such file or directory",
    ),
    "model where no folder can be made": (["model", "smoke", "--out", "/proc/symolo"], "cannot be written: /proc"),
    "compare two empty folders": (["compare", "HERE/empty", "HERE/empty"], "both folders are empty"),
    "rerender what is not there": (["rerender", "OUT", "--look", "lab", "--out", "OUT2"], "no such file or folder"),
    "rerender an empty folder": (["rerender", "HERE/empty", "--look", "lab", "--out", "OUT"], "is an empty folder"),
    "rerender without a look": (["rerender", "HERE/data.csv", "--out", "OUT"], "--look"),
    "rerender under no such look": (
        ["rerender", "HERE/data.csv", "--look", "labb", "--out", "OUT"],
        "did you mean lab",
    ),
    "rerender in no such arena": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--arena", "mars", "--out", "OUT"],
        "--arena",
    ),
    "rerender with another field": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--set", "stop.lap=true", "--out", "OUT"],
        "stop.lap",
    ),
    "rerender too wide": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--set", "render.width_px=1", "--out", "OUT"],
        "render.width_px",
    ),
    "rerender at no rate": (
        ["rerender", "HERE/no_images.csv", "--look", "lab", "--camera-hz", "0", "--out", "OUT"],
        "--camera-hz",
    ),
    "rerender a text": (["rerender", "HERE/bad.yaml", "--look", "lab", "--out", "OUT"], "bad.yaml: is not a log"),
    "rerender into its source": (["rerender", "HERE/data.csv", "--look", "lab", "--out", "HERE"], "did not make"),
    "rerender under one look and several": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--looks", "lab,classroom", "--out", "OUT"],
        "--looks",
    ),
    "rerender several draws of one look": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--draws", "3", "--out", "OUT"],
        "--draws: got 3; name the looks with --looks",
    ),
    "rerender under the same look twice": (
        ["rerender", "HERE/data.csv", "--looks", "lab,lab", "--out", "OUT"],
        "--looks: got 'lab'",
    ),
    "rerender under a look without a name": (
        ["rerender", "HERE/data.csv", "--looks", "lab,", "--out", "OUT"],
        "names separated by commas",
    ),
    "rerender under a look that --set replaces": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--set", "look=night", "--out", "OUT"],
        "--set: got 'look=night'; name it with --look",
    ),
    "rerender under looks that --set replaces": (
        ["rerender", "HERE/data.csv", "--looks", "lab", "--set", "look={extends: night}", "--out", "OUT"],
        "--set: got 'look={extends: night}'; name it with --looks",
    ),
    "rerender in an arena that --set replaces": (
        ["rerender", "HERE/data.csv", "--look", "lab", "--arena", "symolo", "--set", "arena=random", "--out", "OUT"],
        "--set: got 'arena=random'; name it with --arena",
    ),
    "rerender under looks, one misspelt": (
        ["rerender", "HERE/data.csv", "--looks", "classroom,labb", "--draws", "2", "--out", "OUT"],
        "--looks: got 'labb'",
    ),
    "preview of a misspelt scenario": (["preview", "smok", "--out", "OUT.png"], "did you mean smoke"),
    "preview under no such look": (
        ["preview", "smoke", "--look", "labb", "--out", "OUT.png"],
        "symolo: --look: got 'labb'",
    ),
    "preview under looks that --set replaces": (
        ["preview", "smoke", "--look", "lab,night", "--set", "look=classroom", "--out", "OUT.png"],
        "--set: got 'look=classroom'; name it with --look",
    ),
    "preview by no such engine": (["preview", "smoke", "--engine", "evee", "--out", "OUT.png"], "evee"),
    "preview of nothing": (["preview", "smoke", "-n", "0", "--out", "OUT.png"], "-n"),
    "preview as a text": (["preview", "smoke", "--out", "OUT.txt"], ".jpg or .png"),
    "preview in no such folder": (["preview", "smoke", "--out", "OUT/sheet.png"], ".jpg or .png"),
    "preview too wide": (
        ["preview", "smoke", "-n", "33", "--columns", "100", "--width-px", "2048", "--out", "OUT.png"],
        "too wide: got '67584 px'",
    ),
    "preview too high": (
        ["preview", "smoke", "-n", "42", "--columns", "1", "--width-px", "2048", "--out", "OUT.png"],
        "too high: got '67536 px'",
    ),
    "contact sheet of nothing": (["contact-sheet", "HERE/empty", "--out", "OUT.jpg"], "neither a release nor a run"),
    "view of nothing": (["view", "HERE/empty", "--out", "OUT.html"], "neither a release nor a run"),
    "view of a log": (["view", "HERE/bad.yaml", "--out", "OUT.html"], "neither a folder nor a data.csv"),
    "view as an image": (["view", "HERE", "--out", "OUT.png"], "--out: got"),
    "video of nothing": (["video", "HERE/empty", "--out", "OUT.mp4"], "neither a release nor a run"),
    "video as a text": (["video", "HERE", "--out", "OUT.txt"], ".mp4 or .gif or .webp"),
    "video at no speed": (["video", "HERE", "--out", "OUT.mp4", "--speed", "0"], "--speed"),
    "output in too long a name": (["simulate", "smoke", "--out", LONG], "too long"),
    "output below too long a name": (["simulate", "smoke", "--out", f"OUT/{LONG}"], "too long"),
    "output at a link to nothing": (["release", "smoke", "--out", "HERE/dangling"], "HERE/dangling is a link"),
    "output below a link to nothing": (["release", "smoke", "--out", "HERE/dangling/x"], "HERE/dangling is a link"),
    "output at a link to itself": (["release", "smoke", "--out", "HERE/loop"], "symbolic links"),
    "output below a link to itself": (["release", "smoke", "--out", "HERE/loop/x"], "symbolic links"),
    "output in no Unicode": (["release", "smoke", "--out", "\udcffq"], "UTF-8"),
    "verify too long a name": (["verify", LONG], "too long"),
    "verify a link to itself": (["verify", "HERE/loop"], "symbolic links"),
    "verify no Unicode": (["verify", "\udcffq"], "UTF-8"),
    "rerender too long a name": (["rerender", LONG, "--look", "lab", "--out", "OUT"], "too long"),
    "rerender into too long a name": (["rerender", "HERE/data.csv", "--look", "lab", "--out", LONG], "too long"),
    "contact sheet of too long a name": (["contact-sheet", LONG, "--out", "OUT.jpg"], "too long"),
    "contact sheet in too long a name": (["contact-sheet", "HERE", "--out", f"{LONG}.jpg"], "too long"),
    "contact sheet at a link to nothing": (["contact-sheet", "HERE", "--out", "HERE/dangling.jpg"], "is a link"),
    "contact sheet without image numbers": (
        ["contact-sheet", "HERE/unnumbered", "--out", "OUT.jpg"],
        "unnumbered/data.csv: img is 0",
    ),
    "contact sheet too wide": (
        ["contact-sheet", "HERE/tall", "--out", "OUT.jpg", "--per-run", "20", "--width-px", "4096"],
        "too wide: got '81920 px'",
    ),
    "contact sheet too high": (
        ["contact-sheet", "HERE/tall", "--out", "OUT.jpg", "--per-run", "1", "--width-px", "400"],
        "too high: got '80018 px'",
    ),
    "contact sheet as a text": (["contact-sheet", "HERE", "--out", "OUT.txt"], ".jpg or .png"),
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "HERE"
    (folder / "empty").mkdir(parents=True)
    (folder / "data.csv").write_text(DATA_CSV.format(img=0).replace(",0\n", ",1\n", 1) + "\n")
    (folder / "no_images.csv").write_text(DATA_CSV.format(img=0) + "\n")
    (folder / "bad.yaml").write_text("name: [\n")
    (folder / "extra.yaml").write_text("extends: smoke\nname: extra\ncolour: blue\n")
    for name in ("unnumbered", "tall"):
        (folder / name / "images").mkdir(parents=True)
    (folder / "unnumbered/data.csv").write_text(DATA_CSV.format(img=0) + "\n")
    rows = [f"{50 * i},0.55,-0.2,-1.57,0,0.2,0,2,2,2,1,1,1,0,0,1,1,1,{i + 1}" for i in range(20)]
    (folder / "tall/data.csv").write_text("\n".join([DATA_CSV.partition("\n")[0], *rows]) + "\n")
    cv2.imwrite(str(folder / "tall/images/000001.jpg"), np.zeros((3200, 16, 3), np.uint8))
    for name, target in (("dangling", "nowhere"), ("dangling.jpg", "nowhere"), ("loop", "loop")):
        (folder / name).symlink_to(target)
    return tmp_path


def files_in(folder):
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_one_line_and_nothing_written(kind, here, symolo):
    arguments, say = BAD[kind]
    before = files_in(here)
    ended = symolo(*arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err.count("\n") == 1
    assert ended.err.startswith("symolo: ")
    assert say in ended.err
    assert files_in(here) == before


def test_a_full_disk_is_noticed_before_the_work_starts(here, symolo, monkeypatch):
    usage = shutil.disk_usage(here)._replace(free=1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _path: usage)
    ended = symolo("release", "symolo", "--out", "OUT")
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "are needed and 1 kB are free" in ended.err
    assert not (here / "OUT").exists()


def test_an_import_without_room_names_sizes_below_a_megabyte_and_no_setting_of_images(here, symolo, monkeypatch):
    usage = shutil.disk_usage(here)._replace(free=2400)
    monkeypatch.setattr(shutil, "disk_usage", lambda _path: usage)
    ended = symolo("import", "HERE/data.csv", "--out", "OUT")
    assert ended.code == 5
    assert re.search(r"about \d+ kB are needed and 2 kB are free; .*, or import fewer logs$", ended.err.strip())


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (
            ("rerender", "HERE/data.csv", "--looks", "lab", "--draws", 100, "--camera-hz", 5, "--out", "OUT"),
            "--out OUT",
        ),
        (("preview", "smoke", "-n", 40, "--width-px", 32, "--out", "sheet.png"), "TMPDIR"),
    ],
)
def test_room_for_every_draw_and_picture_is_looked_for_before_the_work_starts(
    here, symolo, monkeypatch, arguments, named
):
    """A drawn scene takes some hundred kilobytes, whatever the size of its images."""
    before = files_in(here)
    usage = shutil.disk_usage(here)._replace(free=2_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _path: usage)
    ended = symolo(*arguments)
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "are needed and 2 MB are free" in ended.err
    assert named in ended.err
    assert files_in(here) == before


def test_a_bug_in_a_worker_is_reported_with_its_traceback_and_the_others_are_done(tmp_path):
    """A specification that is none gets past no check of the command line, so that it can only be a bug."""
    units = [SimulateUnit(name=f"A/test_{i}", spec="{}", folder=tmp_path / str(i), key="k") for i in (1, 2)]
    ended = []
    with pytest.raises(WorkerError) as caught:
        run_units(units, 1, lambda unit, event: ended.append((unit.name, getattr(event, "kind", ""))))
    assert ended == [("A/test_1", "failed"), ("A/test_2", "failed")]
    assert str(caught.value).count("ValidationError") == 2


@pytest.mark.usefixtures("stillborn_children")
def test_a_worker_killed_before_it_receives_its_unit_loses_no_more_than_that(tmp_path):
    units = [SimulateUnit(name=f"A/test_{i}", spec="{}", folder=tmp_path / str(i), key="k") for i in (1, 2)]
    failures = run_units(units, 1, lambda *_: None)
    assert [failure.unit.name for failure in failures] == ["A/test_1", "A/test_2"]
    assert all("ended by signal SIGKILL" in failure.text for failure in failures)


def test_an_interrupt_between_the_starts_of_the_workers_is_an_interrupt(tmp_path, monkeypatch):
    units = [SimulateUnit(name=f"A/test_{i}", spec="{}", folder=tmp_path / str(i), key="k") for i in (1, 2)]
    start = threading.Thread.start
    started = []

    def interrupted_at_the_second(thread):
        if threading.current_thread() is threading.main_thread():  # Python raises interrupts in no other one
            if started:
                raise KeyboardInterrupt
            started.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", interrupted_at_the_second)
    with pytest.raises(KeyboardInterrupt):
        run_units(units, 2, lambda *_: None)
    assert not started[0].is_alive()


@pytest.mark.parametrize("error_made", [ValueError, OSError])
def test_an_interrupt_that_a_library_makes_an_error_of_is_an_interrupt(symolo, monkeypatch, tmp_path, error_made):
    """As pydantic does with one that falls into a serializer."""

    def interrupted(*_):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1.0)
        except KeyboardInterrupt as error:
            raise error_made(error) from error

    monkeypatch.setattr("configs.loader.check_scenario", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    planned = symolo("plan", "smoke")
    simulated = symolo("simulate", "smoke", "--out", tmp_path / "out")
    signal.signal(signal.SIGINT, before)
    assert (planned.code, simulated.code) == (130, 130)
    assert planned.err == "symolo: interrupted; run the same command again, which then begins from the start\n"
    assert simulated.err == "symolo: interrupted, nothing is lost; run the same command again to continue\n"


def test_plan_of_the_full_release_counts_what_will_be_made(symolo):
    """Six runs; an image at t = 0 and then 5 a second; 40 s a lap is what the plan says it assumes."""
    ended = symolo("plan", "symolo")
    assert ended.code == 0
    lines = ended.out.splitlines()
    assert [line.split()[0] for line in lines[1:7]] == [f"{r}/test_{n}" for r in ("CW", "CCW") for n in (1, 2, 3)]
    assert lines[1].split()[1:7] == ["40.0", "801", "201", "640", "x", "480"]
    assert "images     1206" in lines
    assert "a lap of 40 s" in " ".join(lines[-3:])


def test_plan_counts_the_margin_behind_a_lens_and_says_what_annotations_are_taken_to_cost():
    """The corner's ray, r of r (1 - 0.3 r^2 + 0.1 r^4) = 0.882, goes the furthest; of assumptions only those made."""
    lens = ("robot.camera.distortion.k1=-0.3", "robot.camera.distortion.k2=0.1")
    plain, behind, annotated = (
        ScenarioPlan.from_specs([draw_run(load_scenario("symolo", ("render.method=full", *settings)), "CW", 1)], 1)
        for settings in ((), lens, ("render.annotations=[depth]",))
    )
    (own,), (wider,) = plain.runs, behind.runs
    corner = 0.5 * 42.33 / 30 * 1.25
    roots = np.roots([0.1, 0, -0.3, 0, 1, -corner])
    times = (min(root.real for root in roots if abs(root.imag) < 1e-9) / corner) ** 2
    traced_s = 201 * 640 * 480 * pixel_s(own.sampling)
    # At each side come up to three spare pixels, and seven more make a multiple of eight: 13 of 820 and of 615.
    spare = times * ((1 + 13 / 820) * (1 + 13 / 615) - 1)
    assert 0 <= (wider.render_core_s - own.render_core_s) / traced_s - (times - 1) < spare
    assert "times as many traced pixels, for the margin that the lens needs" in " ".join(behind.text().split())
    assert "margin" not in plain.text()
    assert "all annotations 1.5 us per pixel" in " ".join(annotated.text().split())
    assert "annotations" not in plain.text()
    assert annotated.render_s > plain.render_s


def test_plan_takes_its_time_from_the_quality_and_says_which(symolo):

    def planned(*settings):
        return ScenarioPlan.from_specs([draw_run(load_scenario("symolo", settings), "CW", 1)], 1)

    plain, fewer = planned("render.method=full"), planned("render.samples=1", "render.denoise=false")
    traced_s, shared_s = 201 * 640 * 480 * RENDER_SAMPLE_S, RENDER_START_S + 201 * RENDER_FRAME_S
    assert fewer.render_s == pytest.approx(traced_s + shared_s)
    assert planned("render.quality=reference").render_s > 2048 * traced_s > 100 * plain.render_s
    assert f"quality    standard, {plain.runs[0].sampling.samples} samples per pixel" in plain.text()
    assert "to denoise" in plain.text()
    assert "to denoise" not in fewer.text()
    parts = planned()
    assert "from hybrid rendering" in parts.text()
    assert parts.render_s < plain.render_s / 2
    # `standard` takes 81 % of the time of `complete` (docs/rendering.md).
    lit = planned("render.samples=1", "render.denoise=false", "render.light_paths.preset=complete")
    assert lit.render_s == pytest.approx(traced_s / 0.81 + shared_s, rel=0.02)
    # In 4 of 201 images, a choice takes four references of 1 sample with all light, besides its candidate.
    assert parts.render_s - planned("render.method=hybrid").render_s > 4 * traced_s / 0.82 * 4 / 201
    assert (
        "quality    draft, 9 samples"
        in symolo("plan", "smoke", "--set=render.quality=draft", "--set=render.samples=9").out
    )


def test_a_graphics_card_that_is_not_there_is_refused_before_the_work_starts(here, symolo, monkeypatch):
    monkeypatch.setattr("blender_scenes.render.devices.listed_gpus", tuple)
    before = files_in(here)
    lists = ("release", "smoke", "--out", "OUT"), ("rerender", "HERE/data.csv", "--look", "lab", "--out", "OUT")
    for arguments in (*lists, ("preview", "smoke", "-n", "1", "--out", "OUT.png")):
        ended = symolo(*arguments, "--device", "gpu")
        assert ended.code == 5
        assert ended.err.count("\n") == 1
        assert "give --device cpu" in ended.err
    assert files_in(here) == before


def test_plan_of_smoke_counts_to_the_image(dataset, tiny, symolo):
    """With a time limit instead of a lap nothing is assumed about rows and images."""
    lines = symolo("plan", "smoke", *tiny).out.splitlines()
    for line in lines[1:3]:
        run, _, rows, images, *_ = line.split()
        assert len((dataset / run / "data.csv").read_text().splitlines()) - 1 == int(rows)
        assert len(list((dataset / run / "images").iterdir())) == int(images)


def test_schema_is_json(symolo):
    ended = symolo("schema")
    assert ended.code == 0
    assert "properties" in json.loads(ended.out)


def test_version_is_that_of_the_project(symolo):
    pyproject = (Path(__file__).parents[3] / "pyproject.toml").read_text()
    assert f'version = "{symolo("--version").out.removeprefix("symolo ").strip()}"' in pyproject


def test_a_reader_that_goes_away_is_no_error(symolo):
    process = symolo.start("schema", "--of", "inspect")  # more than the 8 kB after which Python writes
    process.stdout.close()
    with process.stderr as stderr:
        assert stderr.read() == ""
    assert process.wait(timeout=30) == 0


def test_contact_sheet_shows_every_run(dataset, tmp_path, symolo):
    out = tmp_path / "sheet.png"
    made = symolo("contact-sheet", dataset, "--out", out, "--per-run", 3, "--width-px", 64)
    assert (made.code, made.out.strip()) == (0, f"{out}: 2 runs, 192 x 132 px")
    sheet = cv2.imread(str(out))
    assert sheet.shape == (2 * (48 + 18), 3 * 64, 3)
    first = cv2.imread(str(dataset / "CW/test_1/images/000001.jpg"))
    shown = cv2.resize(sheet[:48, :64], (32, 24), interpolation=cv2.INTER_NEAREST)
    assert abs(shown.astype(int) - first).max() == 0


def test_doctor_finds_nothing_missing_here(symolo):
    ended = symolo("doctor")
    assert (ended.code, ended.err) == (0, "")
    assert all(line.startswith("ok ") for line in ended.out.splitlines())
    names = [line.split(":")[0].split(None, 1)[1] for line in ended.out.splitlines()]
    assert {"Python", "bpy", "system libraries", "Blender", "PyBullet", "disk", "cores", "memory"} <= set(names)


def test_doctor_names_the_command_that_installs_missing_libraries_and_a_broken_engine(tmp_path, symolo):
    """The dynamic loader's listing and an engine that does not start, as a bare machine shows them."""
    ldd = tmp_path / "ldd"
    ldd.write_text("#!/bin/sh\necho '\tlibXi.so.6 => not found'\necho '\tlibSM.so.6 => not found'\n")
    ldd.chmod(0o755)
    (tmp_path / "pybullet.py").write_text("raise ImportError('broken on purpose')\n")
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": str(tmp_path)}
    process = symolo.start("doctor", env=environment)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (5, "")
    missing = [line for line in out.splitlines() if line.startswith("MISSING")]
    assert len(missing) == 2
    assert "libSM.so.6, libXi.so.6" in missing[0]
    assert "apt-get install -y" in missing[0]
    assert "libxi6" in missing[0]
    assert "broken on purpose" in missing[1]
    assert "./setup" in missing[1]


def test_doctor_compares_with_the_lock_file(symolo, monkeypatch):
    monkeypatch.setattr("pipeline.doctor._child", lambda _program: (0, "version 4.5.0\n", ""))  # both engines start
    monkeypatch.setattr("pipeline.doctor.locked_versions", lambda: {"scipy": "9.9"})
    ended = symolo("doctor")
    assert ended.code == 5
    (line,) = [line for line in ended.out.splitlines() if line.startswith("MISSING")]
    assert line.startswith("MISSING scipy: ")
    assert "the lock file has 9.9" in line


def test_help_of_every_command_gives_an_example(symolo):
    making = ["plan", "preview", "release", "simulate", "render", "assemble", "rerender"]
    commands = [*making, "verify", "contact-sheet", "schema"]
    listing = symolo("--help").out
    for command in commands:
        assert command in listing
        assert f"Example: symolo {command}" in " ".join(symolo(command, "--help").out.split())


def test_a_paragraph_of_the_help_has_no_line_breaks_of_the_source():
    groups: list[Any] = [command_line()]
    for group in groups:
        for command in group.commands.values():
            groups += [command] if hasattr(command, "commands") else []
            assert "\n" not in command.help.replace("\n\n", ""), command.name


def test_help_loads_no_engine_and_no_table_library():
    """Loading them is what would make it slow; the time itself is the machine's."""
    program = "import sys; from pipeline.cli import main; main(['--help']); print(sorted(sys.modules), file=sys.stderr)"
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = process.stderr
    for heavy in ("'bpy'", "'pybullet'", "'numpy'", "'pandas'", "'scipy'", "'cv2'", "'pydantic'"):
        assert heavy not in loaded


CALLBACK = """
import os, signal, sys, time, weakref
from pipeline import cli
class Thing:
    pass
def interrupted(_):
    os.kill(os.getpid(), signal.{name})
    time.sleep(0.001)
def check():
    thing = Thing()
    reference = weakref.ref(thing, interrupted)
    del thing
    time.sleep(20)
cli.check_address_space = check
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(cli.main(["plan", "smoke"]))
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_an_interrupt_in_a_callback_whose_errors_python_ignores_is_an_interrupt(name, tmp_path):
    """As with one that falls into the callback of a weak reference while a library calculates."""
    program = CALLBACK.format(name=name)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path, timeout=25
    )
    assert done.returncode == 130
    assert done.stderr == "symolo: interrupted; run the same command again, which then begins from the start\n"


def _interrupted_twice(seconds_between: float, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run a program that gets a SIGTERM and a SIGINT, by its own clock this time apart, and deals with the first."""
    program = f"""
import os, signal
from pipeline import cli
signal.signal(signal.SIGINT, signal.default_int_handler)
now_s = 100.0
cli.monotonic = lambda: now_s
with cli._interrupts_noted():
    try:
        os.kill(os.getpid(), signal.SIGTERM)
        signal.pause()
    except KeyboardInterrupt:
        print("first", flush=True)
    now_s += {seconds_between}
    os.kill(os.getpid(), signal.SIGINT)
    print("went on", flush=True)
"""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=folder)


def test_a_second_interrupt_ends_it_at_once(tmp_path):
    """Also where the first one is being dealt with, or a library swallows it."""
    done = _interrupted_twice(1.0, tmp_path)
    assert (done.returncode, done.stdout) == (130, "first\n")
    assert done.stderr == f"symolo: {INTERRUPTED_TWICE}\n"


def test_signals_to_a_process_and_to_its_group_are_one_interrupt(tmp_path):
    """`timeout` of GNU sends its signal to the command and then to the process group, which the command is in."""
    done = _interrupted_twice(0.001, tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "first\nwent on\n", "")
