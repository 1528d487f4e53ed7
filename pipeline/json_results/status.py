"""The result of `symolo status --json`."""

from pipeline.json_results.base import JsonPart, JsonResult
from pipeline.run_folder.status import FolderStatus, ImageCost, RunStatus
from pipeline.run_folder.status_text import reasons_of


class StagePart(JsonPart):
    """State of one stage of a run."""

    stage: str
    """simulate, render, annotate or release."""
    text: str
    """What is done, or what failed."""
    again: str
    """Reason why the next release does this stage; empty if it is done."""


class RunPart(JsonPart):
    """State of one run."""

    run: str
    """Name of the run, such as CW/test_1."""
    done: bool
    """Whether it is released and up to date."""
    stages: list[StagePart]
    """Its stages in their order."""
    warning: str
    """Warning that its frames were made on several classes of processor; empty if they were not."""

    @classmethod
    def from_status(cls, run: RunStatus, warning: str) -> "RunPart":
        stages = [StagePart(stage=stage.stage, text=stage.text, again=stage.again) for stage in run.stages]
        return cls(run=run.run, done=run.done, stages=stages, warning=warning)


class CostPart(JsonPart):
    """Time that the images of the folder took, compared with the plan."""

    images: int
    """Number of images that were rendered."""
    core_s: float
    """Time of one core that all images took, without the starts of Blender."""
    planned_core_s: float | None
    """Planned time of one core for one image; null without a scenario."""

    @classmethod
    def from_cost(cls, cost: ImageCost) -> "CostPart":
        return cls(images=cost.images, core_s=cost.core_s, planned_core_s=cost.planned_core_s)


class StatusResult(JsonResult):
    """What an output folder contains, and what the next release would do."""

    command: str = "status"
    """Name of the command."""
    folder: str
    """The folder, as it was named."""
    working: bool
    """Whether another command works in the folder."""
    process: int | None
    """Number of its process; null where it is not known."""
    has_stages: bool
    """Whether there is a .stages; without it, the next release makes everything again."""
    runs: list[RunPart]
    """Runs of the scenario, or those in the folder."""
    next_release: dict[str, int]
    """Number of runs by what the next release would do with them, and why. Changed files are detected with --check
    only."""
    release_finished: bool
    """Whether the lists of checksums are there."""
    faults: int | None
    """Number of faults that `verify` lists; null without --check, and if the release is not finished."""
    cost: CostPart | None
    """Null where no image was rendered."""
    disk_bytes: dict[str, int]
    """Size of each part of the folder."""

    @classmethod
    def from_status(cls, folder: str, status: FolderStatus, exit_code: int) -> "StatusResult":
        return cls(
            exit_code=exit_code,
            folder=folder,
            working=status.worker.is_working,
            process=status.worker.process or None,
            has_stages=status.worker.has_stages,
            runs=[RunPart.from_status(run, status.mixed.get(run.run, "")) for run in status.runs],
            next_release={reason: len(runs) for reason, runs in reasons_of(status.runs).items()},
            release_finished=not status.release.missing_lists,
            faults=status.release.faults,
            cost=CostPart.from_cost(status.cost) if status.cost else None,
            disk_bytes=dict(status.disk_bytes),
        )
