"""The facts from which the documents of a publication are written."""

from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256

from symolo.dataset.documents.contents import Contents
from symolo.dataset.documents.metadata import Metadata
from symolo.publishing.about import About
from symolo.publishing.licences import Licence, licence_of
from symolo.publishing.membership import Membership
from symolo.publishing.remaking import Remaking
from symolo.publishing.tables import PlannedTable


@dataclass(frozen=True)
class PackedFile:
    """A file that is already written to the publication."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Published:
    """A dataset together with the facts and the files of its publication."""

    about: About
    metadata: Metadata
    tables: tuple[tuple[PlannedTable, PackedFile], ...]
    """Tables of all runs, with the files that hold them."""
    shards: tuple[PackedFile, ...]
    """Archives with the files of the dataset."""

    @property
    def name(self) -> str:
        """Name of the dataset and of the folder that the shards unpack to."""
        return self.metadata.name

    @cached_property
    def contents(self) -> Contents:
        """Origin of its trajectories and images, which every document states."""
        return Contents.from_metadata(self.metadata)

    @cached_property
    def remaking(self) -> Remaking:
        """How it was made, and how to make it again."""
        return Remaking.from_metadata(self.metadata)

    @property
    def membership(self) -> Membership | None:
        """Split of each run or image; None if the dataset is not divided."""
        return Membership.from_splits(self.metadata.splits) if self.metadata.splits else None

    @property
    def described_tables(self) -> tuple[tuple[PackedFile, str], ...]:
        """Tables beside the shards, each with what it is."""
        tables = tuple((file, f"{table.source} of all runs") for table, file in self.tables)
        if membership := self.membership:
            content = membership.csv()
            file = PackedFile(membership.file, len(content), sha256(content).hexdigest())
            return (*tables, (file, membership.meaning))
        return tables

    @property
    def licence(self) -> Licence:
        return licence_of(self.metadata.licence)

    @property
    def description(self) -> str:
        """Description by the user, followed by what the dataset is and how it was made."""
        text = (self.about.description if self.about.description is not None else self.metadata.description).strip()
        if text and not text.endswith((".", "!", "?")):
            text += "."
        return f"{text} {self.contents.summary}".strip()

    @property
    def keywords(self) -> tuple[str, ...]:
        """Keywords by the user, or those that fit the contents."""
        return self.about.keywords or self.contents.keywords
