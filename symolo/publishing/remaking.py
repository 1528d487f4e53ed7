"""How to make a published dataset again: from its scenario, or from logs and releases that are not included."""

from collections.abc import Iterator
from dataclasses import dataclass

from symolo.dataset.documents.contents import Contents, logs_of, sources_of
from symolo.dataset.documents.metadata import Metadata

SCENARIO, SETTINGS = "scenario.yaml", "settings.yaml"


@dataclass(frozen=True)
class Source:
    """A log or a release from which a dataset was made, and which is not in the publication."""

    name: str
    what: str
    """What it is, in a few words."""
    sha256: str
    """SHA-256 of the log, or of manifest-sha256.txt of the release; empty if it is not known."""

    @property
    def text(self) -> str:
        return f"{self.what} {self.name}" + (f" with the SHA-256 {self.sha256}" if self.sha256 else "")


@dataclass(frozen=True)
class Remaking:
    """How a dataset was made, and how to make it again."""

    command: str
    action: str
    """Sentence on what the command did."""
    settings_file: str
    """Name of the file with the settings in the publication."""
    settings_meaning: str
    steps: str
    """Sentences on how to make it again; empty if `settings_meaning` says it."""
    sources: tuple[Source, ...]

    @property
    def is_workflow(self) -> bool:
        """Whether the file with the settings is a scenario, from which the command makes the same dataset."""
        return self.settings_file == SCENARIO

    @property
    def profile(self) -> str:
        """Profile of RO-Crate that describes it."""
        return "Workflow Run RO-Crate 0.5" if self.is_workflow else "Process Run Crate 0.5"

    @classmethod
    def from_metadata(cls, metadata: Metadata) -> "Remaking":
        contents = Contents.from_metadata(metadata)
        rendered = " and rendered" if contents.rendered_images else ""
        if not contents.has_origins:
            return cls(
                f"symolo release {SCENARIO}",
                f"Simulated{rendered} {metadata.name} with the seed {metadata.seed}.",
                SCENARIO,
                f"all settings; `symolo release {SCENARIO}` makes the dataset again",
                "",
                (),
            )
        sources, is_rerendered = tuple(_sources(metadata)), bool(sources_of(metadata))
        command, what = ("symolo rerender", "release") if is_rerendered else ("symolo import", "log")
        steps = (
            f"No scenario makes this dataset again, since its trajectories were not simulated for it. `{command}` makes"
            f" it again from its {what}, which is not included. The options of the command are not recorded, such as"
        )
        steps += " those of the looks" if is_rerendered else " a mapping of the columns"
        steps += f"; {SETTINGS} has the settings that they gave."
        return cls(
            command,
            f"Rendered images along the trajectories of {metadata.name}."
            if is_rerendered
            else f"Imported the trajectories of {metadata.name} from logs.",
            SETTINGS,
            "settings of the arena, the robot and the look of rendered images; no scenario",
            steps,
            sources,
        )


def _sources(metadata: Metadata) -> Iterator[Source]:
    """Yield what the last command read first."""
    yield from (Source(name, "release", digest) for name, digest in sources_of(metadata))
    yield from (Source(name, f"log ({importer})", digest) for name, digest, importer in logs_of(metadata))
