"""The interface of the measurements in images: samples, and the parameters of the camera that explain them."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from diagnosis.camera.case import Ints, Mask
from symolo.core.arrays import Array


@dataclass(frozen=True)
class CameraParameter:
    """A parameter of the camera that may differ from its nominal value."""

    name: str
    unit: str
    tolerance: float
    """Standard deviation between cameras of one kind, in `unit`."""
    meaning: str
    """Meaning of a positive deviation, as a part of a sentence."""
    causes: str
    """Possible causes, as a part of a sentence."""
    can_be_named: bool = True
    """Whether it belongs to the camera; the others are fitted along, since they change the images as well."""


@dataclass(frozen=True)
class CameraModel(ABC):
    """The samples of one aspect of the images: geometry, levels, noise or sharpness."""

    name: ClassVar[str]
    unit: ClassVar[str]
    """Unit of the samples, for reports."""
    parameters: ClassVar[tuple[CameraParameter, ...]]
    min_sd: ClassVar[float]
    """Smallest standard deviation of a sample that a fit assumes."""
    max_independent: ClassVar[float] = float("inf")
    """Largest number of independent samples of one image; all images of one floor show the same stains."""

    heldout_frames: Mask
    """(frames,), images that are held out."""

    @property
    @abstractmethod
    def frame(self) -> Ints:
        """Return the index of the image of each sample, (N,)."""

    @cached_property
    def heldout(self) -> Mask:
        """Return the samples that are held out, (N,)."""
        return self.heldout_frames[self.frame]

    @property
    def fit(self) -> Mask:
        """Return the samples for selection and fit, (N,)."""
        return ~self.heldout

    @abstractmethod
    def residuals(self, x: Array) -> Array:
        """Return measured minus predicted values for deviations (P,) in tolerances, (N,); NaN where unusable."""

    @abstractmethod
    def frame_slopes(self, x: Array) -> Array:
        """Return the change of the prediction by one standard deviation of each nuisance of an image, (N, Q)."""
