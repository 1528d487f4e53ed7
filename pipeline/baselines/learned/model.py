"""A trained model and its file: numbers only, in an npz archive, so that loading it runs no code."""

import hashlib
import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from configs.schema.scenario import RunSpec
from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.npz_file import Numbers, arrays_of
from symolo.core.files.plain_files import FileKind, read_named_file

Input = Literal["images", "ranges"]
INPUTS: tuple[Input, ...] = ("images", "ranges")
_ABOUT, _CELLS, _PRIOR, _WEIGHT = "about", "cells", "prior", "weight/"
_MAX_CELLS = 100_000
_MAX_RUNS = 100_000
_RUN_DIGITS = 16
_Fingerprint = Annotated[str, Field(min_length=_RUN_DIGITS, max_length=_RUN_DIGITS)]
_CURE = "name a file that `symolo train` wrote, or make one: symolo train DIR --out model.npz"


class ModelDescription(BaseModel):
    """Description of the network in a model file, as JSON."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    version: Literal[2] = 2
    arena: str = Field(min_length=64, max_length=64)
    """Fingerprint of the arena of the training runs."""
    inputs: tuple[Input, ...] = Field(min_length=1, max_length=2)
    x_m: float = Field(ge=-1e4, le=1e4)
    y_m: float = Field(ge=-1e4, le=1e4)
    cell_m: float = Field(gt=0, le=10)
    columns: int = Field(ge=1, le=10_000)
    rows: int = Field(ge=1, le=10_000)
    headings: int = Field(ge=1, le=360)
    temperature: float = Field(gt=0, le=100)
    """Divisor of the network's outputs, fitted to the runs for validation."""
    wrong: float = Field(gt=0, lt=1)
    """Share of the readings by which the network errs, fitted to the same runs."""
    seed: int = Field(ge=0)
    training_runs: tuple[_Fingerprint, ...] = Field(min_length=1, max_length=_MAX_RUNS)
    """Fingerprint of each run that trained the network."""
    validation_runs: tuple[_Fingerprint, ...] = Field(min_length=1, max_length=_MAX_RUNS)
    """Fingerprint of each run that was set aside and decided when training stopped."""
    epochs: int = Field(ge=1)
    made_with: dict[str, str]


@dataclass(frozen=True)
class LocalisationModel:
    """A network that estimates the pose from the readings of one row, with all that its use needs."""

    about: ModelDescription
    """Inputs, grid, origin of the training data and version, as the file states them."""
    likelihood: PoseLikelihood
    """Conversion of the heat map of the network into the likelihood of poses."""
    weights: Mapping[str, Array]
    """Parameters of the network by name, each (N,) or (N, K), in the order of the network."""

    def file_bytes(self) -> bytes:
        """Return the model as an npz archive; the same model gives the same bytes."""
        arrays: dict[str, Numbers] = {
            _ABOUT: np.frombuffer(canonical_json(self.about.model_dump(mode="json")), np.uint8),
            _CELLS: self.likelihood.cells,
            _PRIOR: self.likelihood.prior,
            **{_WEIGHT + name: values for name, values in self.weights.items()},
        }
        file = io.BytesIO()
        np.savez_compressed(file, **arrays)  # pyright: ignore[reportArgumentType]
        return file.getvalue()


def read_model(path: Path) -> LocalisationModel:
    """Read a model file, which may come from a stranger.

    Raises:
        InputError: It cannot be read, or it is no model.
    """
    try:
        data = read_named_file(path, FileKind.ANY)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path), cure=_CURE) from None
    try:
        arrays = arrays_of(data, FileKind.ANY.max_bytes)
        about = ModelDescription.model_validate_json(arrays[_ABOUT].astype(np.uint8).tobytes())
        grid = PoseGrid(about.x_m, about.y_m, about.cell_m, about.columns, about.rows, about.headings)
        cells, prior = arrays[_CELLS].astype(np.int64), arrays[_PRIOR].astype(float)
        weights = {name.removeprefix(_WEIGHT): arrays[name] for name in arrays if name.startswith(_WEIGHT)}
    except ValidationError as error:
        problem = "is a model that this version of symolo cannot read"
        raise InputError(f"{problem}: {_first_fault(error)}", where=str(path), cure=_CURE) from None
    except (zipfile.BadZipFile, ValueError, KeyError):
        raise InputError("is no model of `symolo train`, or is damaged", where=str(path), cure=_CURE) from None
    _check_cells(grid, cells, prior, path)
    if not all(np.isfinite(values).all() for values in weights.values()):
        raise InputError("has weights that are not finite", where=str(path), cure=_CURE)
    return LocalisationModel(about, PoseLikelihood(grid, cells, prior, about.wrong), weights)


def _first_fault(error: ValidationError) -> str:
    fault = error.errors()[0]
    return ": ".join((*map(str, fault["loc"]), fault["msg"]))


def _check_cells(grid: PoseGrid, cells: Numbers, prior: Array, path: Path) -> None:
    count = int(np.prod(grid.shape))
    fits = cells.ndim == 1 and prior.shape == cells.shape and 0 < len(cells) <= _MAX_CELLS and count <= 100 * _MAX_CELLS
    if not (fits and np.all(np.diff(cells) > 0) and cells[0] >= 0 and cells[-1] < count):
        raise InputError("has cells that do not fit its grid", where=str(path), cure=_CURE)
    if not (np.all(prior >= 0.0) and abs(prior.sum() - 1.0) < 1e-6):
        raise InputError("has a prior that is no distribution", where=str(path), cure=_CURE)


def run_fingerprint(spec: RunSpec) -> str:
    """Return the first 16 hexadecimal digits of the SHA-256 of a run's specification, which has route, number and seed.

    A copy of the run has the same one, whatever its folder is called.
    """
    return hashlib.sha256(canonical_json(spec.model_dump(mode="json"))).hexdigest()[:_RUN_DIGITS]
