"""Processes that render in turn, so that a change in the load of the machine affects all of them alike."""

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from blender_scenes.render.job import RenderJob
from blender_scenes.render.probe import Decision, read_decision
from blender_scenes.render.surroundings import without_blender_settings

CHECKOUT = Path(__file__).parents[3]
_LOG_LINES = 15


@dataclass(frozen=True)
class Cost:
    core_s: float
    """Processor time of all threads of the process."""
    wall_s: float


class RenderProcess:
    """A process with its own scene, whose side of the protocol is `child_side`. As a context manager, it ends the
    process.

    Raises:
        ChildProcessError: The process died; the message has the last lines of its log.
    """

    def __init__(
        self,
        script: str,
        job: RenderJob,
        settings: dict[str, Any],
        threads: int,
        python: str,
        *,
        checkout: Path = CHECKOUT,
    ) -> None:
        """Start the process; `checkout` is the folder of the version that renders."""
        self._folder = tempfile.TemporaryDirectory(prefix="symolo-render-")
        folder = Path(self._folder.name)
        self._log = (folder / "log").open("w+b")
        (folder / "job.json").write_text(job.to_json())
        scripts = checkout / "benchmarks/render"  # the folder of a script in it differs between versions
        program, *_ = *scripts.rglob(script), *scripts.rglob("painter.py")  # the name in earlier versions
        command = [python, str(program), str(folder / "job.json"), json.dumps(settings)]
        environment = {**without_blender_settings(os.environ), "TMPDIR": str(folder)}
        environment["PYTHONPATH"] = str(checkout)
        self._child = subprocess.Popen(
            [*command, str(folder), str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            env=environment,
            text=True,
        )
        self.set_up = self._reply()
        """Cost from the start of the process until the scene is ready."""

    def render(self, numbers: Sequence[int], *, warm_up: bool = False) -> Cost:
        """Render frames of the job, one after the other, and return the cost of all of them."""
        stdin = self._child.stdin
        try:
            if stdin is not None:
                stdin.write(json.dumps({"numbers": list(numbers), "warm_up": warm_up}) + "\n")
                stdin.flush()
        except BrokenPipeError:
            raise ChildProcessError(self._ended()) from None
        return self._reply()

    def light(self, number: int) -> np.ndarray:
        """Return the linear light (H, W, 3) of a frame that was rendered last, or its passes."""
        return np.load(Path(self._folder.name) / f"{number}.npy")

    def decision(self) -> Decision:
        """Return the rendering that a process of the kind `chosen` has chosen."""
        decision = read_decision(Path(self._folder.name, "images"), "")
        if decision is None:
            raise ChildProcessError("the rendering process chose nothing")
        return decision

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._child.kill()
        self._child.communicate()
        self._log.close()
        self._folder.cleanup()

    def _reply(self) -> Cost:
        line = self._child.stdout.readline() if self._child.stdout is not None else ""
        if not line:
            raise ChildProcessError(self._ended())
        return Cost(**json.loads(line))

    def _ended(self) -> str:
        status = self._child.wait()
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").splitlines()[-_LOG_LINES:]
        return "\n".join([f"a rendering process ended with status {status}; the last lines of its log:", *lines])
