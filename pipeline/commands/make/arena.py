"""Commands for arenas: `symolo arena import`."""

import re
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import absent_file_check, checked_input, read_input
from symolo.core.files.plain_files import FileKind

HELP = "Import an arena from a drawing."


def import_(
    drawing: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", callback=checked_input, help="SVG drawing, or PNG or JPEG image of a floor plan."
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="ARENA.yaml", callback=absent_file_check(".yaml"), help="Arena file to write."),
    ],
    width_m: Annotated[
        float | None,
        typer.Option(min=0.05, max=100.0, metavar="M", help="Width of the whole drawing; an SVG may state its own."),
    ] = None,
    height_m: Annotated[float, typer.Option(min=0.01, max=3.0, metavar="M", help="Height of the walls.")] = 0.15,
    thickness_m: Annotated[
        float, typer.Option(min=0.001, max=0.5, metavar="M", help="Thickness of the walls behind their faces.")
    ] = 0.01,
) -> None:
    """Make an arena file from an SVG drawing or from the image of a floor plan.

    Example: symolo arena import plan.png --width-m 2.4 --out plan.yaml

    In an SVG drawing, groups, layers or elements are named after what they are: line, wall, room, pillar, obstacle. In
    an image, everything that is dark is wall. The middle of the drawing becomes the origin of the arena.
    """
    from configs.arena_import.drawing import arena_file_text
    from configs.arena_import.floor_plan import drawing_from_image
    from configs.arena_import.svg import drawing_from_svg
    from configs.loader import section_of
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import plural

    data = read_input(drawing, FileKind.IMAGE)
    is_svg = drawing.suffix.lower() == ".svg" or b"<svg" in data[:2000]
    read = drawing_from_svg if is_svg else drawing_from_image
    drawn = read(data, str(drawing), width_m).moved_to_middle()
    name = re.sub(r"[^A-Za-z0-9_-]", "_", out.stem)[:64]
    arena = drawn.arena(name, height_m, thickness_m)
    section_of("arena", arena, f"{drawing}, imported")
    parts = {
        "wall": drawn.wall_count(),
        "room": len(drawn.rooms),
        "pillar": len(drawn.pillars),
        "obstacle": len(drawn.obstacles),
    }
    counted = [plural(count, what) for what, count in parts.items() if count]
    if drawn.line:
        counted.append(f"a line of {plural(len(drawn.line), 'piece')}")
    summary = ", ".join(counted)
    ignored = sorted({f"not used: {what}" for what in drawn.ignored})
    write_file(out, arena_file_text(arena, drawing.name, [summary, *ignored]).encode())
    for line in (summary, *ignored):
        typer.echo(line)
    typer.echo(f"{out}: use it with a start of its own: arena: {out}")


COMMANDS = (import_,)
