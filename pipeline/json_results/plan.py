"""The result of `symolo plan --json`."""

from pipeline.json_results.base import JsonPart, JsonResult
from pipeline.planning.plan import COPIES, PlannedRun, ScenarioPlan
from pipeline.planning.price import Price


class PlannedRunPart(JsonPart):
    """Size of one run of a scenario that is planned."""

    run: str
    """Name of the run, such as CW/test_1; of a further camera with the name of the camera, such as CW/test_1 rear."""
    duration_s: float
    """Simulated time, estimated for a lap."""
    rows: int
    """Rows of data.csv."""
    images: int
    """Number of images."""
    width_px: int
    """Width of the images."""
    height_px: int
    """Height of the images."""
    quality: str
    """Setting render.quality."""
    annotated: bool
    """Whether the images have annotations."""
    bytes: int
    """Estimated disk space, stages included."""
    render_core_s: float
    """Estimated time of one core to render it, annotations included."""

    @classmethod
    def from_run(cls, run: PlannedRun) -> "PlannedRunPart":
        return cls(
            run=run.run,
            duration_s=run.duration_s,
            rows=run.rows,
            images=run.images,
            width_px=run.width_px,
            height_px=run.height_px,
            quality=run.quality,
            annotated=run.annotated,
            bytes=run.bytes_needed,
            render_core_s=round(run.render_core_s, 3),
        )


class PricePart(JsonPart):
    """Time and size of all planned runs on one device, extrapolated from a measurement."""

    device: str
    """Device that rendered: CPU, or a kind of graphics card."""
    measured_images: int
    """Number of images that were made for the measurement."""
    simulate_core_h: float
    """Hours of one core."""
    render_h: float
    """Hours of one core, or of the graphics card."""
    annotate_h: float
    """Further hours for all annotations."""
    bytes: float
    """Size without annotations."""
    annotated_bytes: float
    """Size with all annotations."""


class PlanResult(JsonResult):
    """What a scenario would make."""

    command: str = "plan"
    """Name of the command."""
    scenario: str
    """The scenario, as it was named."""
    cores: int
    """Number of cores of this machine, which the times are for."""
    images: int
    """Number of images of all runs and cameras."""
    runs: list[PlannedRunPart]
    """All runs; empty with --images, which plans no runs."""
    cameras: list[PlannedRunPart] = []
    """Images of the further cameras of the runs, without rows."""
    bytes: int
    """Disk space, stages included; estimated, or measured with --images."""
    dataset_bytes: int
    """The part of it that the dataset takes, without the stages."""
    time_s: float
    """Time on this machine to simulate and render; estimated, or measured with --images."""
    robots: str = ""
    """Diagnosis from which the robots are drawn, with its hypotheses; empty without --like."""
    beyond_measured: list[str] = []
    """Demands of the scenario that leave what this diagnosis measured."""
    warnings: list[str] = []
    """What is suspicious about starts, lines and walls, such as a yaw in radians, each with the runs it concerns."""
    price: PricePart | None = None
    """Measured cost of the images of --images; null without it."""

    @classmethod
    def from_plan(cls, scenario: str, plan: ScenarioPlan) -> "PlanResult":
        time_s = round(plan.simulation_s + plan.render_s, 3)
        return cls(
            scenario=scenario,
            cores=plan.cores,
            images=plan.images,
            runs=[PlannedRunPart.from_run(run) for run in plan.runs],
            cameras=[PlannedRunPart.from_run(camera) for camera in plan.cameras],
            bytes=plan.bytes_needed,
            dataset_bytes=plan.dataset_bytes,
            time_s=time_s,
            robots=plan.robots,
            beyond_measured=list(plan.demands),
            warnings=list(plan.warnings),
        )

    @classmethod
    def of_price(cls, scenario: str, cores: int, price: Price, images: int) -> "PlanResult":
        cost = price.cost(images)
        part = PricePart(
            device=price.device,
            measured_images=price.images,
            simulate_core_h=cost.simulate_h,
            render_h=cost.render_h,
            annotate_h=cost.annotate_h,
            bytes=cost.bare_bytes,
            annotated_bytes=cost.annotated_bytes,
        )
        return cls(
            scenario=scenario,
            cores=cores,
            images=images,
            runs=[],
            bytes=round(COPIES * cost.bare_bytes),
            dataset_bytes=round(cost.bare_bytes),
            time_s=round(price.alone_s(cost), 3),
            price=part,
        )
