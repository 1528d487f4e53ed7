"""A further camera of a run, as a run whose images are those of this camera."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.dataset.documents.camera_specification import specification_of
from symolo.dataset.documents.run_document import SensorSection
from symolo.dataset.layout import SIDE
from symolo.dataset.tables.camera_rows import rows_at, rows_at_images
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_reading import read_image_times
from symolo.dataset.tables.side_tables import CAMERA, SideTable
from symolo.reader.run_folder import RunFolder


@dataclass(frozen=True)
class CameraRun(RunFolder):
    """The folder `cameras/<name>/` of a run: rows at the images of the camera, images, poses, annotations."""

    whole: RunFolder = field(kw_only=True, repr=False)
    """Run to which the camera belongs."""
    camera_name: str = field(kw_only=True)
    """Name of the camera in `robot.sensors`."""

    @cached_property
    def table(self) -> Rows:
        """A row for each image: pose and speeds at its time, everything else from the last row of data.csv before it.

        Raises:
            InputError: data.csv or spec.json of the run is damaged, or side/camera.csv of a camera of a log.
        """
        if self.settings.logged:
            times = read_image_times(self.folder / SIDE / CAMERA.file, self.whole.table)
            return rows_at(self.whole.table, times)
        return rows_at_images(self.whole.table, self.settings.period_s)

    @cached_property
    def image_table(self) -> Rows:
        return self.table

    @cached_property
    def specification(self) -> dict[str, Any]:
        """The specification of the run with this camera in the place of that of data.csv.

        Raises:
            InputError: The file is missing or damaged.
        """
        return specification_of(self.whole.specification, self.camera_name)

    @property
    def settings(self) -> SensorSection:
        """Settings of the camera, as side/spec.json of the run has them."""
        return self.whole.spec.robot.sensors[self.camera_name]

    def delivered(self, t_s: Array) -> NDArray[np.intp]:
        """Return the index (N,) of the newest image that was delivered by each of these times (N,).

        Before the first delivery it is that of the first image.
        """
        newest = np.searchsorted(self.t_s + self.settings.delay_s, t_s + 1e-9, side="right") - 1
        return np.maximum(newest, 0)

    @property
    def _side_tables(self) -> tuple[SideTable, ...]:
        return (CAMERA,)
