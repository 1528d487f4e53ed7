"""What the documents of a publication are written from."""

from dataclasses import dataclass

from symolo.dataset.documents.metadata import Metadata
from symolo.publishing.about import About
from symolo.publishing.licences import Licence, licence_of
from symolo.publishing.tables import PlannedTable


@dataclass(frozen=True)
class PackedFile:
    """One that lies in the publication already."""

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
        """Also the folder that the shards unpack to."""
        return self.metadata.name

    @property
    def licence(self) -> Licence:
        return licence_of(self.metadata.licence)

    @property
    def description(self) -> str:
        own = (self.about.description if self.about.description is not None else self.metadata.description).strip()
        made = (
            "A synthetic dataset of a small differential robot in the layout of SyMoLo (Synthetic Dataset for Mobile "
            "Robots Localization Algorithms): motion simulated with PyBullet, pictures path-traced with Blender Cycles."
        )
        return f"{own}{'' if not own or own.endswith(('.', '!', '?')) else '.'} {made}".strip()
