"""The result of `symolo release --dry-run --json`."""

from collections.abc import Sequence

from pipeline.json_results.base import JsonPart, JsonResult
from pipeline.run_folder.losses import Losses
from pipeline.run_folder.status import RunStatus
from pipeline.run_folder.status_text import reasons_of


class LostPart(JsonPart):
    """Parts of the present dataset that a release with --replace would remove."""

    runs: list[str]
    """Released runs that would be removed or measured again."""
    images: int
    """Number of images that would be lost."""
    annotations: list[str]
    """Annotations that other images would lose."""
    own_sensors: list[str] = []
    """Sensors of a kind that no loaded file defines, whose readings would be lost."""
    signature: bool
    """Whether the signature would be lost."""


class ReleaseResult(JsonResult):
    """What `symolo release` would do with a scenario and an output folder; it needs --dry-run."""

    command: str = "release"
    """Name of the command."""
    folder: str
    """The output folder, as it was named."""
    up_to_date: bool
    """Whether every run is released from the present settings, no file is missing and nothing would be lost. No file
    is hashed, so it may be true although a file was changed, which the release would make again; `status --check`
    detects that."""
    would_do: dict[str, int]
    """Number of runs by what the release would do with them, and why."""
    would_keep: list[str]
    """Runs that are released from the present settings and miss no file."""
    would_fail: list[str]
    """Runs that have failed from the present settings, and would fail again."""
    would_lose: LostPart
    """What the folder would lose, which needs --replace."""

    @classmethod
    def from_status(cls, folder: str, runs: Sequence[RunStatus], losses: Losses, *, is_whole: bool) -> "ReleaseResult":
        """Return the result.

        Args:
            folder: The output folder.
            runs: The runs of the scenario.
            losses: What the folder would lose.
            is_whole: Whether the folder has its lists of checksums and all files that they name.
        """
        return cls(
            folder=folder,
            up_to_date=all(run.done for run in runs) and not losses.text and is_whole,
            would_do={reason: len(names) for reason, names in reasons_of(runs).items()},
            would_keep=[run.run for run in runs if run.done],
            would_fail=[run.run for run in runs if any(stage.has_failed for stage in run.stages)],
            would_lose=LostPart(
                runs=list(losses.runs),
                images=losses.images,
                annotations=list(losses.annotations),
                own_sensors=list(losses.own_sensors),
                signature=losses.signature,
            ),
        )
