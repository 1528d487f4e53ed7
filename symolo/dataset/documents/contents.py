"""What a dataset consists of and how its parts came about; every document that states this takes it from here."""

from collections.abc import Iterator
from dataclasses import dataclass

from symolo.core.progress import plural
from symolo.dataset.documents.metadata import Metadata, RunRecord

LAYOUT = "the layout of SyMoLo (Synthetic Dataset for Mobile Robots Localization Algorithms)"


@dataclass(frozen=True)
class Contents:
    """Origin of the trajectories and of the images of a dataset."""

    simulated_runs: int
    """Number of runs whose trajectory was simulated."""
    recorded_runs: int
    """Number of runs whose trajectory is that of a log of another program."""
    rendered_images: int
    logged_images: int
    """Number of images that are those of a log."""
    render_devices: tuple[str, ...]
    """Names in Cycles of the devices that rendered the images; empty if no image is rendered."""
    has_origins: bool
    """Whether trajectories come from a log or from another release, so that no scenario simulates them again."""

    @classmethod
    def from_metadata(cls, metadata: Metadata) -> "Contents":
        runs = metadata.runs
        logged = sum(_logged_images(run) for run in runs)
        images = sum(run.images + sum(camera.images for camera in run.cameras.values()) for run in runs)
        return cls(
            simulated_runs=sum(not run.is_imported for run in runs),
            recorded_runs=sum(run.is_imported for run in runs),
            rendered_images=images - logged,
            logged_images=logged,
            render_devices=tuple(sorted({device for run in runs for device in _devices(run)})),
            has_origins=any(run.origin is not None for run in runs),
        )

    @property
    def is_synthetic(self) -> bool:
        """Whether all of it was computed."""
        return not self.recorded_runs

    @property
    def kind(self) -> str:
        """Noun phrase with its article."""
        if self.is_synthetic:
            return "A synthetic dataset"
        return f"A dataset of recorded {'and simulated ' if self.simulated_runs else ''}trajectories"

    @property
    def how_made(self) -> str:
        """Sentence on motion and images."""
        motion = "The motion is that of logs" if self.recorded_runs else "The motion is simulated with PyBullet"
        if self.recorded_runs and self.simulated_runs:
            total = self.recorded_runs + self.simulated_runs
            motion = f"The motion of {plural(self.recorded_runs, 'run')} out of {total} is that of logs, and that of "
            motion += "the others is simulated with PyBullet"
        if self.rendered_images and self.logged_images:
            images = "; some images are those of logs, and the others are path-traced with Blender Cycles"
        elif self.rendered_images:
            images = "; the images are path-traced with Blender Cycles at its poses"
        elif self.logged_images:
            images = ", and so are the images of its cameras"
        else:
            images = ", and there are no images"
        return f"{motion}{images}."

    @property
    def summary(self) -> str:
        """Sentences on what the dataset is and how it was made."""
        return f"{self.kind} in {LAYOUT}. {self.how_made}"

    @property
    def resource_type(self) -> str:
        """Short phrase for catalogues."""
        runs = "Simulated robot runs" if self.is_synthetic else "Recorded robot trajectories"
        if self.recorded_runs and self.simulated_runs:
            runs = "Recorded and simulated robot runs"
        if not self.rendered_images and not self.logged_images:
            return runs
        if self.is_synthetic:
            return f"{runs} with images"
        adjectives = [*(["rendered"] if self.rendered_images else []), *(["recorded"] if self.logged_images else [])]
        return f"{runs} with {' and '.join(adjectives)} images"

    @property
    def keywords(self) -> tuple[str, ...]:
        """Keywords of a publication whose author states none."""
        synthetic = ("synthetic data",) if self.is_synthetic else ()
        if not self.is_synthetic and self.rendered_images:
            synthetic = ("synthetic images",)
        return ("mobile robot", *synthetic, "localisation", "odometry")


def logs_of(metadata: Metadata) -> tuple[tuple[str, str, str], ...]:
    """Return name, SHA-256 and importer of each log of a dataset, each once."""
    logs = [run.origin.log for run in metadata.runs if run.origin and run.origin.log]
    return tuple(dict.fromkeys((log.file, log.sha256, log.format) for log in logs))


def sources_of(metadata: Metadata) -> tuple[tuple[str, str], ...]:
    """Return name and SHA-256 of the manifest of each release from which trajectories were taken, each once."""
    releases = [run.origin.release for run in metadata.runs if run.origin and run.origin.release]
    return tuple(dict.fromkeys((release.name, release.manifest_sha256) for release in releases))


def _devices(run: RunRecord) -> Iterator[str]:
    """Yield the device of each camera whose images were rendered."""
    for camera in (run, *run.cameras.values()):
        if camera.images and camera.render_device:
            yield camera.render_device


def _logged_images(run: RunRecord) -> int:
    """Return the number of images of a run that no device rendered."""
    logged = sum(camera.images for camera in run.cameras.values() if not camera.render_device)
    return logged + (run.images if not run.render_device else 0)
