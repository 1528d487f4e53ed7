"""What renders: the processor, or a graphics card. Only the processor gives the same bytes on every machine."""

import os
import subprocess
import sys
from collections.abc import Callable, Collection, Mapping
from typing import Literal

from blender_scenes.render.surroundings import SYSTEM_PACKAGES, without_blender_settings
from configs.schema.scenario import RenderDevice
from symolo.core.errors import EnvironmentLacking

DeviceKind = Literal["CPU", "OPTIX", "CUDA", "HIP", "METAL", "ONEAPI"]
"""Cycles' own names."""
GPU_KINDS: tuple[DeviceKind, ...] = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
"""The best first: OptiX before CUDA, for a card with both traces faster by it (Blender manual, GPU Rendering)."""

LISTED = "gpu "
"""Before each kind in what the process that lists them prints, amid Blender's own chatter."""
VISIBLE: dict[DeviceKind, str] = {
    "OPTIX": "CUDA_VISIBLE_DEVICES",
    "CUDA": "CUDA_VISIBLE_DEVICES",
    "HIP": "HIP_VISIBLE_DEVICES",
    "ONEAPI": "ZE_AFFINITY_MASK",
}
"""Variables by which NVIDIA's, AMD's and Intel's drivers show a process some of the cards; Apple's knows none."""
_TIMEOUT_S = 120


def device_for(asked: RenderDevice, listed: Callable[[], Collection[str]] | None = None) -> DeviceKind:
    """The kind that a command renders on; `listed` says which kinds of card there are, Blender by default.

    Raises:
        EnvironmentLacking: A card is asked for and there is none, or Blender does not start.
    """
    if asked == "cpu":
        return "CPU"
    there = (listed or listed_gpus)()
    for kind in GPU_KINDS:
        if kind in there:
            return kind
    if asked == "gpu":
        raise EnvironmentLacking(
            "render.device gpu: Cycles finds no graphics card by OptiX, CUDA, HIP, Metal or oneAPI;"
            " install its driver, or give --device cpu"
        )
    return "CPU"


def one_card_each(
    kind: DeviceKind, environment: Mapping[str, str], listed: Callable[[], Collection[str]] | None = None
) -> tuple[dict[str, str], ...]:
    """For each card of a kind, the variables with which a process sees that card alone; nothing for the processor.

    Args:
        kind: As `device_for` gave it.
        environment: Of this process; where it sees some of the machine's cards, these are dealt out and no others.
        listed: The kind of each card; Blender lists them by default.

    Raises:
        EnvironmentLacking: Blender does not start.
    """
    if kind not in VISIBLE:
        return ()
    count = list((listed or listed_gpus)()).count(kind)
    seen = [name.strip() for name in environment.get(VISIBLE[kind], "").split(",") if name.strip()]
    names = seen or [str(number) for number in range(count)]
    return tuple({VISIBLE[kind]: name} for name in names[:count])


def listed_gpus() -> tuple[str, ...]:
    """The kind of each card that Blender lists, found out in a process of its own, which takes a second.

    Raises:
        EnvironmentLacking: Blender does not start.
    """
    command = [sys.executable, "-m", "blender_scenes.blender_side.gpus"]
    environment = without_blender_settings(os.environ)
    try:
        child = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=_TIMEOUT_S, env=environment
        )
    except subprocess.TimeoutExpired:
        raise EnvironmentLacking(f"Blender lists no graphics cards within {_TIMEOUT_S} s; give --device cpu") from None
    if child.returncode:
        last = (child.stderr.strip().splitlines() or ["no word"])[-1]
        raise EnvironmentLacking(f"Blender does not start: {last}: run `apt-get install -y {SYSTEM_PACKAGES}`")
    return tuple(line.removeprefix(LISTED) for line in child.stdout.splitlines() if line.startswith(LISTED))
