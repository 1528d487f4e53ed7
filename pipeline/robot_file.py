"""The text of a robot file that was imported, with what was read and assumed as its comment."""

import yaml

from physics.robot.urdf_import import ImportedRobot


def robot_file_text(imported: ImportedRobot, source: str) -> str:
    """Return the YAML text of a robot file."""
    lines = [f"Imported from {source}.", "Read:", *_items(imported.read), "Assumed:", *_items(imported.assumed)]
    comment = "".join(f"# {line}\n" for line in lines)
    return comment + yaml.safe_dump(imported.settings, sort_keys=False)


def _items(sentences: list[str]) -> list[str]:
    # A line break in a name of the URDF would end the comment.
    return [f"- {' '.join(sentence.split())}" for sentence in sentences]
