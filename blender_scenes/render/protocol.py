"""What the renderer and its Blender process say to each other: one JSON message a line.

The renderer sends one `Request` on the child's standard input and keeps it open; its end tells the child that nobody
waits any more. The child answers on its standard output, which Blender's own chatter never reaches.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from blender_scenes.render.frame_files import FrameFile

Work = Literal["pictures", "annotations"]


@dataclass(frozen=True)
class Request:
    work: Work
    job_path: str
    """Of a render job, or of an annotation job."""
    folder: str
    """Where the pictures or the files of the annotations go."""
    numbers: tuple[int, ...]
    threads: int
    scratch_dir: str
    """For Blender's own files; whoever of the two is left removes it."""
    own_files: str = ""
    """Folder of the user's own files by their SHA-256; empty where the job shows none."""


@dataclass(frozen=True)
class Ready:
    """Scene built and exposure metered."""

    seconds: float
    kind: Literal["ready"] = "ready"


@dataclass(frozen=True)
class FrameBegun:
    number: int
    kind: Literal["begun"] = "begun"


@dataclass(frozen=True)
class Alive:
    """A sign of life, every few seconds, whatever Blender is at."""

    kind: Literal["alive"] = "alive"


@dataclass(frozen=True)
class FrameDone:
    """A file of a frame is in place, read back and flushed to disk."""

    frame: FrameFile
    kind: Literal["frame"] = "frame"


@dataclass(frozen=True)
class Finished:
    kind: Literal["finished"] = "finished"


@dataclass(frozen=True)
class Failed:
    """The child gives up; `lacking` is what the machine has not, nothing where that is not the cause.

    Of `machine` the message says the cure itself.
    """

    message: str
    lacking: Literal["", "libraries", "machine", "device"]
    kind: Literal["failed"] = "failed"


Message = Annotated[Ready | Alive | FrameBegun | FrameDone | Finished | Failed, Field(discriminator="kind")]
MESSAGE: TypeAdapter[Ready | Alive | FrameBegun | FrameDone | Finished | Failed] = TypeAdapter(Message)
REQUEST: TypeAdapter[Request] = TypeAdapter(Request)
