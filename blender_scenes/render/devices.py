"""The device that renders: the processor or a graphics card. Only the processor gives the same bytes everywhere."""

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
"""From the fastest: OptiX before CUDA, for a card that has both is faster with it (Blender manual, GPU Rendering)."""

LISTED = "gpu "
"""Prefix of the lines that list the cards, among Blender's other output."""
VISIBLE: dict[DeviceKind, str] = {
    "OPTIX": "CUDA_VISIBLE_DEVICES",
    "CUDA": "CUDA_VISIBLE_DEVICES",
    "HIP": "HIP_VISIBLE_DEVICES",
    "ONEAPI": "ZE_AFFINITY_MASK",
}
"""Variables that limit a process to some cards, for the drivers of NVIDIA, AMD and Intel; Apple's has none."""
_TIMEOUT_S = 120


def device_for(choice: RenderDevice, listed: Callable[[], Collection[str]] | None = None) -> DeviceKind:
    """Return the kind of device for a command; `listed` returns the kinds of the machine's cards, by default Blender's.

    Raises:
        EnvironmentLacking: A card is required and there is none, or Blender does not start.
    """
    if choice == "cpu":
        return "CPU"
    available = (listed or listed_gpus)()
    for kind in GPU_KINDS:
        if kind in available:
            return kind
    if choice == "gpu":
        raise EnvironmentLacking(
            "render.device gpu: Cycles finds no graphics card by OptiX, CUDA, HIP, Metal or oneAPI;"
            " install its driver, or give --device cpu"
        )
    return "CPU"


def one_card_each(
    kind: DeviceKind, environment: Mapping[str, str], listed: Callable[[], Collection[str]] | None = None
) -> tuple[dict[str, str], ...]:
    """Return for each card of a kind the variables that limit a process to this card; nothing for the processor.

    Args:
        kind: Kind from `device_for`.
        environment: Environment of this process; if it limits the process to some cards, only these are used.
        listed: Function that returns the kind of each card; Blender lists them by default.

    Raises:
        EnvironmentLacking: Blender does not start.
    """
    if kind not in VISIBLE:
        return ()
    count = list((listed or listed_gpus)()).count(kind)
    visible = [name.strip() for name in environment.get(VISIBLE[kind], "").split(",") if name.strip()]
    names = visible or [str(number) for number in range(count)]
    return tuple({VISIBLE[kind]: name} for name in names[:count])


def listed_gpus() -> tuple[str, ...]:
    """Return the kind of each card that Blender lists, from a child process, which takes a second.

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
