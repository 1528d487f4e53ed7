"""Which graphics card is shown to whom. No card is needed: what is looked at is what processes and tasks are given."""

import sys
from pathlib import Path

import pytest

from pipeline.executors import chosen
from pipeline.work.supervisor import run_units
from pipeline.work.units import RenderUnit, SimulateUnit
from symolo.core.errors import EnvironmentLacking

SEEN = "CUDA_VISIBLE_DEVICES"
WORKER = f"""
import json, os, sys, time
from pathlib import Path
for line in sys.stdin:
    unit = json.loads(line)
    seen = Path(unit["folder"]) / unit["name"]
    first = not seen.exists()
    with seen.open("a") as file:
        file.write(os.environ["{SEEN}"] + " ")
    if first:
        time.sleep(0.5)  # so that each of the others has begun one too
        os.kill(os.getpid(), 9)
    print(json.dumps({{"kind": "finished"}}), flush=True)
"""


def _units(folder, count=1):
    one = RenderUnit(name="", work="images", job=folder, folder=folder, numbers=(1,), threads=1)
    return [one.model_copy(update={"name": f"run_{number}"}) for number in range(count)]


@pytest.fixture
def two_cards(monkeypatch):
    monkeypatch.setattr("blender_scenes.render.devices.listed_gpus", lambda: ("OPTIX", "CUDA", "OPTIX", "CUDA"))
    monkeypatch.delenv(SEEN, raising=False)


@pytest.mark.usefixtures("two_cards")
@pytest.mark.parametrize("part", [None, "1/1"])
def test_workers_take_the_cards_in_turn_and_none_for_the_processor(monkeypatch, part):
    given = []
    monkeypatch.setattr(
        "pipeline.executors.local.run_units", lambda *_, **options: given.append(options["slot_environments"]) or []
    )
    for device in ("OPTIX", "CPU"):
        chosen(4, None, part, None).on(device).do(_units(Path()), lambda *_: None)
    assert given == [({SEEN: "0"}, {SEEN: "1"}), ()]


def test_of_four_workers_two_see_each_of_two_cards_and_what_replaces_one_sees_its_card(tmp_path):
    command, cards = (sys.executable, "-c", WORKER), [{SEEN: "0"}, {SEEN: "1"}]
    assert run_units(_units(tmp_path, 4), 4, lambda *_: None, command=command, slot_environments=cards) == []
    assert sorted(path.read_text() for path in tmp_path.iterdir()) == ["0 0 ", "0 0 ", "1 1 ", "1 1 "]


def _asked_on(ray, device, units, share=None):
    executor = chosen(None, None, None, "auto", share).on(device)
    assert executor.do(units, lambda *_: None) == []
    return [task.get("num_gpus") for task in ray.asked]


@pytest.mark.parametrize(("given", "share", "at_a_time"), [(None, 0.5, 4), (0.25, 0.25, 8), (1.0, 1.0, 2)])
def test_a_block_on_ray_asks_for_its_share_and_the_cards_decide_how_many_are_given(
    pretended_ray, given, share, at_a_time
):
    ray = pretended_ray(CPU=64.0, GPU=2.0)
    assert _asked_on(ray, "OPTIX", _units(Path(), 100), given) == [share]
    assert ray.most == 2 * at_a_time  # one to do and one that waits


def test_on_ray_neither_simulation_nor_the_processor_asks_for_a_card(pretended_ray):
    simulation = SimulateUnit(name="run", spec="", folder=Path(), key="")
    assert _asked_on(pretended_ray(CPU=8.0, GPU=1.0), "OPTIX", [simulation]) == [None]
    assert _asked_on(pretended_ray(CPU=8.0), "CPU", _units(Path())) == [None]


def test_a_cluster_without_a_card_is_reported_before_ray_waits_for_one(pretended_ray):
    with pytest.raises(EnvironmentLacking, match=r"no node .* has a graphics card.*--num-gpus.*--device cpu"):
        _asked_on(pretended_ray(CPU=8.0), "OPTIX", _units(Path()))


def test_a_share_is_of_a_cluster_alone(symolo, tmp_path):
    ended = symolo("release", "smoke", "--out", tmp_path / "out", "--gpu-share", "0.5")
    assert (ended.code, "workers use the graphics cards alternately" in ended.err) == (2, True)
