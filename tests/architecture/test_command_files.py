"""The code of a command is found by the name of the command."""

from pathlib import Path

import pytest

from pipeline.cli import PANELS

FOLDERS = Path(__file__).parents[2] / "pipeline/commands"
COMMANDS = [command for commands in PANELS.values() for command in commands]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.__name__)
def test_a_command_is_in_a_file_of_its_name(command):
    *_, folder, file = command.__module__.split(".")
    assert file == command.__name__
    assert (FOLDERS / folder / f"{file}.py").is_file()


def test_each_file_in_a_folder_of_commands_has_a_command_or_a_group():
    files = {path.stem for path in FOLDERS.glob("*/*.py")} - {"__init__"}
    groups = {path.stem for path in FOLDERS.glob("*/*.py") if "\nCOMMANDS = (" in path.read_text()}
    assert groups == {"arena", "case", "effect", "look", "robot", "sensor", "validate"}
    assert files == groups | {command.__name__ for command in COMMANDS}
