"""The messages between the renderer and its Blender process, over the channel of `symolo.core.child_process`."""

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from blender_scenes.render.frame_files import FrameFile
from symolo.core.child_process import Alive, Failed, Finished, Message

Work = Literal["images", "annotations"]


class RenderRequest(Message):
    """Request to a Blender process to make the files of some frames."""

    work: Work
    job_path: str
    """Path of a render job or an annotation job."""
    folder: str
    """Folder for the images or the files of the annotations."""
    numbers: tuple[int, ...]
    threads: int
    user_files: str = ""
    """Folder of the user's files by their SHA-256; empty for a job that shows none."""


class Ready(Message):
    """Scene built and exposure metered."""

    seconds: float
    kind: Literal["ready"] = "ready"


class ProbeStep(Message):
    """An image is rendered from which the renderer chooses its settings."""

    kind: Literal["probe"] = "probe"


class FrameBegun(Message):
    """Report of a Blender process that it begins a frame."""

    number: int
    kind: Literal["begun"] = "begun"


class FrameDone(Message):
    """A file of a frame is in place, read back and flushed to disk."""

    frame: FrameFile
    kind: Literal["frame"] = "frame"


BlenderMessage = Ready | ProbeStep | Alive | FrameBegun | FrameDone | Finished | Failed
MESSAGES: TypeAdapter[BlenderMessage] = TypeAdapter(Annotated[BlenderMessage, Field(discriminator="kind")])
