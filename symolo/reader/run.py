"""One released run: its folder, its sensors and its further cameras."""

from dataclasses import dataclass
from functools import cached_property

from symolo.core.errors import InputError
from symolo.dataset.documents.camera_specification import further_cameras
from symolo.dataset.layout import SIDE, SPEC, camera_folder
from symolo.reader.by_name import ByName
from symolo.reader.camera_run import CameraRun
from symolo.reader.run_folder import RunFolder
from symolo.reader.sensor import RunSensor


@dataclass(frozen=True)
class Run(RunFolder):
    """A folder that holds a data.csv; files beside it are opened when they are needed."""

    @cached_property
    def sensors(self) -> dict[str, RunSensor]:
        """Sensors of `robot.sensors` by name, with all their samples.

        Raises:
            InputError: A table is damaged, or spec.json does not contain its sensor.
        """
        sections, sensors = self.spec.robot.sensors if self.sensor_tables else {}, {}
        for table in self.sensor_tables:
            if table.name not in sections:
                where = str(self.folder / SIDE / SPEC)
                raise InputError(f"robot.sensors has no {table.name}, which metadata.json describes", where=where)
            sensors[table.name] = RunSensor(table.name, sections[table.name], table, self._side(table))
        return ByName("sensor", self.name, sensors)

    @cached_property
    def cameras(self) -> dict[str, CameraRun]:
        """Further cameras by name, each with rows, images and poses of its own; `images` has those of data.csv.

        Raises:
            InputError: spec.json is missing or damaged.
        """
        names = further_cameras(self.specification)
        folders = {name: camera_folder(name) for name in names}
        cameras = {
            name: CameraRun(self.folder / folder, f"{self.name}/{folder}", whole=self, camera_name=name)
            for name, folder in folders.items()
        }
        return ByName("further camera", self.name, cameras)
