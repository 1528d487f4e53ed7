"""The Blender process as a whole, with small images."""

import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from blender_scenes.render import renderer
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.renderer import RenderError, render_job
from blender_scenes.scene.meshes import floor
from blender_scenes.scene.shading import Color, Surface
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render
from symolo.core.errors import EnvironmentLacking

FRAMES = [FramePose(number=i, t_s=0.2 * i, x_m=0.55, y_m=-0.6 + 0.1 * i, yaw_rad=np.pi / 2) for i in (1, 2, 3)]
SMALL = Render(width_px=80, height_px=60, samples=2)


@pytest.fixture(scope="module")
def job(arena, robot) -> RenderJob:
    return build_job(arena, robot, LookConfig(name="plain"), SMALL, FRAMES, seed=5)


@pytest.fixture(scope="module")
def simple_job(job) -> RenderJob:
    """The same of a bare floor: for what does not depend on the scene, of which Blender takes a second to build."""
    ground = floor("floor", (-1.0, -1.0), (1.0, 1.0), 0.0, "floor")
    surfaces = (Surface("floor", Color((0.5, 0.5, 0.5))),)
    return replace(job, scene=replace(job.scene, surfaces=surfaces, meshes=(ground,), robot=()))


def _written(job: RenderJob, folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "job.json").write_text(job.to_json())
    return folder / "job.json"


@pytest.fixture(scope="module")
def rendered(job, tmp_path_factory):
    folder = tmp_path_factory.mktemp("rendered")
    heard = []
    frames = render_job(_written(job, folder), folder / "images", threads=1, on_frame=heard.append)
    return folder, frames, heard


def test_every_frame_is_written_reported_and_an_image(rendered):
    folder, frames, heard = rendered
    assert heard == [1, 2, 3]
    assert [f.number for f in frames.files] == [1, 2, 3]
    assert frames.made == 3
    images = [cv2.imread(str(folder / "images" / f.file)) for f in frames.files]
    for image in images:
        assert image.shape == (60, 80, 3)
        assert 60 < image.mean() < 190
        assert image.std() > 8
    assert not np.array_equal(images[0], images[1])


def test_missing_and_truncated_frames_are_rendered_again_with_the_same_bytes_on_two_threads(rendered):
    """The others are left alone, so that the last frame follows the first one and not the second."""
    folder, before, _ = rendered
    missing, whole, broken = (folder / "images" / f.file for f in before.files)
    data, untouched = [path.read_bytes() for path in (missing, broken)], whole.stat().st_mtime_ns
    missing.unlink()
    broken.write_bytes(data[1][: len(data[1]) // 2])
    after = render_job(folder / "job.json", folder / "images", threads=2)
    assert after.made == 2
    assert [path.read_bytes() for path in (missing, broken)] == data
    assert whole.stat().st_mtime_ns == untouched
    assert [f.sha256 for f in after.files] == [f.sha256 for f in before.files]


def test_a_changed_job_is_rendered_again(job, rendered):
    folder, before, _ = rendered
    brighter = replace(job, response=replace(job.response, brightness=2 * job.response.brightness))
    other = folder / "other"
    (_written(brighter, other)).replace(folder / "other.json")
    after = render_job(folder / "other.json", folder / "images", threads=2, numbers=[1])
    assert after.made == 1
    assert after.files[0].sha256 != before.files[0].sha256


def test_a_frame_that_the_job_has_not_is_refused_before_any_work(job, tmp_path):
    with pytest.raises(ValueError, match="no frame 9"):
        render_job(_written(job, tmp_path), tmp_path / "images", numbers=[1, 9])
    assert not (tmp_path / "images").exists()


def test_a_failure_inside_blender_comes_with_the_end_of_its_log(simple_job, tmp_path):
    scene = replace(simple_job.scene, sky=replace(simple_job.scene.sky, panorama="nowhere"))
    lost = replace(simple_job, scene=scene)
    with pytest.raises(RenderError, match=r"nowhere\.exr[\s\S]*last lines of its log"):
        render_job(_written(lost, tmp_path), tmp_path / "images")


def _pretend_bpy(folder: Path, monkeypatch, program: str) -> None:
    (folder / "bpy.py").write_text(program)
    monkeypatch.setenv("PYTHONPATH", str(folder))


def test_a_missing_system_library_names_the_line_that_installs_it(job, tmp_path, monkeypatch):
    missing = "libXrender.so.1: cannot open shared object file: No such file or directory"
    _pretend_bpy(tmp_path, monkeypatch, f"raise ImportError({missing!r})")
    with pytest.raises(EnvironmentLacking, match=r"libXrender\.so\.1.*apt-get install -y .*libxrender1"):
        render_job(_written(job, tmp_path), tmp_path / "images")


def test_a_full_disk_is_the_machines_fault_and_asks_for_space(job, tmp_path, monkeypatch):
    full = "def __getattr__(name):\n    raise OSError(28, 'No space left on device')\n"
    _pretend_bpy(tmp_path, monkeypatch, full)
    (tmp_path / "mathutils.py").write_text("Matrix = Vector = None")
    with pytest.raises(EnvironmentLacking, match=r"No space left on device.*free some space"):
        render_job(_written(job, tmp_path), tmp_path / "images")


@pytest.mark.parametrize("place", ["while it is loaded", "while it renders"])
def test_blender_out_of_memory_is_named_in_one_line(place, job, tmp_path, monkeypatch):
    """Blender raises a RuntimeError in place of a MemoryError."""
    short = "raise RuntimeError('Error: Out of memory')"
    _pretend_bpy(tmp_path, monkeypatch, short if "loaded" in place else f"def __getattr__(name):\n    {short}\n")
    (tmp_path / "mathutils.py").write_text("Matrix = Vector = None")
    with pytest.raises(EnvironmentLacking, match=r"^there is not enough memory: Error: Out of memory; .+$"):
        render_job(_written(job, tmp_path), tmp_path / "images")


def test_settings_of_the_users_blender_do_not_reach_ours(job, tmp_path, monkeypatch):
    note = tmp_path / "seen"
    monkeypatch.setenv("OCIO", "/nowhere/config.ocio")
    monkeypatch.setenv("CYCLES_CPU_NO_AVX2", "1")
    _pretend_bpy(tmp_path, monkeypatch, f"import os\nopen({str(note)!r}, 'w').write(' '.join(os.environ))\nos._exit(1)")
    with pytest.raises(RenderError, match="exit code 1"):
        render_job(_written(job, tmp_path), tmp_path / "images")
    assert "PATH" in note.read_text().split()
    assert not {"OCIO", "CYCLES_CPU_NO_AVX2"} & set(note.read_text().split())


def test_a_killed_child_is_an_error_not_a_wait(job, tmp_path, monkeypatch):
    _pretend_bpy(tmp_path, monkeypatch, "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)")
    with pytest.raises(RenderError, match="signal SIGKILL"):
        render_job(_written(job, tmp_path), tmp_path / "images")


@pytest.mark.usefixtures("stillborn_children")
def test_a_child_killed_before_it_reads_its_job_is_an_error_too(job, tmp_path):
    with pytest.raises(RenderError, match="signal SIGKILL"):
        render_job(_written(job, tmp_path), tmp_path / "images")


def test_a_child_that_says_nothing_is_given_up(job, tmp_path, monkeypatch):
    _pretend_bpy(tmp_path, monkeypatch, "import time\ntime.sleep(60)")
    monkeypatch.setattr(renderer, "_PATIENCE_S", 0.2)
    with pytest.raises(RenderError, match="made no progress in"):
        render_job(_written(job, tmp_path), tmp_path / "images")


def test_the_driver_of_a_card_has_time_to_compile_before_the_first_frame(job, tmp_path, monkeypatch):
    _pretend_bpy(tmp_path, monkeypatch, "import os, time\ntime.sleep(0.6)\nos._exit(7)")
    monkeypatch.setattr(renderer, "_PATIENCE_S", 0.2)
    on_card = replace(job, sampling=replace(job.sampling, device="OPTIX", samples=1))
    with pytest.raises(RenderError, match="exit code 7"):
        render_job(_written(on_card, tmp_path), tmp_path / "images")


def test_no_child_outlives_a_killed_renderer(job, tmp_path, monkeypatch):
    note = tmp_path / "pid"
    program = f"import os, time\nopen({str(note)!r}, 'w').write(str(os.getpid()))\ntime.sleep(60)"
    _pretend_bpy(tmp_path, monkeypatch, program)
    call = "import sys; from pathlib import Path; from blender_scenes.render.renderer import render_job\n"
    call += f"render_job(Path({str(_written(job, tmp_path))!r}), Path({str(tmp_path / 'images')!r}))"
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    parent = subprocess.Popen([sys.executable, "-c", call])
    _wait_for(lambda: note.exists() and note.read_text())
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    child = int(note.read_text())
    _wait_for(lambda: not _runs(child))
    assert list(tmp_path.glob("symolo-*")) == []


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def _wait_for(condition) -> None:
    for _ in range(200):
        if condition():
            return
        time.sleep(0.1)
    raise AssertionError("waited 20 s in vain")


def test_nothing_of_a_child_is_left_in_the_temporary_folder(simple_job, tmp_path, monkeypatch):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    render_job(_written(simple_job, tmp_path), tmp_path / "images", numbers=[1])
    assert list(scratch.iterdir()) == []
