"""Floors, walls and lines: their look, and their effect on the readings of the range sensors."""

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
    "paint": ("paint", "`look.line=paint`; its edges bleed; the settings are in `look.line_paint`."),
}
ABOUT = """The `surface` of a wall or obstacle decides both its look and the readings of the range sensors. Floors and
lines are part of a look. The images are from the robot's camera and show a line, a box and a wall."""


def materials() -> str:
    return page("Materials", ABOUT, [*_floors(), *_surfaces(), *_lines()])


def _floors() -> Iterator[str]:
    yield "## Floors"
    yield """These are the values of `look.floor.material`. Each floor has its own settings below `look.floor`; `dirt`
and `stains` work on all floors."""
    yield _picture("stained_floor")
    yield "    --set look.floor.material=ceramic_tile --set look.floor.stains=0.8"
    for name, make in FLOORS.items():
        yield f"### {name} floor"
        yield text(f"{about(inspect.getmodule(make))} {_result(make)}")
        if name != "image":  # it would show the user's own image
            yield _picture(f"{name}_floor")
            yield f"    --set look.floor.material={name}"
        if name == "vinyl":
            yield _picture("terrazzo_floor")
            yield "    --set look.floor.material=vinyl --set look.floor.vinyl.print=terrazzo"


def _result(make: object) -> str:
    """Return what a function returns by its docstring, as a sentence."""
    what = about(make).removeprefix("Return ")
    return what[0].upper() + what[1:]


def _surfaces() -> Iterator[str]:
    yield "## Walls and obstacles"
    yield """These are the values of `surface` of a wall or obstacle. The readings at 100 mm are those of Tables 3 and 4
of the paper. Cardboard and brick are assumed to have the readings of paper, and raw plywood those of wood; no
measurement supports this. The reflectance is that at the sensor's 940 nm."""
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
