"""Images for existing trajectories, of symolo or from logs of other programs, as a release; nothing is simulated."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from blender_scenes.render.devices import DeviceKind, device_for
from configs.checks.scenario import check_cameras
from configs.draw import draw_arena, draw_look, draw_render
from configs.loader import LoadedSection, load_scenario, load_section, section_of
from configs.overrides import replaced_section
from configs.robot_sensors import RobotSensors
from configs.schema.arena import ArenaConfig
from configs.schema.scenario import Render, RunSpec, SceneSpec
from pipeline.executors.base import Executor
from pipeline.importing.imported_runs import DEFAULT_SCENARIO
from pipeline.planning.plan import BYTES_PER_ROW, image_bytes, render_core_s
from pipeline.rerendering.camera_response import response_warnings
from pipeline.rerendering.image_rows import with_images
from pipeline.rerendering.robot_section import robot_of_images
from pipeline.rerendering.room_check import check_on_the_floor
from pipeline.rerendering.sources import Sources
from pipeline.run_folder.losses import check_losses, protected_runs
from pipeline.run_folder.output import check_out
from pipeline.run_folder.user_image_copies import copy_user_images
from pipeline.run_folder.workspace import Workspace
from pipeline.run_warnings.camera_inside import inside_warnings
from pipeline.run_warnings.imported_trajectory import Where
from pipeline.stages.assemble import assemble
from pipeline.stages.cameras import cameras_of, logged_cameras
from pipeline.stages.render_specs import render_specs
from pipeline.stages.run_tables import ExternalRun, write_external_run
from symolo.arena.geometry import Arena
from symolo.core.errors import FaultList, InputError
from symolo.core.files.disk_space import check_disk
from symolo.core.files.file_hashes import canonical_json
from symolo.core.progress import Report
from symolo.core.random_streams import stream
from symolo.dataset.documents.metadata import FailedRun, read_metadata
from symolo.dataset.documents.splits_record import SPLIT_NAMES
from symolo.dataset.folder_kind import Kind
from symolo.dataset.layout import CAMERAS, MAX_NAME
from symolo.dataset.tables.sensor_tables import ListedSensor

SECTIONS = ("look", "render", "arena", "robot")


@dataclass(frozen=True)
class RerenderRequest:
    """The options of `symolo rerender` that decide what is rendered."""

    looks: tuple[str, ...]
    draws: int = 1
    """Number of draws of each look."""
    arena: str | None = None
    robot: str | None = None
    camera_hz: float | None = None
    seed: int | None = None
    overrides: tuple[str, ...] = ()
    option: str = "--look"
    """Option that names the looks; with `--looks`, the routes are named after the draws."""
    name: str | None = None

    def named_by(self, section: str) -> str:
        """Return the option that names this section; empty where none does."""
        named = {"look": self.option, "arena": self.arena and "--arena", "robot": self.robot and "--robot"}
        return named.get(section) or ""

    def overrides_of(self, section: str) -> tuple[str, ...]:
        """Return the overrides of one section."""
        return tuple(text for text in self.overrides if text.strip().startswith((f"{section}.", f"{section}=")))


@dataclass(frozen=True)
class Rerendering:
    """The runs of a release that is not written yet."""

    runs: tuple[ExternalRun, ...]
    """All runs under the first draw of the first look, then under the other draws."""
    tree: dict[str, Any]
    """Sections of a scenario, for metadata.json."""
    assets: Mapping[str, Path]
    """Paths of the user's files that the looks show, by SHA-256."""
    sensors: tuple[ListedSensor, ...]
    device: DeviceKind
    warnings: tuple[str, ...] = ()
    """What is suspicious about the images of the source's runs, and which of their cameras a look replaces."""


def draw_seed(seed: int, draw: int) -> int:
    """Return the seed of a look's values, stains and noise in one draw; the first draw has that of the run."""
    return seed if draw == 1 else int(stream(seed, "rerender", draw).integers(2**53))


def check_overrides(request: RerenderRequest) -> None:
    """Refuse settings on which no image depends, before anything is read.

    Raises:
        InputError: The first such setting.
    """
    for text in request.overrides:
        if text.strip().partition("=")[0].partition(".")[0] not in SECTIONS:
            raise InputError(
                "--set",
                got=text,
                allowed="fields of " + ", ".join(SECTIONS),
                cure="to change other fields, simulate again",
            )
        if option := request.named_by(replaced_section(text)):
            raise InputError("--set", got=text, cure=f"name it with {option}")


def prepare(sources: Sources, request: RerenderRequest) -> Rerendering:
    """Check everything and draw all looks; nothing is written.

    Raises:
        InputError: A look or another part of the request cannot be used, or an image would be taken outside the room.
        EnvironmentLacking: A graphics card is required and there is none.
    """
    check_overrides(request)
    looks = [load_section("look", name, request.overrides_of("look"), request.option) for name in request.looks]
    _check_each_once([str(section.tree["name"]) for section in looks])
    name = request.name or _dataset_name(sources, looks)
    scenes = [_scene(run, request, name) for run in sources.runs]
    faults, runs = FaultList(), []
    for section in looks:
        for k in range(1, request.draws + 1):
            for run, file in zip(scenes, sources.files, strict=True):
                with faults.noted():
                    runs.append(_with_look(run, file, section, k, request))
    faults.check()
    render = runs[0].spec.render
    tree = _tree(sources, request, looks, runs, name) | _splits(sources, runs)
    assets = {digest: path for section in looks for digest, path in section.assets.items()}
    warnings = tuple(
        f"{scene.spec.key}: {text}"
        for scene, run in zip(scenes, sources.runs, strict=True)
        for text in scene.outcome.suspicions[len(run.outcome.suspicions) :]
    )
    warnings += response_warnings([run.spec for run in sources.runs], [run.spec for run in runs], request.overrides)
    return Rerendering(tuple(runs), tree, assets, sources.sensors, device_for(render.device), warnings)


def check_place(
    rerendering: Rerendering,
    out: Path,
    report: Report,
    *,
    is_default: bool,
    replace: bool = False,
    dry_run: bool = False,
) -> None:
    """Refuse an output folder that cannot be used, before anything is written.

    Args:
        rerendering: The release.
        out: Its folder.
        report: Receiver of a line about a finished release that would lose something.
        is_default: Whether the user has named no folder, so that another release in it is not replaced.
        replace: Whether a finished release in it may lose something.
        dry_run: Whether nothing will be written.

    Raises:
        InputError: It is not a place for this release.
        EnvironmentLacking: The disk is too full.
    """
    check_out(out, Kind.RERENDERED)
    there = read_metadata(out)
    if is_default and there is not None and canonical_json(there.scenario) != canonical_json(rerendering.tree):
        what = "contains images of a different trajectory or a different draw of the look"
        raise InputError(what, where=str(out), cure="name a folder with --out")
    workspace, specs = Workspace(out.absolute(), Kind.RERENDERED), [run.spec for run in rerendering.runs]
    check_losses(workspace, rerendering.tree, specs, report, replace=replace, dry_run=dry_run)
    check_disk(out, sum(cost_of(run).bytes_needed for run in rerendering.runs))


def make_release(
    rerendering: Rerendering, out: Path, executor: Executor, report: Report, *, replace: bool = False
) -> list[FailedRun]:
    """Render, annotate and assemble the release in a checked folder, and return the runs that failed.

    What is there from the same inputs is not made again.
    """
    workspace = Workspace(out.absolute(), Kind.RERENDERED)
    specs = [run.spec for run in rerendering.runs]
    with workspace.locked():
        protected = protected_runs(workspace, rerendering.tree, specs, report, replace=replace)
        copy_user_images((spec.look for spec in specs), rerendering.assets, workspace.user_files)
        for run in rerendering.runs:
            write_external_run(run, workspace.simulate(run.spec.key))
        for text in rerendering.warnings:
            report.say(f"warning: {text}")
        failures = render_specs(workspace, specs, executor, rerendering.device, failures=[], report=report)
        tree, sensors = rerendering.tree, rerendering.sensors
        assemble(workspace, tree, specs, failures, report, sensors=sensors, protected=protected)
    return failures


def folder_name(sources: Sources, request: RerenderRequest) -> str:
    """Return the default name of the output folder: run, dataset or log, and looks."""
    looks = [Path(name).stem if name.endswith((".yaml", ".yml")) else name for name in request.looks]
    return "-".join((sources.title, *dict.fromkeys(looks)))


@dataclass(frozen=True)
class RerenderCost:
    """What the images of a run take, those of all cameras together."""

    images: int
    core_s: float
    """Estimated time [s] of one core."""
    bytes_needed: int
    """Estimated disk space [byte], stages included."""


def cost_of(run: ExternalRun) -> RerenderCost:
    """Return what the images of a run take."""
    total, core_s, needed = 0, 0.0, 2 * BYTES_PER_ROW * len(run.rows.t_ms)
    for camera in cameras_of(run.spec):
        render, images = camera.spec.render, int(np.count_nonzero(camera.rows(run.rows).image))
        total, core_s = total + images, core_s + render_core_s(camera, images)
        needed += image_bytes(images, images * render.width_px * render.height_px, annotated=bool(render.annotations))
    return RerenderCost(total, core_s, needed)


def _check_each_once(names: Sequence[str]) -> None:
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError("--looks", got=twice[0], allowed="each look once, and no two looks of the same name")


def _scene(run: ExternalRun, request: RerenderRequest, name: str) -> ExternalRun:
    """Return a run with the arena, the robot, the image settings and the images of the request.

    They are the same in all draws of the looks.
    """
    run = _without_logged_cameras(run)
    spec = run.spec
    arena, arena_drawn = _arena(run, request)
    robot, robot_drawn = robot_of_images(spec, request.robot, request.overrides_of("robot"), _seed(spec, request))
    render = _render(spec, request)
    run = with_images(run, request.camera_hz)
    drawn = {name: value for name, value in spec.drawn.items() if not name.startswith(("look.", "render."))}
    for section, changed in (("arena.", arena_drawn), ("robot.", robot_drawn)):
        if changed is not None:
            drawn = {name: value for name, value in drawn.items() if not name.startswith(section)} | changed
    outcome = run.outcome
    if arena_drawn is not None and not spec.is_imported and arena.name != spec.arena.name:
        text = f"the readings are those of the arena {spec.arena.name}, and the images show {arena.name}"
        outcome = outcome.model_copy(update={"suspicions": (*outcome.suspicions, text)})
    changes = {"scenario": name, "arena": arena, "robot": robot, "render": render, "drawn": drawn}
    spec = run.spec.model_copy(update=changes)
    inside = inside_warnings(spec, run.rows)
    outcome = outcome.model_copy(update={"suspicions": (*outcome.suspicions, *inside)}) if inside else outcome
    return replace(run, spec=spec, outcome=outcome)


def _without_logged_cameras(run: ExternalRun) -> ExternalRun:
    """Return a run without the cameras of its log, whose images are not rendered."""
    names = logged_cameras(run.spec)
    members = tuple(member for member in run.spec.robot.sensors if member[0] not in names)
    robot = run.spec.robot.model_copy(update={"sensors": RobotSensors(members)})
    side = {name: data for name, data in run.side.items() if not name.startswith(f"{CAMERAS}/")}
    return replace(run, spec=run.spec.model_copy(update={"robot": robot}), side=side)


def _seed(spec: SceneSpec, request: RerenderRequest) -> int:
    return spec.seed if request.seed is None else request.seed


def _arena(run: ExternalRun, request: RerenderRequest) -> tuple[ArenaConfig, dict[str, Any] | None]:
    """Return the arena with its drawn values, which are None if it is that of the run."""
    spec, overrides = run.spec, request.overrides_of("arena")
    if not request.arena and not overrides:
        return spec.arena, None
    section = (
        section_of("arena", spec.arena.model_dump(mode="json"), "arena of the run", overrides)
        if request.arena is None
        else load_section("arena", request.arena, overrides)
    )
    x_m, y_m, yaw_rad = run.rows.pose[0].tolist()
    arena, drawn = draw_arena(section, _seed(spec, request), *spec.drawn_as, start=(x_m, y_m, yaw_rad))
    return arena, dict(drawn)


def _render(spec: SceneSpec, request: RerenderRequest) -> Render:
    stored = spec.render.model_dump(mode="json", exclude_none=True)
    settings = [f"render.{name}={str(value).lower()}" for name, value in stored.items()]
    loaded = load_scenario(DEFAULT_SCENARIO, [*settings, *request.overrides_of("render")])
    return draw_render(loaded, _seed(spec, request), *spec.drawn_as)


def _with_look(
    run: ExternalRun, file: Path, section: LoadedSection, draw: int, request: RerenderRequest
) -> ExternalRun:
    """Return a run, from this file, under one draw of a look.

    Raises:
        InputError: An image would be taken outside the room, or the name of the route is too long.
    """
    spec = run.spec
    seed = draw_seed(_seed(spec, request), draw)
    look, drawn = draw_look(section, seed, *spec.drawn_as)
    route = spec.route if request.option == "--look" else f"{spec.route}-{look.name}_{draw}"
    if len(route) > MAX_NAME:
        raise InputError(
            f"route {route}", allowed=f"a name of {MAX_NAME} characters", cure="shorten the name of the look"
        )
    if spec.is_imported or request.arena or request.overrides_of("arena"):
        check_on_the_floor(run.rows, Arena.from_config(spec.arena), look, _place_in(run, file))
    changes = {
        "seed": seed,
        "route": route,
        "look": look,
        "drawn": dict(sorted({**spec.drawn, **drawn}.items())),
    }
    spec = spec.model_copy(update=changes)
    check_cameras(spec)
    return replace(run, spec=spec)


def _place_in(run: ExternalRun, file: Path) -> Where:
    """Return what names the place of a row: the line of a data.csv, or the time in another log."""
    log = run.spec.origin.log if run.spec.origin else None
    if log is None or log.format == "symolo":
        return lambda row: f"{file}:{row + 2}"
    return lambda row: f"{file}: {run.rows.t_ms[row] / 1000:.3f} s after its first pose"


def _with_new_arenas(
    routes: Sequence[Mapping[str, Any]], request: RerenderRequest, runs: Sequence[ExternalRun]
) -> Iterator[dict[str, Any]]:
    """Yield the routes of the source; of their own arenas those that still differ from that of the release."""
    arenas = {run.spec.drawn_as[0]: run.spec.arena for run in reversed(runs)}
    for route in routes:
        fields = {key: value for key, value in route.items() if key != "arena"}
        arena = arenas.get(str(route.get("name")))
        if route.get("arena") and request.arena is None and arena is not None:
            fields["arena"] = arena.model_dump(mode="json")
        yield fields


def _tree(
    sources: Sources,
    request: RerenderRequest,
    looks: Sequence[LoadedSection],
    runs: Sequence[ExternalRun],
    name: str,
) -> dict[str, Any]:
    """Return the scenario of the release: that of the source with the looks, and with what else was changed."""
    first = runs[0].spec
    tree = dict(sources.tree) or {section: getattr(first, section).model_dump(mode="json") for section in SECTIONS[2:]}
    for section in SECTIONS[2:]:
        if getattr(request, section) or request.overrides_of(section):
            tree[section] = getattr(first, section).model_dump(mode="json")
            if section == "arena" and "routes" in tree:
                tree["routes"] = [*_with_new_arenas(tree["routes"], request, runs)]
    if isinstance(first, RunSpec) and "rates" in tree:
        tree["rates"] = first.rates.model_dump(mode="json")
    for key in ("look", "looks", "splits"):
        tree.pop(key, None)
    named = {str(section.tree["name"]): section.tree for section in looks}
    about = sources.description.rstrip(".") or f"Trajectories of {sources.name}"
    return {
        **tree,
        "name": name,
        "description": f"{about}. Rendered under {', '.join(named)}, draws of each: {request.draws}.",
        "licence": sources.licence or "NOASSERTION",
        "seed": first.seed,
        "render": first.render.model_dump(mode="json"),
        **({"look": next(iter(named.values()))} if len(named) == 1 else {"looks": named}),
    }


def _splits(sources: Sources, runs: Sequence[ExternalRun]) -> dict[str, Any]:
    """Return the setting that leaves every trajectory in its split, in all its draws."""
    split_of = [sources.split_of.get(sources.runs[i % len(sources.runs)].spec.key) for i in range(len(runs))]
    listed = {
        name: [run.spec.key for run, split in zip(runs, split_of, strict=True) if split == name]
        for name in SPLIT_NAMES
        if name in split_of
    }
    return {"splits": {"runs": listed}} if listed else {}


def _dataset_name(sources: Sources, looks: Sequence[LoadedSection]) -> str:
    return "-".join((sources.name, *(str(section.tree["name"]) for section in looks)))[:MAX_NAME].rstrip("-_")
