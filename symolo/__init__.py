"""Datasets in Python: `symolo.load(path)`; docs/reader.md.

The names are loaded when they are first used, so that a program that needs only a part of the library loads only that.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from symolo.core.errors import EnvironmentLacking, InputError
    from symolo.evaluation.estimate import EstimatedTrajectory
    from symolo.evaluation.estimate_file import read_estimate
    from symolo.evaluation.evaluate import Evaluation, evaluate
    from symolo.reader.dataset import Dataset, load
    from symolo.reader.run import Run
    from symolo.reader.run_folder import Image
    from symolo.reader.torch_frames import Frame, torch_dataset

__all__ = [
    "Dataset",
    "EnvironmentLacking",
    "EstimatedTrajectory",
    "Evaluation",
    "Frame",
    "Image",
    "InputError",
    "Run",
    "evaluate",
    "load",
    "read_estimate",
    "torch_dataset",
]

_MODULES = {
    "EnvironmentLacking": "symolo.core.errors",
    "InputError": "symolo.core.errors",
    "EstimatedTrajectory": "symolo.evaluation.estimate",
    "Evaluation": "symolo.evaluation.evaluate",
    "evaluate": "symolo.evaluation.evaluate",
    "read_estimate": "symolo.evaluation.estimate_file",
    "Dataset": "symolo.reader.dataset",
    "load": "symolo.reader.dataset",
    "Image": "symolo.reader.run_folder",
    "Run": "symolo.reader.run",
    "Frame": "symolo.reader.torch_frames",
    "torch_dataset": "symolo.reader.torch_frames",
}
"""The module that defines each public name."""


def __getattr__(name: str) -> Any:  # noqa: ANN401 - any of the public names
    """Return a public name, loaded from its module.

    Raises:
        AttributeError: The library has no such name.
    """
    if name == "__version__":
        return version("symolo")
    if name not in _MODULES:
        raise AttributeError(f"module 'symolo' has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)
