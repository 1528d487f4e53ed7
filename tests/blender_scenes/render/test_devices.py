"""What renders: the processor, or a graphics card where Blender finds one."""

import os
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from blender_scenes.render import devices
from blender_scenes.render.devices import GPU_KINDS, DeviceKind, device_for, one_card_each
from blender_scenes.render.job import FramePose, build_job
from blender_scenes.render.renderer import render_job
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render
from symolo.core.errors import EnvironmentLacking


def _has(*kinds: DeviceKind):
    return lambda: kinds


def test_every_kind_of_card_that_cycles_knows_is_looked_for():
    assert set(GPU_KINDS) == {"OPTIX", "CUDA", "HIP", "METAL", "ONEAPI"} == set(get_args(DeviceKind)) - {"CPU"}


@pytest.mark.parametrize("device", ["auto", "gpu"])
def test_a_card_is_taken_by_its_fastest_way(device):
    """An NVIDIA card with ray-tracing cores is listed under both; OptiX is what Blender's manual recommends for it."""
    assert device_for(device, _has("CUDA", "OPTIX")) == "OPTIX"
    assert device_for(device, _has("ONEAPI")) == "ONEAPI"


def test_without_a_card_auto_is_the_processor_and_gpu_is_refused_with_a_way_out():
    assert device_for("auto", _has()) == "CPU"
    with pytest.raises(EnvironmentLacking, match=r"OptiX.*--device cpu") as caught:
        device_for("gpu", _has())
    assert "\n" not in str(caught.value)


def test_for_the_processor_blender_is_not_started():
    def asked():
        raise AssertionError

    assert device_for("cpu", asked) == "CPU"


@pytest.fixture(scope="module")
def cards() -> tuple[DeviceKind, ...]:
    """The kinds of card that Blender lists on this machine."""
    return devices.listed_gpus()


def test_blender_is_asked_for_the_cards_of_this_machine(cards):
    """Whatever this machine has; no machine has both Apple's and NVIDIA's."""
    assert set(cards) <= set(GPU_KINDS)
    assert not {"METAL", "CUDA"} <= set(cards)


CYCLES = """
from types import SimpleNamespace as Has
CARDS = {"OPTIX": 2, "CUDA": 2}
def of(kind):
    if kind == "METAL":
        raise TypeError
    return [Has(type=made, name=made) for made in [kind] * CARDS.get(kind, 0) + ["CPU"]]
context = Has(preferences=Has(addons={"cycles": Has(preferences=Has(get_devices_for_type=of))}))
"""


def test_each_card_that_cycles_lists_is_counted_by_each_way_to_it(tmp_path, monkeypatch):
    (tmp_path / "bpy.py").write_text(CYCLES)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}")
    assert devices.listed_gpus() == ("OPTIX", "OPTIX", "CUDA", "CUDA")


@pytest.mark.parametrize(
    ("kind", "environment", "expected"),
    [
        ("CUDA", {}, [{"CUDA_VISIBLE_DEVICES": "0"}, {"CUDA_VISIBLE_DEVICES": "1"}]),
        ("OPTIX", {"CUDA_VISIBLE_DEVICES": "3, GPU-5f"}, [{"CUDA_VISIBLE_DEVICES": name} for name in ("3", "GPU-5f")]),
        ("HIP", {"CUDA_VISIBLE_DEVICES": "3"}, [{"HIP_VISIBLE_DEVICES": "0"}, {"HIP_VISIBLE_DEVICES": "1"}]),
        ("ONEAPI", {}, [{"ZE_AFFINITY_MASK": "0"}, {"ZE_AFFINITY_MASK": "1"}]),
        ("METAL", {}, []),
        ("CPU", {"CUDA_VISIBLE_DEVICES": "3"}, []),
    ],
)
def test_each_card_that_is_seen_is_shown_alone_by_the_variable_of_its_driver(kind, environment, expected):
    listed = _has(*[card for card in GPU_KINDS for _ in range(2)])
    assert [*one_card_each(kind, environment, listed)] == expected


def test_a_blender_that_does_not_start_is_the_machines_fault(tmp_path, monkeypatch):
    (tmp_path / "bpy.py").write_text("raise ImportError('libXrender.so.1: cannot open shared object file')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(EnvironmentLacking, match=r"libXrender\.so\.1.*apt-get install"):
        devices.listed_gpus()


def test_a_job_for_a_card_that_is_not_there_is_the_machines_fault(cards, arena, robot, tmp_path):
    absent = next(kind for kind in GPU_KINDS if kind not in cards)
    pose = FramePose(number=1, t_s=0.0, x_m=0.55, y_m=-0.5, yaw_rad=np.pi / 2)
    job = build_job(
        arena, robot, LookConfig(name="plain"), Render(width_px=16, height_px=16, samples=1), [pose], seed=1
    )
    path = tmp_path / "job.json"
    path.write_text(replace(job, sampling=replace(job.sampling, device=absent)).to_json())
    with pytest.raises(EnvironmentLacking, match=f"{absent}.*--device cpu"):
        render_job(path, tmp_path / "images")
