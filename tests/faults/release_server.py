"""A process that has loaded all of symolo and forks a command for each order: a thousand of them in minutes.

Run as a script. It reads an `Order` a line and answers with an `Outcome` a line. In the fork, all is that of the
command but for three things: the scenario is read beforehand, units of work are done in the process itself one by one,
and the images are painted, not traced. All that writes, names, journals, hashes and resumes is the command's own.
"""

import contextlib
import dataclasses
import json
import os
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from disk_recorder import DiskRecorder
from file_operations import FileOperations

import pipeline.stages.simulate  # noqa: F401 - so that a fork finds both loaded
import symolo.exporters.export  # noqa: F401 - likewise
from blender_scenes.render import renderer
from blender_scenes.render.frame_files import FrameFile, put_in_place
from blender_scenes.render.job import RenderJob
from blender_scenes.render.job_file import read_job
from configs.draw import draw_all
from configs.loader import load_scenario
from pipeline import cli
from pipeline.address_space import take_buffers
from pipeline.cli import main
from pipeline.diagnosing import diagnose
from pipeline.executors import local
from pipeline.planning.plan import ScenarioPlan
from pipeline.work import batch
from pipeline.work.supervisor import UnitFailure, WorkerError
from pipeline.work.units import AnyUnit, Progress
from pipeline.work.worker_main import do
from sensors.camera.response import encode_jpeg
from symolo.core.child_process import Failed
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.files import disk_space
from symolo.dataset.layout import frame_name

MARK = "\n--- operations ---\n"


@dataclass(frozen=True)
class Order:
    arguments: list[str]
    kill_after_s: float | None = None
    """When to kill the command with SIGKILL, from its start."""
    root: str = ""
    """Folder below which file operations are counted."""
    at: int = 0
    error: int = 0
    """Which of them fails, with what; see `FileOperations`."""
    shuffle: int | None = None
    """Seed of another order of the units and their frames."""
    recorded: bool = False
    """Whether every change of files is noted as `DiskRecorder` notes it."""
    file_bytes: int | None = None
    """Largest file that the system lets the command write."""
    any_disk: bool = False
    """Not to look first whether there is room; it may go while the command works."""
    address_bytes: int | None = None
    """Address space that the command may take beyond that of the process that it is forked from."""
    scratch: str = ""
    """Folder for temporary files; empty for that of the system."""


@dataclass(frozen=True)
class Outcome:
    status: int
    """Exit code, or less the number of the signal."""
    err: str
    seconds: float
    operations: list[list[str]]


def _painted(request, *_limits_and_callback: object) -> Iterator:
    """In place of Blender: noise that the frame's number decides, put in place as Blender's side does."""
    job = RenderJob.from_json(read_job(Path(request.job_path)).decode())
    size = job.camera.height_px, job.camera.width_px, 3
    for number in request.numbers:
        noise = np.random.Generator(np.random.PCG64(number))
        data = encode_jpeg(noise.integers(40, 200, size, np.uint8), job.response.jpeg_quality)
        path = Path(request.folder) / frame_name(number)
        sha256 = put_in_place(data, path, job.camera.width_px, job.camera.height_px)
        yield FrameFile(number, path.name, sha256, len(data), 0.0)


def _here(shuffle: int | None) -> Callable:
    """In place of child processes: the units one by one in this one, with a worker's words for what goes wrong."""

    def run_units(units: Sequence, _workers: int, on_event: Callable, *_: object, **_options: object) -> list:
        failures = []
        order = list(range(len(units)))
        if shuffle is not None:
            np.random.Generator(np.random.PCG64(shuffle)).shuffle(order)
        for unit in (units[place] for place in order):

            def on_progress(share: float, at: int | None = None, text: str = "", unit: AnyUnit = unit) -> None:
                on_event(unit, Progress(share=share, at=at, text=text))

            event = do(unit, on_progress)
            on_event(unit, event)
            if isinstance(event, Failed):
                if event.error in {"environment", "input"}:
                    raise {"environment": EnvironmentLacking, "input": InputError}[event.error](event.text)
                if event.error == "bug":
                    raise WorkerError(event.text)
                failures.append(UnitFailure(unit, event.text))
        return failures

    return run_units


def _command(order: Order) -> int:
    renderer._blender_files = _painted
    local.run_units = diagnose.run_units = _here(order.shuffle)
    if order.any_disk:
        disk_space._check_room = lambda *_: None
    if order.scratch:
        tempfile.tempdir = order.scratch
    return main(order.arguments)


def _in_the_child(order: Order, log: int) -> None:
    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGCHLD})
    os.dup2(log, 1)
    os.dup2(log, 2)
    kind = DiskRecorder if order.recorded else FileOperations
    operations = kind(order.root, order.at, order.error)
    if order.root:
        operations.install()
    if order.file_bytes is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (order.file_bytes, resource.RLIM_INFINITY))
    if order.address_bytes is not None:
        take_buffers()  # as the check of the command does before the process has loaded all libraries
        resource.setrlimit(resource.RLIMIT_AS, (_address_space() + order.address_bytes, resource.RLIM_INFINITY))
        cli.check_address_space = lambda: None  # which this process is past
    code = 1
    try:
        code = _command(order)
    finally:
        for limit in (resource.RLIMIT_FSIZE, resource.RLIMIT_AS):
            resource.setrlimit(limit, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        sys.stdout.flush()
        sys.stderr.flush()
        with contextlib.suppress(OSError):
            os.write(log, (MARK + json.dumps(operations.noted)).encode())
        os._exit(code)


def _address_space() -> int:
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def _do(order: Order) -> Outcome:
    begin = time.monotonic()
    with tempfile.TemporaryFile() as log:
        pid = os.fork()
        if pid == 0:
            _in_the_child(order, log.fileno())
        if order.kill_after_s is not None:
            signal.sigtimedwait({signal.SIGCHLD}, order.kill_after_s)
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        signal.sigtimedwait({signal.SIGCHLD}, 0)
        seconds = time.monotonic() - begin
        log.seek(0)
        err, _, noted = log.read().decode(errors="replace").partition(MARK)
    return Outcome(status, err, seconds, json.loads(noted or "[]"))


def serve() -> None:
    loaded = load_scenario(str(Path(__file__).with_name("bare.yaml")))
    drawn = tuple(draw_all(loaded))
    batch.load_scenario = lambda _name, _overrides: loaded
    batch.draw_reported = lambda _loaded, _report: drawn
    ScenarioPlan.from_specs(drawn, 1)
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGCHLD})
    print("ready", flush=True)  # noqa: T201 - the other end waits for it
    for line in sys.stdin:
        print(json.dumps(dataclasses.asdict(_do(Order(**json.loads(line))))), flush=True)  # noqa: T201 - likewise


if __name__ == "__main__":
    serve()
