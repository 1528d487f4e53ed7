"""Images and poses for PyTorch, which is needed only here."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from symolo.core.errors import EnvironmentLacking, InputError
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Pixels


class Frame(NamedTuple):
    """One item; in a batch, each field has one more dimension in front."""

    image: Any
    """(3, H, W), float32, red, green, blue in 0..1; or what the transform makes of the pixels."""
    pose: Any
    """(3,), float64, x [m], y [m], theta [rad] of the robot in W."""
    X_WC: Any
    """(4, 4), float64, pose of the camera in W."""
    t_s: float
    run: str


def torch_dataset(data: Dataset, transform: Callable[[Pixels], Any] | None = None) -> Any:  # noqa: ANN401 - of torch
    """Return a map-style `torch.utils.data.Dataset` with a `Frame` for each image, which is decoded when requested.

    Args:
        data: Dataset that `load` returned.
        transform: Function of the pixels, (H, W, 3) uint8 RGB; by default it returns a tensor (3, H, W) from 0 to 1.

    Raises:
        InputError: No run has images.
        EnvironmentLacking: PyTorch is not installed.
    """
    if not data.images:
        raise InputError("there are no images", where=str(data.root), cure="render runs with `symolo rerender`")
    try:
        torch = import_module("torch")
    except ImportError:
        raise EnvironmentLacking("PyTorch is missing; run: pip install torch") from None
    images = data.images

    class Frames(torch.utils.data.Dataset):
        def __len__(self) -> int:
            return len(images)

        def __getitem__(self, index: int) -> Frame:
            image = images[index]
            pixels = image.pixels()
            planes = np.ascontiguousarray(pixels.transpose(2, 0, 1), dtype=np.float32) / 255
            shown = torch.from_numpy(planes) if transform is None else transform(pixels)
            pose, X_WC = (torch.from_numpy(np.array(pose)) for pose in (image.pose, image.X_WC))
            return Frame(shown, pose, X_WC, image.t_s, image.run.name)

        def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
            """Let pickle rebuild the dataset in spawned workers of a loader, which cannot import this local class."""
            return torch_dataset, (data, transform)

    return Frames()
