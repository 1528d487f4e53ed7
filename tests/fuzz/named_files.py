"""Readers of files that a user's command or scenario names, as `readers.py` has them."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np

from configs.draw import draw_all
from configs.loader import load_scenario
from configs.user_files import ROBOT_FILES
from diagnosis.measured.case_files.write_case import csv_of
from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.new_case import new_case
from diagnosis.new_case.nominal_text import nominal_text
from diagnosis.new_case.proposal import propose
from diagnosis.new_case.quantities import KINDS
from logs.log_file import read_log
from logs.mapping import check_mapping, mapping_text, read_mapping
from pipeline.look_from_photographs.photographs import read_photographs
from pipeline.sensors.template import template
from tests.configs.test_posterior import POSTERIOR
from tests.diagnosis.new_case.drives import DT, csv_text, drive_rows
from tests.fuzz.folders import Folder
from tests.fuzz.guard import Read
from tests.known_photographs import photograph

NAMED = {
    "scenario.yaml": """\
extends: smoke
name: named
routes:
  - {name: A, start: {x_m: 0.55, y_m: -0.2, yaw_deg: -90}}
  - {name: B, start: {x_m: 0, y_m: 0, yaw_deg: 0}, arena: room.yaml}
robot: robot.yaml
look: look.yaml
""",
    "like.yaml": "extends: smoke\nname: alike\nlike: posterior.yaml\n",
    "posterior.yaml": POSTERIOR,
    "robot.yaml": """\
extends: extended.yaml
name: sensing
sensor_files: [compass.py]
sensors:
  lidar: {rays: 12, x_m: {uniform: [0, 0.05]}}
  north: {kind: compass, noise_deg: 2}
""",
    "extended.yaml": """\
extends: nominal
name: extended
effects:
  torque_constant_scale: {scale: 0.93}
effect_ranges:
  - {effect: torque_constant_scale, quantity: voltage_V, low: 0.5, high: 5}
""",
    "room.yaml": """\
extends: symolo
name: room
floor: {half_extent_m: 1.5}
walls: [{name: N, start: [-1, 1], end: [1, 1]}]
obstacles: [{name: box, center: [0.6, 0.6], size: [0.1, 0.1, 0.2]}]
line: {course: {points: [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], closed: true}}
""",
    "look.yaml": "extends: lab\nname: mine\ncamera: camera.yaml\n",
    "camera.yaml": "extends: phone\nvignetting: {uniform: [0.1, 0.3]}\n",
}
"""Files of a scenario of two arenas; the file of a sensor is not changed, since whoever names it executes it."""


def named_files() -> list[bytes]:
    return [f"@{name}\n{text}".encode() for name, text in NAMED.items()]


def named_reader(place: Path) -> Read:
    """Load the two scenarios with one other file, and draw all of their runs."""
    for name, text in NAMED.items():
        (place / name).write_text(text)
    folder = Folder.from_path(place)
    (place / "compass.py").write_text(template("compass"))

    def read(data: bytes) -> None:
        try:
            with folder.replaced(data) as path:
                names = ("like.yaml", "posterior.yaml")
                scenario = "like.yaml" if path.name in names else "scenario.yaml"
                draw_all(load_scenario(str(place / scenario)))
        finally:
            for kind in ROBOT_FILES:
                for file in [*kind.family.files.values()]:
                    kind.family.unload(file.path)

    return read


@cache
def _case_files() -> dict[str, bytes]:
    """Return a log and its mapping file."""
    with TemporaryDirectory() as place:
        log = Path(place) / "log.csv"
        log.write_text(csv_text(drive_rows(DT * np.arange(80))))
        table = read_log(log)
        mapping = propose(table, None, None, {}).mapping
        text = mapping_text(mapping, KINDS[CaseKind(mapping.kind)], table, ("symolo", "case", "init"))
        return {"log.csv": log.read_bytes(), "mapping.yaml": text.encode()}


def mappings() -> list[bytes]:
    return [f"@{name}\n".encode() + data for name, data in _case_files().items()]


def mapping_reader(place: Path) -> Read:
    """Read a log by its mapping file, one of which is changed, as a new case."""
    log, mapping_file = place / "log.csv", place / "mapping.yaml"
    for name, data in _case_files().items():
        (place / name).write_bytes(data)
    folder = Folder.from_path(place)

    def read(data: bytes) -> None:
        with folder.replaced(data):
            table = read_log(log)
            mapping = read_mapping(mapping_file, list(KINDS.values()))
            check_mapping(mapping, KINDS[CaseKind(mapping.kind)], table, str(mapping_file))
            case = new_case(table, mapping, "mine")
            csv_of(case.measurement)
            nominal_text(case.measurement, {})
            case.compared()
            case.unknown()

    return read


def photographs() -> list[bytes]:
    return [f"@{number}.png\n".encode() + _photograph(number) for number in range(3)]


def _photograph(number: int) -> bytes:
    return cv2.imencode(".png", photograph(number, shot=0.01))[1].tobytes()


def photographs_reader(place: Path) -> Read:
    """Measure four photographs of a line, of which one is another file; three are enough for a look."""
    for number in range(4):
        (place / f"{number}.png").write_bytes(_photograph(number))
    folder = Folder.from_path(place)

    def read(data: bytes) -> None:
        with folder.replaced(data):
            read_photographs([(path, path.read_bytes()) for path in folder.files], None)

    return read
