"""Floors, walls and lines: what they look like, and what the range sensors read at them."""

import inspect
from collections.abc import Iterator

from markdown_text import about, anchor, page, table, text

from blender_scenes.materials import FLOORS
from blender_scenes.materials import SURFACES as SEEN
from physics.arena.surfaces import SURFACES as RANGED

IMAGES = "materials"
"""Made by `benchmarks/pages/material_page.py FOLDER --each docs/reference/materials`."""
LINES = {
    "linoleum_floor": (
        "tape",
        "`look.line=tape` is the default. `look.tape` has the settings of wear, wrinkles, lifted edges and gloss.",
    ),
    "glossy_tape": (
        "glossy tape",
        "This is a tape with `look.tape={roughness: 0.2, wear: 0.8, wrinkles: 0.8, lift_m: 0.0006}`.",
    ),
    "streaked_tape": (
        "streaked tape",
        "This is a tape with `look.tape={roughness: 0.2, streaks: 0.8}`, seen from above.",
    ),
    "paint": (
        "paint",
        "`look.line=paint` is a painted line, whose edges bleed. Its settings are in `look.line_paint`.",
    ),
}
ABOUT = """The `surface` of a wall determines both what it looks like and what the range sensors read at it. Floors and
lines are part of a look. The images show a line, a box and a wall, as the camera of the robot sees them."""


def materials() -> str:
    return page("Materials", ABOUT, [*_floors(), *_surfaces(), *_lines()])


def _floors() -> Iterator[str]:
    yield "## Floors"
    yield """`look.floor.material` chooses the material of the floor. Each material has its own settings below
`look.floor`. `dirt` and `stains` can be added to every material."""
    yield _image("stained_floor")
    yield "    --set look.floor.material=ceramic_tile --set look.floor.stains=0.8"
    for name, make in FLOORS.items():
        yield f"### {name} floor"
        yield text(f"{about(inspect.getmodule(make))} {about(make)}")
        if name != "image":  # an image of the user
            yield _image(f"{name}_floor")
            yield f"    --set look.floor.material={name}"
        if name == "vinyl":
            yield _image("terrazzo_floor")
            yield "    --set look.floor.material=vinyl --set look.floor.vinyl.print=terrazzo"


def _surfaces() -> Iterator[str]:
    yield "## Walls and obstacles"
    yield """`surface` chooses the surface of a wall or obstacle. The readings at 100 mm come from Tables 3 and 4 of the
article. Cardboard and brick have the values of the material paper, and raw plywood those of wood; no measurement
confirms this. The reflectance is that at 940 nm, the wavelength of the sensor."""
    yield table(("surface", "mean at 100 mm [mm]", "sd [mm]", "reflectance"), _readings())
    for name in SEEN:
        yield f"### {name} wall"
        yield _image(f"{name}_wall")


def _readings() -> Iterator[tuple[str, ...]]:
    for name, one in RANGED.items():
        numbers = (one.mean_mm_at_100_mm, one.sd_mm_at_100_mm, one.reflectance)
        yield f"[{name}]({anchor(f'{name} wall')})", *(f"{number:g}" for number in numbers)


def _lines() -> Iterator[str]:
    yield "## Lines"
    for file, (name, how) in LINES.items():
        yield f"### {name}"
        yield text(how)
        yield _image(file)


def _image(name: str) -> str:
    return f"![{name.replace('_', ' ')}]({IMAGES}/{name}.jpg)"
