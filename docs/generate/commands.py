"""Commands, arguments and options, with the texts of `--help`."""

from collections.abc import Iterator
from enum import Enum
from typing import Any

from markdown_text import page, table, text

from pipeline.cli import command_line

ABOUT = """This page contains the text of `symolo COMMAND --help` for every command. The page [commands](../commands.md)
is an overview with examples and exit codes."""


def commands() -> str:
    return page("Commands", ABOUT, (part for name, one in _all(command_line()) for part in _section(name, one)))


def _all(group: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from _all(command, f"{before}{name} ")
        else:
            yield before + name, command


def _section(name: str, command: Any) -> Iterator[str]:
    yield f"## {name}"
    for paragraph in command.help.split("\n\n"):
        caption, example, arguments = " ".join(paragraph.split()).partition(": symolo ")
        if not example:
            yield text(paragraph)
            continue
        if caption != "Example":
            yield text(f"{caption}:")
        yield f"    symolo {arguments}"
    rows = [_row(parameter) for parameter in command.params]
    if rows:
        yield table(("argument or option", "value", "default", "meaning"), rows)


def _row(parameter: Any) -> tuple[str, str, str, str]:
    is_argument = not parameter.opts[0].startswith("-")
    name = parameter.metavar if is_argument else ", ".join([*parameter.opts, *parameter.secondary_opts])
    default = "required" if parameter.required else _shown(parameter.default)
    return f"`{name}`", text(_value(parameter)), default, text(parameter.help or "")


def _value(parameter: Any) -> str:
    kind = parameter.type_descriptor.annotation
    low, high = getattr(parameter, "min", None), getattr(parameter, "max", None)
    bounds = "" if low is None else f", {low:g}{' or more' if high is None else f' ... {high:g}'}"
    if isinstance(kind, type) and issubclass(kind, Enum):
        return ", ".join(str(member.value) for member in kind)
    if kind is bool:
        return ""
    return (parameter.metavar or getattr(kind, "__name__", "")) + bounds


def _shown(default: object) -> str:
    """Return the default as text, which is empty for a flag that is off and for an empty list."""
    value = default.value if isinstance(default, Enum) else default
    return f"`{value}`" if value or (value == 0 and value is not False) else ""
