"""The graphics cards on which Cycles can render. Run as a module, it prints the kind of each card."""

import sys

import bpy

from blender_scenes.render.devices import GPU_KINDS, LISTED
from symolo.core.errors import EnvironmentLacking


def listed() -> dict[str, list[str]]:
    """Return the names of the cards by kind."""
    preferences = bpy.context.preferences.addons["cycles"].preferences
    cards = {}
    for kind in GPU_KINDS:
        try:
            names = [device.name for device in preferences.get_devices_for_type(kind) if device.type == kind]
        except (TypeError, ValueError, RuntimeError):  # a kind that this build of Blender does not know
            continue
        if names:
            cards[kind] = names
    return cards


def enable(kind: str) -> None:
    """Let Cycles use all cards of a kind and no other device.

    Raises:
        EnvironmentLacking: The machine has no such card.
    """
    if kind not in listed():
        cure = "render on the machine that has it, or give --device cpu"
        raise EnvironmentLacking(f"Cycles finds no graphics card by {kind}; {cure}")
    preferences = bpy.context.preferences.addons["cycles"].preferences
    preferences.compute_device_type = kind
    preferences.refresh_devices()
    for device in preferences.devices:
        device.use = device.type == kind


if __name__ == "__main__":
    sys.stdout.write("".join(f"\n{LISTED}{kind}" * len(names) for kind, names in listed().items()) + "\n")
