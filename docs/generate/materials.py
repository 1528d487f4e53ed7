"""Floors, walls and lines: what they look like, and what the range sensors make of them."""

import inspect
from collections.abc import Iterator

from markdown import about, anchor, page, table, text  # pyright: ignore[reportAttributeAccessIssue] - ours, in this folder

from blender_scenes.materials import FLOORS
from blender_scenes.materials import SURFACES as SEEN
from physics.arena.surfaces import SURFACES as RANGED

PICTURES = "materials"
"""Made by `benchmarks/pages/material_page.py FOLDER --each docs/reference/materials`."""
LINES = {
    "linoleum_floor": ("tape", "`look.line=tape`, the default; wear, wrinkles, lifted edges and gloss in `look.tape`."),
    "glossy_tape": ("glossy tape", "`look.tape={roughness: 0.2, wear: 0.8, wrinkles: 0.8, lift_m: 0.0006}`."),
    "streaked_tape": ("streaked tape", "`look.tape={roughness: 0.2, streaks: 0.8}`, seen from above."),
    "paint": ("paint", "`look.line=paint`; its edges bleed, settings are in `look.line_paint`."),
}
ABOUT = """A wall's `surface` decides what it looks like and what the range sensors read at it alike; floors and lines
are part of a look. The pictures are the robot camera's, of a line, a box and a wall."""


def materials() -> str:
    return page("Materials", ABOUT, [*_floors(), *_surfaces(), *_lines()])


def _floors() -> Iterator[str]:
    yield "## Floors"
    yield "`look.floor.material`; each has settings of its own below `look.floor`; `dirt` and `stains` lie on any."
    yield _picture("stained_floor")
    yield "    --set look.floor.material=ceramic_tile --set look.floor.stains=0.8"
    for name, make in FLOORS.items():
        yield f"### {name} floor"
        yield text(f"{about(inspect.getmodule(make))} {about(make)}")
        if name != "image":  # a picture of the user's own
            yield _picture(f"{name}_floor")
            yield f"    --set look.floor.material={name}"
        if name == "vinyl":
            yield _picture("terrazzo_floor")
            yield "    --set look.floor.material=vinyl --set look.floor.vinyl.print=terrazzo"


def _surfaces() -> Iterator[str]:
    yield "## Walls and obstacles"
    yield """`surface` of a wall or obstacle. Readings at 100 mm: paper Tables 3 and 4; cardboard and brick read as
paper, raw plywood as wood, which no measurement backs. Reflectance is at the sensor's 940 nm."""
    yield table(("surface", "mean at 100 mm [mm]", "sd [mm]", "reflectance"), _readings())
    for name in SEEN:
        yield f"### {name} wall"
        yield _picture(f"{name}_wall")


def _readings() -> Iterator[tuple[str, ...]]:
    for name, one in RANGED.items():
        numbers = (one.mean_at_100_mm_mm, one.sd_at_100_mm_mm, one.reflectance)
        yield f"[{name}]({anchor(f'{name} wall')})", *(f"{number:g}" for number in numbers)


def _lines() -> Iterator[str]:
    yield "## Lines"
    for file, (name, how) in LINES.items():
        yield f"### {name}"
        yield text(how)
        yield _picture(file)


def _picture(name: str) -> str:
    return f"![{name.replace('_', ' ')}]({PICTURES}/{name}.jpg)"
