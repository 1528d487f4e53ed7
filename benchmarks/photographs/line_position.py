"""Where the line is in a row of an image: a regressor on oriented gradients, and two plain methods beside it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from line_frames import HEIGHT_PX, ROWS, WIDTH_PX, Array, LabelledFrames
from numpy.typing import NDArray

from symolo.core.random_streams import stream

Grey = NDArray[np.uint8]

_SEEN_PX = (160, 160, 112, 72)
"""Widths of the parts of the image that one stage after the other looks at, about the place found so far."""
_OFF_PX = (28.0, 16.0, 9.0, 4.0)
"""How far off that place may be: standard deviation of the places that a stage is trained from."""
_STARTS = (3, 2, 2, 3)
"""So many of them for each row of each image."""
_BAND_PX = 48
"""Height of the part that is looked at."""
_PATCH = (80, 48)
"""Width and height to which it is brought [px]."""
_FOLDS = 4
_RIDGES = (1.0, 10.0, 100.0, 1000.0)


@dataclass(frozen=True)
class Stage:
    """Ridge regression from the gradients about a place to how far the line is from there."""

    seen_px: int
    weights: Array
    """(F + 1,), the last one the constant."""
    ridge: float
    error_px: float
    """Median of the cross-validation, over scenes that were held out."""

    def step(self, described: Array) -> Array:
        return described @ self.weights[:-1] + self.weights[-1]


@dataclass(frozen=True)
class Regressor:
    """Supervised descent (Xiong and De la Torre 2013) from the image's middle to the line, in stages ever closer."""

    stages: tuple[Stage, ...]

    @classmethod
    def fit(cls, training: LabelledFrames) -> "Regressor":
        """Return a regressor; its ridges are chosen by cross-validation over the scenes of the training."""
        rng = stream(0, "starts")
        return cls(tuple(_stage(training, rng, *numbers) for numbers in zip(_SEEN_PX, _OFF_PX, _STARTS, strict=True)))

    def places(self, images: Grey) -> Array:
        """Return the places (N, len(ROWS)) [px] in images (N, H, W, 3)."""
        x_px = np.full((len(images), len(ROWS)), 0.5 * (WIDTH_PX - 1))
        grey = _grey(images)
        for stage in self.stages:
            x_px += stage.step(_described(grey, x_px, stage.seen_px))
        return x_px

    def settings(self) -> list[dict[str, float]]:
        return [{"ridge": stage.ridge, "cross_validated_median_px": stage.error_px} for stage in self.stages]


def constant(training: LabelledFrames) -> Callable[[Grey], Array]:
    """Return a method that always answers the mean of the training."""
    mean = float(np.mean(training.x_px))
    return lambda images: np.full((len(images), len(ROWS)), mean)


def dark_blob(images: Grey) -> Array:
    """Return the middle of the widest dark run in each row, (N, len(ROWS)); dark is by Otsu's threshold after
    smoothing."""
    middle_px = np.full((len(images), len(ROWS)), 0.5 * (WIDTH_PX - 1))
    for n, image in enumerate(_grey(images)):
        smooth = cv2.GaussianBlur(image, (0, 0), 2.0)
        _, dark = cv2.threshold(smooth, 0, 1, cv2.THRESH_BINARY_INV + cv2.THRESH_OTSU)
        for r, row in enumerate(ROWS):
            edges = np.flatnonzero(np.diff(np.concatenate([[0], dark[round(row)], [0]]).astype(int)))
            runs = edges.reshape(-1, 2)
            if len(runs):
                first, end = runs[np.argmax(runs[:, 1] - runs[:, 0])]
                middle_px[n, r] = 0.5 * (first + end - 1)
    return middle_px


def _stage(training: LabelledFrames, rng: np.random.Generator, seen_px: int, off_px: float, starts: int) -> Stage:
    described, missing, groups = [], [], []
    for images, x_px in _mirrored(training):
        grey = _grey(images)
        for _ in range(starts):
            start = x_px + off_px * rng.standard_normal(x_px.shape)
            described.append(_described(grey, start, seen_px).reshape(x_px.size, -1))
            missing.append((x_px - start).ravel())
            groups.append(np.repeat(training.group, len(ROWS)))
    x, y, group = np.concatenate(described), np.concatenate(missing), np.concatenate(groups)
    x = np.column_stack([x, np.ones(len(x), np.float32)])
    fold = np.unique(group, return_inverse=True)[1] % _FOLDS
    parts = [(x[fold == k].T @ x[fold == k], x[fold == k].T @ y[fold == k]) for k in range(_FOLDS)]
    square, across = sum(p[0] for p in parts), sum(p[1] for p in parts)
    scored = []
    for ridge in _RIDGES:
        errors = []
        for k, (fold_square, fold_across) in enumerate(parts):
            weights = _solved(square - fold_square, across - fold_across, ridge)
            errors.append(np.abs(x[fold == k] @ weights - y[fold == k]))
        scored.append((float(np.median(np.concatenate(errors))), ridge))
    error_px, ridge = min(scored)
    return Stage(seen_px, _solved(square, across, ridge), ridge, error_px)


def _solved(square: Array, across: Array, ridge: float) -> Array:
    """Return the weights of a ridge regression, in which the constant is free."""
    held = ridge * np.eye(len(square))
    held[-1, -1] = 0
    return np.linalg.solve(square + held, across)


def _described(grey: Grey, x_px: Array, seen_px: int) -> NDArray[np.float32]:
    """Return the gradients (N, len(ROWS), F) about the places (N, len(ROWS)) in images (N, H, W).

    They are histograms of signed gradients (Dalal and Triggs 2005), because the two edges of a line have opposite
    signs. Beyond its border an image continues with the values at the border.
    """
    hog = cv2.HOGDescriptor(
        _winSize=_PATCH, _blockSize=(16, 16), _blockStride=(8, 8), _cellSize=(8, 8), _nbins=9, _signedGradient=True
    )
    scale = seen_px / _PATCH[0]
    rows = []
    for image, places_px in zip(grey, x_px, strict=True):
        for row, x in zip(ROWS, places_px, strict=True):
            # From the patch's pixels to the image's; both have 0 in the middle of their first.
            to_image = np.array(
                [[scale, 0, x - scale * 0.5 * (_PATCH[0] - 1)], [0, _BAND_PX / _PATCH[1], row - 0.5 * (_BAND_PX - 1)]]
            )
            flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            patch = cv2.warpAffine(image, to_image, _PATCH, flags=flags, borderMode=cv2.BORDER_REPLICATE)
            rows.append(hog.compute(patch).ravel())
    return np.array(rows, np.float32).reshape(*x_px.shape, -1)


def _mirrored(known: LabelledFrames) -> Iterator[tuple[Grey, Array]]:
    """Yield the images as they are, mirrored left to right, upside down, and both, with the labels of the same rows."""
    if not np.allclose(np.array(ROWS)[::-1], HEIGHT_PX - 1 - np.array(ROWS)):
        raise ValueError("mirrored images have other rows")
    for images, x_px in ((known.images, known.x_px), (known.images[:, ::-1], known.x_px[:, ::-1])):
        yield images, x_px
        yield images[:, :, ::-1], WIDTH_PX - 1 - x_px


def _grey(images: Grey) -> Grey:
    """Return grey images (N, H, W)."""
    return np.array([cv2.cvtColor(np.ascontiguousarray(p), cv2.COLOR_BGR2GRAY) for p in images], np.uint8)
