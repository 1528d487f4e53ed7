"""One small dataset through the real stages, made once, and ways to run the command line."""

import fcntl
import multiprocessing
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from blender_scenes.render.frame_files import FrameFile, Ledger, put_in_place
from blender_scenes.render.job_file import job_sha256
from configs.schema.scenario import RunSpec
from pipeline.cli import main
from pipeline.stages.simulate import DriveOutcome, simulate
from pipeline.work.supervisor import UnitFailure, WorkerError, cores
from pipeline.work.units import AnyUnit, RenderUnit
from pipeline.work.worker_main import do
from sensors.camera.response import encode_jpeg
from symolo.core.child_process import Failed, Finished
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.dataset.layout import frame_name
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest

TINY = [
    f"--set={setting}"
    for setting in (
        "stop.time_limit_s=1.0",
        "render.width_px=32",
        "render.height_px=24",
        "render.samples=1",
    )
]


ONE_ROUTE = "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}]"
"""Setting that leaves one run of the smoke scenario, CW/test_1."""


SENSORS = {
    "imu": "{x_m: -0.03, y_m: 0.02, z_m: 0.06, yaw_deg: 90}",
    "lidar": "{x_m: 0.02, z_m: 0.1, rays: 36, ray_step_deg: 10, delay_s: 0.02}",
    "beside": "{kind: vl53l0x, y_m: 0.05, z_m: 0.05, yaw_deg: -90, pitch_up_deg: 10, mode: long_range}",
    "sonar": "{kind: ultrasonic, x_m: 0.09, z_m: 0.06, yaw_deg: -90}",
    "corners": "{kind: line_array, places: [[0.08, 0.07], [0.08, -0.07], [-0.08, 0.07]], z_m: 0.004}",
    "coder": "{kind: wheel_encoder, wheel: left, counts_per_revolution: 64, delay_s: 0.004}",
    "bumper": "{zones: 3}",
    "left": "{kind: camera, x_m: 0.06, y_m: 0.03, pitch_up_deg: -25, width_px: 32, height_px: 24}",
    "right": "{kind: camera, x_m: 0.06, y_m: -0.03, pitch_up_deg: -25, width_px: 32, height_px: 24}",
    "rear": "{kind: camera, x_m: -0.08, yaw_deg: 180, period_s: 0.3, delay_s: 0.05, width_px: 32, height_px: 24,"
    " fisheye: {}}",
}
"""Sensors of the robot of `sensing_release`; left and right are a rectified pair."""


@dataclass(frozen=True)
class Ended:
    code: int
    out: str
    err: str


@dataclass(frozen=True)
class CommandLine:
    """`symolo` in this process, and as the command that a user types."""

    capture: pytest.CaptureFixture[str]

    def __call__(self, *arguments: object) -> Ended:
        self.capture.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = self.capture.readouterr()
        return Ended(code, captured.out, captured.err)

    @staticmethod
    def start(*arguments: object, **options: object) -> subprocess.Popen[str]:
        """As from a terminal: what a shell starts in the background, such as these tests, may ignore SIGINT."""
        program = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
        program += "from pipeline.cli import main; sys.exit(main())"
        command = [sys.executable, "-P", "-c", program, *map(str, arguments)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


@pytest.fixture
def symolo(capsys: pytest.CaptureFixture[str]) -> CommandLine:
    return CommandLine(capsys)


@pytest.fixture(scope="session")
def tiny() -> list[str]:
    """Settings that shrink the smoke scenario to a second of driving and six images a run."""
    return TINY


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """A release of two runs, made once for all processes of pytest-xdist; read only, `copy_of` is for changing it."""
    return _shared_release("release", TINY, tmp_path_factory, request)


@pytest.fixture(scope="session")
def sensing_release(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """A release of one run, CW/test_1, of a robot with all kinds of sensors, whose images are noise; made and shared as
    `dataset`.
    """
    settings = [
        ONE_ROUTE,
        "stop.time_limit_s=0.6",
        "render.width_px=32",
        "render.height_px=24",
        *(f"robot.sensors.{name}={value}" for name, value in SENSORS.items()),
    ]
    with _in_this_process() as chosen:
        chosen.paint = _paint_noise
        return _shared_release("sensing", [f"--set={setting}" for setting in settings], tmp_path_factory, request)


@pytest.fixture
def copy_of(tmp_path: Path) -> Callable[..., Path]:
    def copy(source: Path, *, stages: bool = False) -> Path:
        ignore = None if stages else shutil.ignore_patterns(".stages")
        return Path(shutil.copytree(source, tmp_path / "copy", ignore=ignore))

    return copy


@pytest.fixture
def sign() -> Callable[[Path], None]:
    """Writes checksums that fit, so that only a check of the content can find a fault."""

    def write(root: Path) -> None:
        hashes = released_hashes(root)
        (root / MANIFEST).write_bytes(manifest(hashes))
        (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))

    return write


@pytest.fixture
def release_of() -> Callable[[Path], dict[str, bytes]]:
    """Bytes of every released file by name."""

    def read(root: Path) -> dict[str, bytes]:
        files = (path for path in root.rglob("*") if path.is_file() and ".stages" not in path.parts)
        return {path.relative_to(root).as_posix(): path.read_bytes() for path in files}

    return read


def _shared_release(
    name: str, settings: Sequence[str], folders: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> Path:
    """Make a release once for all processes of pytest-xdist, and return its folder."""
    shared = folders.getbasetemp()
    if hasattr(request.config, "workerinput"):
        shared = shared.parent  # every process has a folder of its own below the session's
    out = shared / name / "data"
    with (shared / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (out / TAG_MANIFEST).exists():
            assert main(["release", "smoke", "--out", str(out), *settings, "--workers", "1"]) == 0
    return out


def _paint_noise(unit: RenderUnit) -> None:
    """In place of Blender: noise of its own for each frame of each camera."""
    ledger = Ledger(unit.folder, job_sha256(unit.job))
    for number in unit.numbers:
        rng = np.random.default_rng([number, *unit.folder.as_posix().encode()[-40:]])
        data = encode_jpeg(rng.integers(0, 256, (24, 32, 3), dtype=np.uint8), 92)
        digest = put_in_place(data, unit.folder / frame_name(number), 32, 24)
        ledger.add(FrameFile(number, frame_name(number), digest, len(data), 0.0))


def _paint(unit: RenderUnit, grey: int = 128, cpu: str = "") -> None:
    """In place of Blender: a grey image of 32 x 24 pixels for each frame, with a stated class of processor."""
    data = encode_jpeg(np.full((24, 32, 3), grey, np.uint8), 92)
    ledger = Ledger(unit.folder, job_sha256(unit.job))
    for number in unit.numbers:
        name = frame_name(number)
        digest = put_in_place(data, unit.folder / name, 32, 24)
        ledger.add(FrameFile(number, name, digest, len(data), 0.0, cpu=cpu))


ERRORS = {"environment": EnvironmentLacking, "input": InputError, "bug": WorkerError}
"""What ends a command, by the kind of failure that a worker reports."""


@contextmanager
def _in_this_process() -> Iterator[SimpleNamespace]:
    """Have units of work done one by one in this process, the images by `paint`, which a test may replace."""
    chosen = SimpleNamespace(paint=_paint)

    def run_units(
        units: Sequence[AnyUnit], _workers: int, on_event: Callable, *_: object, **__: object
    ) -> list[UnitFailure]:
        failures = []
        for unit in units:
            if isinstance(unit, RenderUnit) and unit.work == "images":
                chosen.paint(unit)
                event = Finished()
            else:
                event = do(unit, lambda *_, **__: None)
            on_event(unit, event)
            if isinstance(event, Failed):
                if event.error in ERRORS:
                    raise ERRORS[event.error](event.text)
                failures.append(UnitFailure(unit, event.text))
        return failures

    with pytest.MonkeyPatch.context() as patch:
        for module in ("pipeline.executors.local", "pipeline.diagnosing.diagnose"):
            patch.setattr(f"{module}.run_units", run_units)
        yield chosen


@pytest.fixture
def hands() -> Iterator[SimpleNamespace]:
    """Units of work are done one by one in this process, the images by `paint`, which a test may replace."""
    with _in_this_process() as chosen:
        yield chosen


@pytest.fixture(scope="module")
def hands_of_module() -> Iterator[SimpleNamespace]:
    """As `hands`, for fixtures of a module, and for all of its tests."""
    with _in_this_process() as chosen:
        yield chosen


@pytest.fixture(scope="session")
def in_this_process() -> Callable[[], AbstractContextManager[SimpleNamespace]]:
    """As `hands`, within a `with` statement alone."""
    return _in_this_process


@pytest.fixture(scope="session")
def begun() -> Iterator[Callable[[RunSpec], Future[DriveOutcome]]]:
    """Begins to simulate a run on a core of its own while the tests go on; `result()` waits for it."""
    with ProcessPoolExecutor(cores(), multiprocessing.get_context("spawn")) as pool:
        yield lambda spec: pool.submit(simulate, spec)
        pool.shutdown(cancel_futures=True)
