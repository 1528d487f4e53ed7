"""The video of runs, one after another."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate

from symolo.core.errors import InputError
from symolo.core.progress import StageReport
from symolo.playback.from_run import playback_of
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.report.statistics.run_facts import fresh
from symolo.report.statistics.spread import spread
from symolo.video.canvas import Pixels
from symolo.video.encoders import Film
from symolo.video.frames import RunFrames, times_s

_PAUSE_S = 0.5
"""How long the last frame of each run stays."""
_SHAPE = Fraction(9, 16)


@dataclass(frozen=True)
class VideoSettings:
    """Size, rate and speed of a video, and how many runs it shows."""

    width_px: int
    """Width of the frames; the height is 9/16 of it, both rounded to even numbers, as H.264 demands."""
    fps: Fraction
    speed: float
    """Seconds of a run per second of the video."""
    max_runs: int
    """More runs are left out, evenly spread."""


@dataclass(frozen=True)
class _Scene:
    """One run in the video."""

    run: Run
    title: str
    times_s: tuple[float, ...]
    """Time of each frame."""


class Video:
    """The frames of a video, in the order of time."""

    def __init__(self, data: Dataset, settings: VideoSettings) -> None:
        """Plan the frames; images are read when a frame shows them.

        Raises:
            InputError: A file of a run is missing or damaged.
        """
        name = data.title
        self.settings = settings
        shown = spread(data.runs, settings.max_runs)
        self._scenes = [_scene(run, name, settings, data.failures.get(run.name, "")) for run in shown]
        self._ends = list(accumulate(len(scene.times_s) for scene in self._scenes))
        self._drawn: tuple[int, RunFrames] | None = None

    @property
    def runs(self) -> int:
        return len(self._scenes)

    @property
    def duration_s(self) -> float:
        return float(self._ends[-1] / self.settings.fps)

    def film(self, stage: StageReport | None = None) -> Film:
        """Return the frames, which report how many are drawn."""

        def frame(index: int) -> Pixels:
            if stage is not None:
                stage.update("all", index + 1)
            return self._frame(index)

        return Film(self._ends[-1], self.settings.fps, frame)

    def check_length(self, max_frames: int) -> None:
        """Raise InputError for a video with too many frames."""
        if self._ends[-1] > max_frames:
            raise InputError(
                "the video would have too many frames",
                got=self._ends[-1],
                allowed=f"up to {max_frames} in this format",
                cure="choose fewer runs with --runs, a larger --speed or a smaller --fps, or write .mp4",
            )

    def _frame(self, index: int) -> Pixels:
        number = bisect_right(self._ends, index)
        scene = self._scenes[number]
        if self._drawn is None or self._drawn[0] != number:  # one run at a time is in memory
            width_px = self.settings.width_px // 2 * 2
            height_px = round(width_px * _SHAPE / 2) * 2
            self._drawn = number, RunFrames(playback_of(fresh(scene.run)), scene.title, width_px, height_px)
        return self._drawn[1].at(scene.times_s[index - self._ends[number]])


def _scene(run: Run, name: str, settings: VideoSettings, failure: str) -> _Scene:
    title = f"{name}: {run.name}" if name != run.name else name
    times = times_s(fresh(run).t_s, float(settings.fps), settings.speed)
    pause: Sequence[float] = [times[-1]] * round(_PAUSE_S * settings.fps)
    return _Scene(run, f"{title}, failed: {failure}" if failure else title, (*times, *pause))
