"""Origin of the trajectory of a run, if its dataset did not simulate it."""

from pydantic import BaseModel, ConfigDict, Field


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class LogOrigin(_Part):
    """A log of another program, from which a trajectory was imported."""

    file: str
    """Name of the file or folder, without the folders above it."""
    sha256: str
    """SHA-256 of the file; of a folder, of its files in the order of their names."""
    format: str
    """Name of the importer that read it, such as `tum`."""
    quantities: dict[str, str] = Field(default_factory=dict)
    """Source of each quantity in the log, such as a column with its unit or a topic."""
    changes: tuple[str, ...] = ()
    """Changes of the data except those of units, in one sentence each, such as a shift of the times."""


class ReleaseOrigin(_Part):
    """The release in which a trajectory was published first."""

    name: str
    manifest_sha256: str
    """SHA-256 of its manifest-sha256.txt, which identifies every byte of it; empty if it was not a whole release."""
    run: str
    """Run of the release, such as `CW/test_1`."""


class Origin(_Part):
    """Log and release of a trajectory; at least one of them is known."""

    log: LogOrigin | None = Field(default=None, exclude_if=lambda log: log is None)
    release: ReleaseOrigin | None = Field(default=None, exclude_if=lambda release: release is None)

    @property
    def text(self) -> str:
        """Origin in a few words, for people."""
        parts = []
        if self.log:
            parts.append(f"imported from {self.log.file} ({self.log.format})")
        if self.release:
            parts.append(f"taken from {self.release.run} of {self.release.name}")
        return ", ".join(parts)
