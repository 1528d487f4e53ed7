"""The result of `symolo verify --json`."""

from collections.abc import Sequence

from pipeline.json_results.base import JsonPart, JsonResult
from pipeline.repair.reproduction import Reproduction
from symolo.verification.findings import Finding


class FaultPart(JsonPart):
    """A fault of the dataset, in one of its files."""

    file: str
    """Path in the dataset."""
    what: str
    """Description of the fault."""

    @classmethod
    def from_finding(cls, finding: Finding) -> "FaultPart":
        return cls(file=finding.file, what=finding.what)


class SignaturePart(JsonPart):
    """The valid signature of the dataset."""

    key: str
    """Name of the key that signed the dataset."""
    comment: str
    """Trusted comment of the signature."""


class ReproducedPart(JsonPart):
    """Result of rendering a random choice of images again (`--reproduce`)."""

    seed: int
    """Seed of the random choice of images."""
    images: int
    """Number of images that were rendered again."""
    unequal: list[FaultPart]
    """Images with other bytes, or that could not be rendered."""
    difference: str
    """Reason why equal bytes cannot be expected on this machine; empty where they can."""

    @classmethod
    def from_reproduction(cls, reproduction: Reproduction, seed: int) -> "ReproducedPart":
        unequal = [FaultPart(file=image.file, what=image.problem) for image in reproduction.unequal]
        return cls(seed=seed, images=len(reproduction.images), unequal=unequal, difference=reproduction.difference)


class VerifyResult(JsonResult):
    """The faults of a dataset."""

    command: str = "verify"
    """Name of the command."""
    folder: str
    """The folder, as it was named."""
    faults: list[FaultPart]
    """All faults; empty for a whole dataset."""
    signature: SignaturePart | None = None
    """Signature that was checked with --key; null without it, and if there are faults."""
    reproduced: ReproducedPart | None = None
    """Result of --reproduce; null without it, and if there are faults."""


def faults_of(findings: Sequence[Finding]) -> list[FaultPart]:
    """Return the faults in their order."""
    return [FaultPart.from_finding(finding) for finding in findings]
