"""The readers of untrusted files, each as a function of bytes, with valid inputs to begin with.

An input that begins with `@NAME` and a line end replaces the file of that name in a folder of valid files; the reader
then reads the whole folder. `corpus/READER/valid` holds valid files, and `corpus/READER` the inputs that once failed.
"""

import hashlib
import io
import shutil
from collections.abc import Callable
from contextlib import redirect_stderr, suppress
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import yaml

from configs.assets.images import read_image
from configs.assets.panoramas import read_panorama
from configs.draw import draw_run
from configs.loader import load_scenario, load_section
from configs.schema.robot import RobotConfig
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.overview import overview
from hil.frames import CommandFrame, HelloFrame, SensorFrame
from hil.framings import FRAMINGS
from hil.framings.base import CommandMessage, Damaged, HelloRequest, SensorsMessage
from hil.plausibility import DriveLimits, TickCount
from pipeline.diagnosing.importers import IMPORTERS
from pipeline.run_folder.status import status
from pipeline.run_folder.stored_runs import read_simulated
from pipeline.run_folder.stored_spec import spec_problem
from symolo.compare.folders import compare
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.progress import LineReport
from symolo.core.tables.time_series import Recording, TimeSeries, Trajectory
from symolo.dataset.codes import State
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, read_manifest, tag_manifest
from symolo.dataset.pixels import decoded_bytes
from symolo.dataset.tables.rows import HEADER, Rows, parse_table, semantic_faults
from symolo.dataset.tables.side_tables import CAMERA, POSITIONS_HEADER, TOF, WHEELS
from symolo.publishing.documents.provenance import subject_problem
from symolo.reader.dataset import load
from symolo.signing.minisign import PublicKey, Signature
from symolo.storage.download import Remote, download
from symolo.verification.verify import verify
from tests.fuzz import (
    dataset_documents,
    log_readers,
    model_reader,
    named_files,
    rosbag_reader,
    shape_readers,
    small_files,
)
from tests.fuzz.folders import CORPUS, Folder, files, sealed, valid_copy
from tests.fuzz.guard import Read

TABLES = (HEADER, WHEELS.header, TOF.header, CAMERA.header)


@dataclass(frozen=True)
class Reader:
    name: str
    valid: Callable[[], list[bytes]]
    """Returns valid inputs."""
    opened: Callable[[Path], Read]
    """Returns the function that reads an input, which works in an empty folder."""
    refusals: tuple[type[Exception], ...] = (InputError,)
    """Errors that it may raise: those that a command turns into one line."""

    @property
    def failed_once(self) -> list[bytes]:
        """Inputs that once failed."""
        return [path.read_bytes() for path in sorted((CORPUS / self.name).glob("*")) if path.is_file()]


def _scenarios() -> list[bytes]:
    whole = yaml.safe_dump(load_scenario("symolo").tree, sort_keys=False).encode()
    folder = Path(__file__).parents[2] / "configs" / "scenarios"
    return [whole, *(path.read_bytes() for path in sorted(folder.glob("*.yaml")))]


def _scenario_of_wrong_keys() -> bytes:
    """Thousands of unknown keys, each of which is looked for in the whole schema."""
    return b"".join(b"key_%d: 1\n" % number for number in range(4000))


def _scenario_reader(place: Path) -> Read:
    file = place / "scenario.yaml"

    def read(data: bytes) -> None:
        file.write_bytes(data)
        loaded = load_scenario(str(file))
        draw_run(loaded, loaded.routes[0].name, 1)

    return read


def _tables() -> list[bytes]:
    return [
        content.partition(b"\n")[2] for content in files("dataset") if b".csv\n" in content or b"positions" in content
    ]


def _table_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        for header in TABLES:
            table, faults = parse_table(data, header)
            if header == HEADER and not faults:
                rows = Rows.from_table(table)
                list(map(str, semantic_faults(rows)))
                rows.to_csv()
        parse_table(data, POSITIONS_HEADER, separator=" ")

    return read


def _images() -> list[bytes]:
    y, x = np.mgrid[0:24, 0:32]
    colour = np.stack([8 * x, 10 * y, 4 * (x + y)], axis=-1).astype(np.uint8)
    deep = (257 * colour.astype(np.uint16))[..., :3]
    with_alpha = np.dstack([colour, colour[..., :1]])
    kinds = [(".jpg", colour, [cv2.IMWRITE_JPEG_PROGRESSIVE, on]) for on in (0, 1)]
    kinds += [(".jpg", colour[..., 0], []), (".jpg", colour, [cv2.IMWRITE_JPEG_RST_INTERVAL, 2])]
    kinds += [(".png", pixels, []) for pixels in (colour, deep, deep[..., 0], colour[..., 0], with_alpha)]
    return [cv2.imencode(ending, pixels, options)[1].tobytes() for ending, pixels, options in kinds]


def _image_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        decoded_bytes(data)
        decoded_bytes(data, in_colour=True)
        read_image(data)

    return read


def _panoramas() -> list[bytes]:
    y, x = np.mgrid[0:8, 0:16]
    light = np.stack([x, y, x + y], axis=-1).astype(np.float32) + 1
    radiance = cv2.imencode(".hdr", light)[1].tobytes()
    exr = [content.partition(b"\n")[2] for content in files("panorama")]
    return [b"#?RADIANCE" + radiance[radiance.index(b"\n") :], *exr]


def _panorama_reader(_place: Path) -> Read:
    def read(data: bytes) -> None:
        read_panorama(data)

    return read


def _dataset_with_a_long_specification() -> bytes:
    return b"@.stages/simulate/CW/test_1/spec.json\n" + b'{"runs": [' + 110_000 * b'{"a":1},' + b"1]}"


def _dataset_reader(place: Path) -> Read:
    """Read a dataset with one other file, whose checksums fit, by the commands that read most of it."""
    folder = Folder.from_path(valid_copy("dataset", place))
    whole = Path(shutil.copytree(folder.root, place / "whole"))

    def read(data: bytes) -> None:
        with folder.replaced(data) as path, sealed(folder.root, path):
            list(map(str, verify(folder.root, spec_problem)))
            status(folder.root)
            if path.suffix not in {".jpg", ".png"}:  # a large one takes its time in each command
                list(compare(path, whole / path.relative_to(folder.root), 50.0))
            _load(folder.root)

    return read


def _load(root: Path) -> None:
    """Read everything that the library offers of a dataset."""
    for run in load(root):
        with suppress(InputError):  # of one part; the others are read all the same
            _ = run.rows, run.image_rows, run.specification, run.spec
        for name in ("wheels", "tof", "camera"):
            with suppress(InputError):
                run.side(name)
        for part in ("camera", "annotations", "X_WC", "annotation_kinds"):
            with suppress(InputError):
                getattr(run, part)
        with suppress(InputError):
            for image in run:
                with suppress(InputError):
                    image.pixels()
                for mask in ("line", "wall", "sky"):
                    with suppress(InputError):
                        image.mask(mask)


def _bag_reader(place: Path) -> Read:
    """Read a bag with one other file, whose lists do not fit."""
    folder = Folder.from_path(valid_copy("bag", place))

    def read(data: bytes) -> None:
        with folder.replaced(data):
            list(map(str, verify(folder.root, spec_problem)))

    return read


@dataclass(frozen=True)
class MemoryStore:
    """A store in memory, of empty files but for the lists."""

    lists: dict[str, bytes]
    names: tuple[str, ...]
    url: str = "file:///store"

    def sizes(self) -> dict[str, int]:
        return {**dict.fromkeys(self.names, 0), **{name: len(data) for name, data in self.lists.items()}}

    def get(self, name: str) -> bytes | None:
        return self.lists.get(name, b"")


def _manifests() -> list[bytes]:
    empty = hashlib.sha256(b"").hexdigest()
    names = ("README.md", "metadata.json", "bag-info.txt", "CW/test_1/data.csv", "CW/test_1/images/000001.jpg")
    return [manifest(dict.fromkeys(names, empty)), manifest({"a": empty, "b/c": empty})]


def _download_reader(place: Path) -> Read:
    """Download a release with this list of checksums; what is written lies in the named folder."""
    out = place / "inner" / "out"
    (place / "inner").mkdir()
    (place / "beside").write_bytes(b"of the user")

    def read(data: bytes) -> None:
        try:
            digests = read_manifest(data)
        except ValueError:
            digests = {}
        store = MemoryStore({MANIFEST: data, TAG_MANIFEST: tag_manifest(digests)}, tuple(digests))
        try:
            with redirect_stderr(io.StringIO()):
                download(Remote.from_store(store), out, LineReport())
        finally:
            there = {path.name for path in place.iterdir()}, {path.name for path in out.parent.iterdir()}
            for path in (out, out.with_name(".out.download")):
                shutil.rmtree(path, ignore_errors=True)
        assert there == ({"inner", "beside"}, {"out"})

    return read


def _streams() -> list[bytes]:
    sensors = SensorFrame((10, -12), tuple(k / 7 for k in range(8)), 0.5, None, 2.0, start=True)
    command = CommandFrame(State.LINE, 5.0, 3.0, 0.2, 0.5, 0, 7, 0)
    streams = []
    for framing in FRAMINGS.values():
        one = framing.hello(0) + framing.sensors(1, sensors) + framing.sensors(255, sensors)
        other = framing.hello_answer(0, HelloFrame(1, "0123456789abcdef", 3)) + framing.command(1, command)
        streams += [one, other + framing.command(2, command), one + other]
    return streams


def _serial_reader(_place: Path) -> Read:
    limits = DriveLimits.from_robot(RobotConfig.model_validate(load_section("robot", "nominal").tree))
    messages = (CommandMessage, SensorsMessage, HelloRequest, HelloFrame, Damaged)

    def read(data: bytes) -> None:
        for framing in FRAMINGS.values():
            for decoder in (framing.from_board(), framing.to_board()):
                ticks = TickCount()
                for at in range(0, len(data), 7):
                    for message in decoder.decode(data[at : at + 7]):
                        assert isinstance(message, messages)
                        if isinstance(message, CommandMessage):
                            ticks.sent((1, 1))
                            limits.refusal(message.command)
                            if not ticks.refusal(message.command):
                                ticks.answered(message.command)
                                ticks.with_lost((3, 4))

    return read


def _logs_reader(place: Path) -> Read:
    """Read a measured case or a log with one other file, and describe it."""
    folder = Folder.from_path(valid_copy("logs", place))

    def read(data: bytes) -> None:
        with folder.replaced(data) as path:
            case = folder.root / path.relative_to(folder.root).parts[0]
            overview(read_measurement(case, IMPORTERS))

    return read


def _trajectories() -> list[bytes]:
    t_s = np.arange(4) * 0.05
    trajectory = Trajectory(t_s, np.ones((4, 3)), np.ones((4, 2)), np.ones(4, np.int64))
    series = (TimeSeries("line", "1", t_s, np.ones((4, 8))), TimeSeries("image", "1", t_s, np.arange(4)))
    packed = io.BytesIO()
    Recording(trajectory, series).save(packed)
    return [packed.getvalue()]


def _trajectory_reader(place: Path) -> Read:
    def read(data: bytes) -> None:
        (place / "trajectory.npz").write_bytes(data)
        read_simulated(place)

    return read


def _signatures() -> list[bytes]:
    return [content.partition(b"\n")[2] for content in files("signature")]


def _signature_reader(place: Path) -> Read:
    (place / TAG_MANIFEST).write_bytes(b"")
    (place / MANIFEST).write_bytes(b"")

    def read(data: bytes) -> None:
        subject_problem(data, place)
        try:
            PublicKey.from_text(data.decode(errors="replace"))
        except ValueError:
            Signature.from_bytes(data)

    return read


LONG = {
    "keys of a scenario": ("scenario", _scenario_of_wrong_keys()),
    "values of a specification": ("dataset", _dataset_with_a_long_specification()),
    "curves": ("drawing", shape_readers.drawing_of_many_curves()),
    "metadata of a bag": ("rosbag", rosbag_reader.bag_of_long_metadata()),
    "trials of a log": ("case", log_readers.log_of_many_trials()),
}
"""Reader and input by what is long in it; they were read in more than 2 s."""
READERS = {
    reader.name: reader
    for reader in (
        Reader("scenario", _scenarios, _scenario_reader),
        Reader("table", _tables, _table_reader),
        Reader("image", _images, _image_reader, (ValueError,)),
        Reader("panorama", _panoramas, _panorama_reader, (ValueError,)),
        Reader("dataset", lambda: files("dataset"), _dataset_reader),
        Reader("bag", lambda: files("bag"), _bag_reader),
        Reader("download", _manifests, _download_reader, (InputError, EnvironmentLacking)),
        Reader("serial", _streams, _serial_reader, ()),
        Reader("logs", lambda: files("logs"), _logs_reader),
        Reader("trajectory", _trajectories, _trajectory_reader),
        Reader("signature", _signatures, _signature_reader, (ValueError,)),
        Reader("mesh", shape_readers.meshes, shape_readers.mesh_reader, (ValueError,)),
        Reader("drawing", shape_readers.drawings, shape_readers.drawing_reader),
        Reader("rosbag", rosbag_reader.bags, rosbag_reader.bag_reader),
        Reader("urdf", shape_readers.robots, shape_readers.robot_reader),
        Reader("documents", dataset_documents.documents, dataset_documents.documents_reader),
        Reader("code", dataset_documents.code_records, dataset_documents.code_reader),
        Reader("named", named_files.named_files, named_files.named_reader),
        Reader("mapping", named_files.mappings, named_files.mapping_reader),
        Reader("photographs", named_files.photographs, named_files.photographs_reader),
        Reader("model", model_reader.models, model_reader.model_reader),
        Reader("import", log_readers.trajectories, log_readers.import_reader),
        Reader("case", log_readers.logs_of_cases, log_readers.case_reader),
        Reader("estimates", small_files.estimates, small_files.estimates_reader),
        Reader("about", small_files.abouts, small_files.about_reader),
        Reader("splits", small_files.splits, small_files.splits_reader),
        Reader("keys", small_files.keys, small_files.keys_reader),
        Reader("recordings", small_files.recordings, small_files.recordings_reader),
        Reader("diagnoses", small_files.diagnoses, small_files.diagnoses_reader),
    )
}
