"""The images of a preview: runs as the scenario draws them, looks in turn, places spread over the path."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from blender_scenes.render.devices import device_for
from blender_scenes.render.job import FramePose, RenderJob
from configs.draw import draw_run
from configs.loader import LoadedScenario, load_scenario
from configs.overrides import replaced_section
from configs.references import locate
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import RunSpec
from pipeline.preview.path import PreviewPath
from pipeline.run_warnings.angles import settings_in_radians
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import Appearance
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError, nearest
from symolo.core.geometry.robot_path import RobotPath
from symolo.core.random_streams import stream

_DRAFT = ("render.quality=draft", "render.method=full")
"""Settings of a preview, which `--set` overrides. The maps of hybrid rendering would serve a single image each."""
_GOLDEN = 0.618033988749895
"""Steps of this share of the path are evenly spread, whatever their number (Weyl's sequence)."""


@dataclass(frozen=True)
class PreviewImage:
    """One image of a preview."""

    number: int
    """Number of the image, from 1."""
    name: str
    lines: tuple[str, ...]
    """Lines of its caption."""
    frame: FramePose
    appearance: Appearance
    assets: Mapping[str, Path]
    """Paths of the user's files of the look, by SHA-256."""
    further_cameras: tuple[str, ...] = ()
    """Names of the cameras of this run that the image does not show, except that of data.csv."""
    suspicions: tuple[str, ...] = ()
    """Angles that are probably in radians, in one sentence each."""

    def job(self) -> RenderJob:
        """Return the job, which is built when it is needed because it has some megabytes."""
        frame = self.frame
        # The robot stands still during the exposure; obstacles move on.
        pose = np.array([[frame.x_m, frame.y_m, frame.yaw_rad]])
        path = RobotPath(np.array([frame.t_s]), pose, np.zeros((1, 2)))
        return self.appearance.job(Arena.from_config(self.appearance.arena), [frame], path)


def on_device(views: Sequence[PreviewImage]) -> list[PreviewImage]:
    """Return the same images with the device that the settings of the first one name.

    Raises:
        EnvironmentLacking: They name a graphics card, and there is none.
    """
    device = device_for(views[0].appearance.render.device)
    return [replace(view, appearance=replace(view.appearance, device=device)) for view in views]


def views(
    scenario: str, overrides: Sequence[str], looks: Sequence[str], count: int, width_px: int, *, camera: str = ""
) -> Iterator[PreviewImage]:
    """Yield the images 1 to `count`; each is the same whatever the count is.

    Every image shows another run: routes take turns, runs count from 1, beyond those of the scenario as if there were
    more. With several looks each run is shown under all of them, from the same place, before the next one is. The
    camera is that of data.csv, or a further one by its name.

    Raises:
        InputError: The scenario or a look cannot be used, a run's values make an impossible world, or there is no such
            camera.
    """
    for text in overrides if looks else ():
        if replaced_section(text) == "look":
            raise InputError("--set", got=text, cure="name it with --look")
    for look in looks:
        locate("look", look, folder=Path(), what="--look")
    choices = [(f"look={look}",) for look in looks] or [()]
    loaded = [load_scenario(scenario, (*_DRAFT, *choice, *overrides)) for choice in choices]
    for index in range(count):
        run, look = divmod(index, len(loaded))
        yield _view(loaded[look], index + 1, run, width_px, camera)


def _view(loaded: LoadedScenario, number: int, index: int, width_px: int, camera: str) -> PreviewImage:
    earlier, route = divmod(index, len(loaded.routes))
    spec = draw_run(loaded, loaded.routes[route].name, earlier + 1)
    frame = _frame(spec, number, index)
    cameras = {one.name: one for one in cameras_of(spec)}
    further = tuple(name for name in cameras if name not in {"", camera})
    if camera and camera not in cameras:
        allowed = f"one of {', '.join(further)}" if further else "nothing: the robot has no further camera"
        raise InputError("--camera", got=camera, allowed=allowed, nearest=nearest(camera, further))
    shown_spec = cameras[camera].spec if camera else spec
    look = Appearance.from_spec(shown_spec)
    height_px = max(1, round(width_px * look.render.height_px / look.render.width_px))
    render = look.render.model_copy(update={"width_px": width_px, "height_px": height_px})
    camera_words = f", camera {camera}" if camera else ""
    lines = (f"{spec.key}, seed {spec.seed}, {spec.look.name}{camera_words}", *_words(spec.look))
    name, shown = f"{number} ({spec.key}, {spec.look.name})", replace(look, render=render)
    suspicions = tuple(suspicion.text for suspicion in settings_in_radians(spec))
    return PreviewImage(number, name, lines, frame, shown, loaded.assets, further, suspicions)


def _frame(spec: RunSpec, number: int, index: int) -> FramePose:
    share = (stream(spec.seed, "preview", "way").random() + index * _GOLDEN) % 1.0
    t_s = stream(spec.seed, spec.route, spec.run, "preview", "t_s").uniform(0.0, spec.stop.time_limit_s)
    x_m, y_m, yaw_rad = PreviewPath.from_spec(spec, Arena.from_config(spec.arena)).place(share, t_s)
    return FramePose(number, t_s, x_m, y_m, yaw_rad)


def _words(look: LookConfig) -> tuple[str, str, str]:
    """Return a line about the floor of a look, one about its daylight and one about its lamps."""
    daylight, lamps = [], []
    if look.sun.illuminance_klx > 0:
        daylight.append(f"sun {look.sun.illuminance_klx:.1f} klx at {look.sun.elevation_deg:.0f} deg")
    if look.lamps.flux_klm > 0 and look.lamps.rows > 0:
        lamps.append(f"ceiling lamps {look.lamps.color_temperature_K:.0f} K")
    if look.desk_lamps.count > 0 and look.desk_lamps.flux_klm > 0:
        lamps.append(f"desk lamps {look.desk_lamps.color_temperature_K:.0f} K")
    if look.sky.luminance_kcd_m2 > 0:
        daylight.append(f"sky {look.sky.luminance_kcd_m2:.2g} kcd/m2")
    floor = f"{look.floor.material}, dirt {100 * look.floor.dirt:.0f} %, {look.line}"
    return floor, ", ".join(daylight) or "no daylight", ", ".join(lamps) or "no lamps"
