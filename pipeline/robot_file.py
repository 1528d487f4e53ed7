"""The text of a robot file that was imported, with what was read and assumed as its comment."""

import yaml

from physics.robot.urdf_import import ImportedRobot

SAME_SIZE = 0.05
"""Difference of the size, as a share, up to which a robot drives in the shipped arena as it is."""
START_M = (0.55, -0.20)
"""Start of the scenario smoke in the shipped arena."""


def robot_file_text(imported: ImportedRobot, source: str) -> str:
    """Return the YAML text of a robot file."""
    lines = [f"Imported from {source}."]
    for heading, sentences in imported.lists():
        lines += [f"{heading}:".capitalize(), *_items(sentences)]
    comment = "".join(f"# {line}\n" for line in lines)
    return comment + yaml.safe_dump(imported.settings, sort_keys=False)


def arena_settings(imported: ImportedRobot) -> list[str]:
    """Return settings of the scenario smoke with an arena of the robot's size and a start on its line.

    None is needed where the robot has nearly the size for which the shipped arena was made.
    """
    scale = imported.settings["scale"]
    if abs(scale - 1.0) < SAME_SIZE:
        return []
    start = f"{{x_m: {START_M[0] * scale:.4g}, y_m: {START_M[1] * scale:.4g}, yaw_deg: -90}}"
    return [f"arena={{extends: symolo, scale: {scale:g}}}", f"routes=[{{name: CW, start: {start}, runs: 1}}]"]


def _items(sentences: list[str]) -> list[str]:
    # A line break in a name of the URDF would end the comment.
    return [f"- {' '.join(sentence.split())}" for sentence in sentences]
