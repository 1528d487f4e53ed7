"""The facts from which the documents of a publication are written."""

from dataclasses import dataclass

from symolo.dataset.documents.metadata import Metadata
from symolo.publishing.about import About
from symolo.publishing.licences import Licence, licence_of
from symolo.publishing.tables import PlannedTable


@dataclass(frozen=True)
class PackedFile:
    """A file that is already written to the publication."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Published:
    about: About
    metadata: Metadata
    tables: tuple[tuple[PlannedTable, PackedFile], ...]
    shards: tuple[PackedFile, ...]

    @property
    def name(self) -> str:
        """Name of the dataset and of the folder that the shards unpack to."""
        return self.metadata.name

    @property
    def licence(self) -> Licence:
        return licence_of(self.metadata.licence)

    @property
    def description(self) -> str:
        """Description by the user, followed by a sentence on how the dataset was made."""
        text = (self.about.description if self.about.description is not None else self.metadata.description).strip()
        if text and not text.endswith((".", "!", "?")):
            text += "."
        origin = (
            "A synthetic dataset of a small differential robot in the layout of SyMoLo (Synthetic Dataset for Mobile "
            "Robots Localization Algorithms): motion simulated with PyBullet, images path-traced with Blender Cycles."
        )
        return f"{text} {origin}".strip()
