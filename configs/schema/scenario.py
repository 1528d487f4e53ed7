"""A scenario with every name resolved, and the run specification: the same with one route and numbers only."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from configs.posterior.schema import DrawnFrom, LoadedPosterior
from configs.robot_controller import ChosenController
from configs.schema.appearance.light_paths import LightPaths
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.base import PLANNED, Fixed, FromList, Section, Slug, absent, disagreement
from configs.schema.board import Board
from configs.schema.robot import RobotConfig
from configs.schema.splits import Splits
from symolo.core.files.image_headers import MAX_DECODER_BYTES
from symolo.dataset.annotations import AnnotationName
from symolo.dataset.documents.origin import Origin
from symolo.dataset.rates import IMAGE_HZ, Rate


class StartPose(Section):
    """Pose of the robot at the start of a run."""

    x_m: float = Field(ge=-50, le=50)
    """Start of the axle's middle along x of W [m]."""
    y_m: float = Field(ge=-50, le=50)
    """Start of the axle's middle along y of W [m]."""
    yaw_deg: float = Field(ge=-360, le=360)
    """Heading at the start, counter-clockwise from +x of W."""


class Route(Section):
    """A start pose and the number of runs from it."""

    name: Slug
    """Name of the route, and of the folder of its runs."""
    start: StartPose
    """Pose in which each run begins."""
    runs: Annotated[int, PLANNED] = Field(default=1, ge=1, le=100_000)
    """Number of runs, each with draws of its own."""
    arena: ArenaConfig | None = Field(default_factory=absent, exclude_if=lambda arena: arena is None)
    """Arena of this route in place of that of the scenario: the name of a shipped one, the path of a YAML file, or its
    settings here."""


class Stop(Section):
    """When a run ends. A lap that is not finished within the time limit fails the run."""

    lap: Annotated[bool, PLANNED] = True
    """Whether a run ends when the robot is back at its start; if not, it ends at the time limit."""
    time_limit_s: Annotated[float, PLANNED] = Field(default=90.0, ge=0.1, le=36_000)
    """Longest duration of a run [s]."""


MAX_PHYSICS_HZ = 100_000
"""Largest rate of the physics."""
MIN_CAMERA_HZ = 0.001
"""Smallest rate of a camera that takes images."""


class Rates(Section):
    """Rates of simulation, control and camera.

    A period of the control is a whole number of periods of the wheel loop, and this one of the physics.
    """

    physics_hz: Annotated[int, PLANNED] = Field(default=1000, ge=50, le=MAX_PHYSICS_HZ)
    """Rate of PyBullet's steps."""
    wheel_loop_hz: Annotated[int, PLANNED] = Field(default=100, ge=1, le=100_000)
    """Rate of the controllers of the wheel speeds."""
    control_hz: Annotated[int, PLANNED] = Field(default=20, ge=1, le=1000)
    """Rate of the controller and of the rows of data.csv."""
    camera_hz: Annotated[Rate, PLANNED] = Field(default=IMAGE_HZ, ge=0, le=1000)
    """Rate of the images, of any size. If it does not divide control_hz, images are also taken between the rows of
    data.csv. With 0, there are none."""

    @model_validator(mode="after")
    def _images_within_hours(self) -> "Rates":
        if 0 < self.camera_hz < MIN_CAMERA_HZ:
            raise disagreement("camera_hz", self.camera_hz, f"at least {MIN_CAMERA_HZ}, or 0 for no images")
        return self

    @model_validator(mode="after")
    def _whole_multiples(self) -> "Rates":
        names = ("physics_hz", "wheel_loop_hz", "control_hz")
        for fast, slow in pairwise(names):
            fast_hz, slow_hz = getattr(self, fast), getattr(self, slow)
            if fast_hz % slow_hz:
                raise disagreement(slow, slow_hz, f"a whole fraction of {fast}, which is {fast_hz}")
        return self


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise disagreement("", ", ".join(twice) + " twice", "each annotation once")
    return names


RenderQuality = Literal["draft", "standard", "high", "reference"]
"""`blender_scenes.render.sampling` defines each."""
RenderDevice = Literal["auto", "cpu", "gpu"]
RenderMethod = Literal["auto", "full", "hybrid"]
"""`blender_scenes.render.sampling` says which of the two `auto` chooses."""
_COLOURS_OF_16_BITS: tuple[AnnotationName, ...] = ("normals", "flow")
"""Annotations that need much memory to decode."""
_HYBRID_QUALITIES: tuple[RenderQuality, ...] = ("draft", "standard")


def _is_auto(method: RenderMethod) -> bool:
    """Return whether a specification omits the method, so that it has the same bytes as those without a method."""
    return method == "auto"


def _is_automatic(paths: LightPaths) -> bool:
    """Return whether a specification omits the light paths."""
    return paths == LightPaths()


class Render(Section):
    """Size, quality and annotations of the images."""

    width_px: Annotated[int, PLANNED] = Field(default=640, ge=16, le=8192)
    """Width of the images [px]."""
    height_px: Annotated[int, PLANNED] = Field(default=480, ge=16, le=8192)
    """Height of the images [px]."""
    quality: RenderQuality = "standard"
    """Accuracy of the image: `standard` aims at errors no larger than those of JPEG, `draft` is for a quick look."""
    method: RenderMethod = Field(default="auto", exclude_if=_is_auto)
    """`full` traces all pixels of every image. `hybrid` combines maps of the floor with light of few samples: faster,
    with larger errors under some looks. With `auto`, each long run of `standard` quality chooses for itself."""
    samples: int | None = Field(default=None, ge=1, le=65_536)
    """Light paths per pixel, instead of those of the quality."""
    device: Annotated[RenderDevice, Fixed("it belongs to the machine, for the whole command")] = "cpu"
    """Device: `auto` takes a graphics card if Cycles lists one. Only `cpu` gives the same bytes on all machines whose
    processors are of one class."""
    denoise: bool = True
    """Whether images are denoised; off only for many samples, or to measure noise."""
    light_paths: LightPaths = Field(default=LightPaths(), exclude_if=_is_automatic)
    jpeg_quality: int = Field(default=92, ge=1, le=100)
    """Quality of the JPEG files; 100 is the best."""
    annotations: Annotated[
        tuple[Annotated[AnnotationName, PLANNED], ...], FromList, AfterValidator(_each_once), PLANNED
    ] = ()
    """Exact annotations of each image, in separate files; the images do not depend on them."""

    @model_validator(mode="after")
    def _annotations_can_be_read(self) -> "Render":
        colours = [name for name in self.annotations if name in _COLOURS_OF_16_BITS]
        pixels = MAX_DECODER_BYTES // 12  # three colours of two bytes, twice
        if colours and self.width_px * self.height_px > pixels:
            allowed = f"neither normals nor flow for images of more than {pixels // 1_000_000} million pixels"
            raise disagreement("annotations", ", ".join(colours), allowed)
        return self

    @model_validator(mode="after")
    def _hybrid_images_are_denoised(self) -> "Render":
        if self.method == "hybrid":
            if self.quality not in _HYBRID_QUALITIES:
                raise disagreement(
                    "quality", self.quality, f"{' or '.join(_HYBRID_QUALITIES)} where render.method is hybrid"
                )
            if self.samples is not None:
                raise disagreement("samples", self.samples, "none with render.method hybrid; take another quality")
            if not self.denoise:
                raise disagreement("denoise", "false", "true with render.method hybrid")
        return self


class Scenario(Section):
    """A dataset to make: routes, arena, robot and look."""

    name: Slug
    """Name of the scenario, and of the dataset."""
    description: str = ""
    """Description for people; the dataset's README shows it."""
    seed: Annotated[int, PLANNED] = Field(default=1, ge=0, le=2**63 - 1)
    """Seed of all draws; the same scenario and seed give the same bytes."""
    licence: str = "CC-BY-4.0"
    """Licence of the dataset, as an SPDX identifier."""
    routes: Annotated[tuple[Route, ...], FromList, Field(min_length=1)]
    """Routes that the robot drives."""
    stop: Stop = Stop()
    rates: Rates = Rates()
    render: Render = Render()
    arena: ArenaConfig
    """Arena: the name of a shipped one, the path of a YAML file, or its settings here."""
    robot: RobotConfig
    """Robot: the name of a shipped one, the path of a YAML file, or its settings here."""
    like: LoadedPosterior | None = Field(default_factory=absent, exclude_if=lambda like: like is None)
    """Posterior of a diagnosis, from which the robot of each run is drawn: the folder of the diagnosis, or its
    posterior.yaml."""
    board: Board | None = Field(default_factory=absent, exclude_if=lambda board: board is None)
    """Board that drives the robot instead of the built-in controller."""
    controller: ChosenController | None = Field(default_factory=absent, exclude_if=lambda chosen: chosen is None)
    """Controller that drives the robot instead of the built-in one: its name, with its settings; the settings of the
    built-in one are `robot.controller`."""
    look: LookConfig
    """Look: the name of a shipped one, the path of a YAML file, or its settings here."""
    splits: Splits | None = Field(default_factory=absent, exclude_if=lambda splits: splits is None)
    """Division into training, validation and test, for exports and readers; no other data depend on it."""


class SceneSpec(Section):
    """The specification of what the images of one run show, in numbers only: `spec.json` of an imported trajectory."""

    scenario: Slug
    seed: int
    route: Slug
    run: int = Field(ge=1)
    start: StartPose
    render: Render
    arena: ArenaConfig
    robot: RobotConfig
    look: LookConfig
    origin: Origin | None = Field(default_factory=absent, exclude_if=lambda origin: origin is None)
    """Origin of the trajectory; None if it is simulated from this specification."""
    drawn: dict[str, float | int | str | bool]
    """Drawn values by field path within this specification, for example `look.sun.elevation_deg`; those of a generated
    arena by their path within its recipe, which the specification no longer has."""

    @property
    def key(self) -> str:
        """Folder of the run in a dataset, for example `CW/test_1`."""
        return f"{self.route}/test_{self.run}"

    @property
    def is_imported(self) -> bool:
        """Whether the trajectory was imported from a log."""
        return self.origin is not None and self.origin.log is not None

    @property
    def drawn_as(self) -> tuple[str, int]:
        """Route and number by which the random streams of the run are keyed: those of the run that was simulated, so
        that its trajectory with the same look and seed gives the same images under any name.
        """
        release = self.origin.release if self.origin else None
        if release is None:
            return self.route, self.run
        route, _, number = release.run.rpartition("/test_")
        return (route, int(number)) if number.isdigit() else (self.route, self.run)


class RunSpec(SceneSpec):
    """The specification of one simulated run, `spec.json`; `drawn` lists the drawn numbers by field path."""

    stop: Stop
    rates: Rates
    board: Board | None = Field(default_factory=absent, exclude_if=lambda board: board is None)
    controller: ChosenController | None = Field(default_factory=absent, exclude_if=lambda chosen: chosen is None)
    like: DrawnFrom | None = Field(default_factory=absent, exclude_if=lambda like: like is None)
    """Posterior from which the robot was drawn; None if the scenario names none."""
