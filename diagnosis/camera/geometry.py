"""Where the line's edges are in the images, against where a camera with deviations would see them.

The noise is that of the edges (texture, worn tape) and, for all edges of one image alike, that of its pose. Edges
are looked for thrice: widely around the nominal camera, then ever closer around the one that was found, so that a
camera that is several degrees off is still recognised, and the last points are free of mistaken edges.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.camera.case import CameraCase, Ints, Mask
from diagnosis.camera.features.edge_points import edges
from diagnosis.camera.features.line_points import ExpectedEdges, edge_candidates, expected_edges
from diagnosis.camera.fit import fitted
from diagnosis.camera.parameter import CameraNumber
from diagnosis.camera.views import GEOMETRY, CameraView, EdgePoints
from symolo.core.arrays import Array
from symolo.core.errors import InputError

REACHES = (0.1, 0.05, 0.03, 0.02)
"""How far to look for an edge in each round, as shares of the image's width."""
FIRST = ("pitch_down", "height", "yaw_left", "roll", "focal_length_scale")
"""Numbers that are freed while edges are still searched: those that move edges far."""
MIN_POINTS, MIN_PICTURES = 60, 4


@dataclass(frozen=True)
class EdgeModel:
    """Model of the measured edges; a sample is a distance across one edge [px]."""

    case: CameraCase
    points: EdgePoints
    measured: Array
    """(N, 2), pixels of the measured edges."""
    outwards: Array
    """(N, 2), unit vectors across the edge in the image."""
    width_px: Array
    """(N,), width of the line at each edge."""
    numbers: tuple[CameraNumber, ...] = GEOMETRY
    min_sd: float = 0.05
    max_independent: float = float("inf")

    @property
    def frame(self) -> Ints:
        return self.points.frame

    @cached_property
    def heldout(self) -> Mask:
        return self.case.heldout[self.frame]

    @property
    def fit(self) -> Mask:
        return ~self.heldout

    def residuals(self, x: Array) -> Array:
        return ((self.measured - CameraView(self.case, x).pixels(self.points)) * self.outwards).sum(axis=1)

    def frame_slopes(self, x: Array) -> Array:
        """Return the changes by one standard deviation of the pose: ahead, left and turned."""
        errors = self.case.pose_errors
        view, found = CameraView(self.case, x), []
        for k, sd in enumerate((errors.position_m, errors.position_m, np.radians(errors.yaw_deg))):
            moved = np.zeros((len(self.points), 3))
            moved[:, k] = 0.5 * sd
            step = view.pixels(self.points, moved=moved) - view.pixels(self.points, moved=-moved)
            found.append(np.nan_to_num((step * self.outwards).sum(axis=1)))
        return np.stack(found, axis=1)


def measure(case: CameraCase, light: list[Array]) -> EdgeModel:
    """Measure the edges in the light (H, W) of each image.

    Raises:
        InputError: Too little of the line is seen.
    """
    candidates = edge_candidates(case.arena)
    x = np.zeros(len(GEOMETRY))
    first = [k for k, number in enumerate(GEOMETRY) if number.name in FIRST]
    model = None
    for step, share in enumerate(REACHES):
        sighting = expected_edges(CameraView(case, x), candidates, margin_px=0.02 * case.size_px[0])
        model = _measured(case, sighting, light, share * case.size_px[0])
        _check(model)
        if step < len(REACHES) - 1:
            x = fitted(model, first, x).x
    if model is None:
        raise AssertionError
    return model


def _measured(case: CameraCase, sighting: ExpectedEdges, light: list[Array], reach_px: float) -> EdgeModel:
    dark = case.arena.line.reflectance < case.arena.floor_reflectance
    off, found = edges(sighting, light, reach_px, dark=dark)
    at = sighting.pixels + off[:, None] * sighting.outwards
    points = sighting.points
    kept = EdgePoints(points.frame[found], points.on_line[found], points.outwards[found])
    return EdgeModel(case, kept, at[found], sighting.outwards[found], sighting.width_px[found])


def _check(model: EdgeModel) -> None:
    images = len(np.unique(model.frame[model.fit]))
    if len(model.points) >= MIN_POINTS and images >= MIN_PICTURES:
        return
    raise InputError(
        f"the line's edges are found at {len(model.points)} points of {images} images",
        where=model.case.name,
        allowed=f"at least {MIN_POINTS} points of {MIN_PICTURES} images",
        cure="give images that show the line, with their poses on this map (--simulated, or --arena and --robot)",
    )
