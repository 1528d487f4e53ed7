"""A run that chooses its samples itself: the choice is measured once, and later commands make the same image."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from blender_scenes.render.job import FramePose, build_job
from blender_scenes.render.probe import LADDER, PROBE, read_decision
from blender_scenes.render.renderer import render_job
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Surface
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render
from symolo.core.files.atomic_files import make_folder, remove_file, write_file
from symolo.core.files.file_hashes import sha256_of
from symolo.dataset.layout import frame_name

FRAME = FramePose(number=1, t_s=0.2, x_m=0.55, y_m=-0.5, yaw_rad=np.pi / 2)


@pytest.fixture(scope="module")
def folder(arena, robot, tmp_path_factory) -> Path:
    """Folder of a job that leaves its settings open, as long runs do.

    Its images have few pixels, and its scene is a wall on a mottled floor, to cost little.
    """
    made = tmp_path_factory.mktemp("probed")
    job = build_job(arena, robot, LookConfig(name="plain"), Render(width_px=24, height_px=18), [FRAME], seed=5)
    mottled = Mix(NoiseTexture((30.0, 30.0), (0.3, 0.7)), Color((0.5, 0.45, 0.4)), Color((0.3, 0.3, 0.3)))
    surfaces = Surface("floor", mottled), Surface("wall", Color((0.7, 0.2, 0.1)))
    meshes = (
        floor("floor", (-1.0, -1.0), (1.0, 1.0), 0.0, "floor"),
        block("wall", (0.5, 0.2, 0.1), (0.4, 0.05, 0.2), "wall"),
    )
    scene = replace(job.scene, surfaces=surfaces, meshes=meshes, robot=())
    job = replace(job, scene=scene, sampling=replace(job.sampling, probe=True))
    make_folder(made)
    write_file(made / "job.json", job.to_json().encode())
    return made


@pytest.fixture(scope="module")
def image(folder) -> str:
    """SHA-256 of the image."""
    return _rendered(folder)


def _rendered(folder: Path) -> str:
    made = render_job(folder / "job.json", folder / "images")
    assert made.made == 1
    return made.files[0].sha256


@pytest.mark.usefixtures("image")
def test_the_choice_lies_beside_the_images_with_the_errors_that_it_rests_on(folder):
    decision = read_decision(folder / "images", sha256_of(folder / "job.json"))
    assert decision is not None
    assert decision.full in LADDER
    assert len(decision.errors.rendering) == len(decision.errors.jpeg) == 1
    assert decision.errors.excess <= 1 or decision.full == LADDER[-1]


def test_a_later_command_uses_the_choice_and_makes_the_same_image(folder, image):
    chosen_ns = (folder / PROBE).stat().st_mtime_ns
    remove_file(folder / "images" / frame_name(FRAME.number))
    assert _rendered(folder) == image
    assert (folder / PROBE).stat().st_mtime_ns == chosen_ns


def test_an_image_without_the_choice_is_made_again_by_the_same_choice(folder, image):
    """Blocks of a run may be rendered on several machines, each of which may have to choose."""
    choice = (folder / PROBE).read_bytes()
    remove_file(folder / PROBE)
    assert _rendered(folder) == image
    assert (folder / PROBE).read_bytes() == choice
