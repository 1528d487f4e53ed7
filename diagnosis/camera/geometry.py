"""Places of the line's edges in the images, compared with where a camera with deviations would see them.

The noise is that of the edges (texture, worn tape) and, for all edges of one image alike, that of its pose. Edges are
searched several times: widely around the nominal camera, then ever closer around the last fit, so that a camera that is
several degrees off is still recognised, and the last points are free of mistaken edges.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.camera.case import CameraCase, Ints
from diagnosis.camera.features.edge_points import measured_edges
from diagnosis.camera.features.line_points import LineEdges, edge_candidates, expected_edges
from diagnosis.camera.fit import fitted
from diagnosis.camera.model import CameraModel
from diagnosis.camera.views import GEOMETRY, CameraView
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.progress import plural

REACHES = (0.1, 0.05, 0.03, 0.02)
"""Distance up to which edges are searched in each round, as shares of the image's width."""
MARGIN = 0.02
"""Distance of an expected edge from the border, as a share of the image's width."""
FIRST = ("pitch_down", "height", "yaw_left", "roll", "focal_length_scale")
"""Parameters that are freed while edges are still searched: those that move edges far."""
MIN_POINTS, MIN_IMAGES = 60, 4


@dataclass(frozen=True)
class EdgeModel(CameraModel):
    """Measured edges; a sample is a distance across one edge [px]."""

    name = "geometry"
    unit = "px"
    min_sd = 0.05
    parameters = GEOMETRY

    case: CameraCase
    edges: LineEdges
    """The edges at the pixels where they were measured."""

    @property
    def frame(self) -> Ints:
        return self.edges.frame

    def residuals(self, x: Array) -> Array:
        return ((self.edges.pixels - CameraView(self.case, x).pixels(self.edges)) * self.edges.outwards).sum(axis=1)

    def frame_slopes(self, x: Array) -> Array:
        """Return the changes by one standard deviation of the pose: ahead, to the left and in heading."""
        errors, view = self.case.pose_errors, CameraView(self.case, x)
        slopes = []
        for k, sd in enumerate((errors.position_m, errors.position_m, np.radians(errors.yaw_deg))):
            half = np.zeros((len(self.edges), 3))
            half[:, k] = 0.5 * sd
            step = view.pixels(self.edges, half) - view.pixels(self.edges, -half)
            slopes.append(np.nan_to_num((step * self.edges.outwards).sum(axis=1)))
        return np.stack(slopes, axis=1)


def measured_geometry(case: CameraCase, light: list[Array]) -> EdgeModel:
    """Measure the edges in the light (H, W) of each image.

    Raises:
        InputError: Too little of the line is seen.
    """
    candidates = edge_candidates(case.arena)
    first = [k for k, parameter in enumerate(GEOMETRY) if parameter.name in FIRST]
    x = np.zeros(len(GEOMETRY))
    for reach in REACHES[:-1]:
        x = fitted(_measured(CameraView(case, x), candidates, light, reach), first, x).x
    return _measured(CameraView(case, x), candidates, light, REACHES[-1])


def _measured(view: CameraView, candidates: tuple[Array, Array, Ints], light: list[Array], reach: float) -> EdgeModel:
    """Measure the edges up to `reach` times the image's width from where a camera expects them."""
    case, width = view.case, view.case.size_px[0]
    expected = expected_edges(view, candidates, margin_px=MARGIN * width)
    edges, good = measured_edges(expected, light, reach * width, dark=case.line_is_dark)
    model = EdgeModel(case.heldout, case, edges.some(good))
    images = len(np.unique(model.frame[model.fit]))
    if len(model.edges) < MIN_POINTS or images < MIN_IMAGES:
        raise InputError(
            f"the line's edges are found at {plural(len(model.edges), 'point')} of {plural(images, 'image')}",
            where=case.name,
            allowed=f"at least {MIN_POINTS} points of {MIN_IMAGES} images",
            cure="give images that show the line, with poses on the map of the nominal run (--simulated)",
        )
    return model
