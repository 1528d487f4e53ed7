"""One image of a run: when and where it was taken, and its pixels when they are asked for."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.dataset.pixels import decoded

if TYPE_CHECKING:
    from symolo.reader.run import Run

Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class Image:
    run: "Run"
    number: int
    """As in the column `img` of data.csv, from 1."""
    index: int
    """Which of the run's images it is, from 0."""
    row: int
    """Which row of data.csv it was taken at, from 0; its stamp is that of the row."""

    @property
    def t_s(self) -> float:
        """Time since the start of the run: the middle of the exposure."""
        return float(self.run.table.t_ms[self.row]) / 1000

    @property
    def pose(self) -> Array:
        """(3,), x [m], y [m], theta [rad] of the robot in W."""
        return self.run.table.pose[self.row]

    @property
    def X_WC(self) -> Array:
        """(4, 4), pose of the camera in W; C is the optical frame, x right, y down, z forward."""
        return self.run.X_WC[self.index]

    @property
    def path(self) -> Path:
        return self.run.image_path(self.number)

    def pixels(self) -> Pixels:
        """(H, W, 3), uint8, red, green, blue.

        Raises:
            InputError: The file is missing or no picture.
        """
        found = _read(self.path)
        if found.ndim != 3 or found.dtype != np.uint8:
            raise InputError("is no picture in colour with 8 bits", where=str(self.path), cure="make the run again")
        return found

    def annotation(self, kind: str) -> np.ndarray:
        """(H, W) or (H, W, 3): an annotation as stored, channels red, green, blue; decoded in docs/annotations.md.

        Args:
            kind: depth, instance, semantic, normals, flow or free_floor.

        Raises:
            InputError: The run has no such annotation, this image has none of it, or the file is no picture.
        """
        return _read(self.annotation_path(kind))

    def annotation_path(self, kind: str) -> Path:
        """Of the picture of a kind.

        Raises:
            InputError: The run has no such annotation, or this image has none of it.
        """
        known = self.run.annotation_pictures
        if kind not in known:
            raise _lacking(f"annotation {kind}", known, kind, str(self.run.folder))
        path = self.run.annotation_picture(kind, self.number)
        if kind == "flow" and not path.exists() and self.number == self.run.numbers[-1]:
            raise InputError(f"image {self.number} is the last, which has no flow", where=str(self.run.folder))
        return path

    def mask(self, name: str) -> NDArray[np.bool_]:
        """(H, W): where a category (`line`, `wall`...) or an instance (as the arena calls it) is seen.

        Raises:
            InputError: There is neither of this name, or the run has no such pictures.
        """
        document = self.run.annotations
        categories = {one.name: one.id for one in document.categories}
        instances = {one.name: one.id for one in document.instances}
        if name in categories and "semantic" in self.run.annotation_pictures:
            return self.annotation("semantic") == categories[name]
        if name in categories:
            of_nothing = [0] if categories[name] == 0 else []  # the sky, where no surface is met
            ids = [one.id for one in document.instances if one.category_id == categories[name]]
            return np.isin(self.annotation("instance"), np.array(of_nothing + ids, dtype=np.uint16))
        if name in instances:
            return self.annotation("instance") == instances[name]
        raise _lacking(f"mask {name}", (*categories, *instances), name, str(self.run.folder))


def _lacking(what: str, known: tuple[str, ...], name: str, where: str) -> InputError:
    allowed = ", ".join(known) or "none: release it with `--set render.annotations=[instance,semantic]`"
    return InputError(f"has no {what}", where=where, allowed=allowed, nearest=nearest(name, known))


def _read(path: Path) -> np.ndarray:
    try:
        found = decoded(path)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    if found is None:
        what = "is no picture" if path.exists() else "is missing"
        raise InputError(what, where=str(path), cure="`symolo verify` and `symolo repair` take the whole release")
    return found if found.ndim == 2 else np.ascontiguousarray(found[..., ::-1])
