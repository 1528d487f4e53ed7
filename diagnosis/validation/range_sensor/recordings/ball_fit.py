"""The ball and its place that explain a scan best, for a range sensor with its effects.

The scan is over a near object in front of a far board. The part of the object that the beam sees is taken for a ball,
whose place, distance and radius are not known. Sums over a beam have steps where single rays leave the ball; here each
ray stands for its part of the beam, and slides off the ball with it, so that the sums are smooth and can be fitted.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import TofMount, TofSensor
from diagnosis.measured.channel import Mask
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording
from physics.robot.model import applied
from sensors.ranging.tof import beam_profile, head_on_factor, ray_directions, ray_pattern
from symolo.core.arrays import Array

INNER_MM = 30.0
"""Distance from the nearest reading up to which readings are of the ball alone, or nearly."""
MIN_INNER = 12
START_RADIUS_MM = 40.0
MIN_RADIUS_MM, MAX_RADIUS_MM = 5.0, 500.0
RAYS = 720
STEP_MM, WHOLE_MM = 2.0, 10.0
"""Distance between the places at which the range is computed, and length to which their row is rounded up; between
them the range is interpolated."""
DIFFERENCE = 1e-3
"""Relative step of the numerical slope of the fit."""
CONVERGED = 1e-10
"""Relative change at which the fit ends; slopes of a diagnosis are differences of such fits."""

Law = Callable[[float, float, Array], Array]
"""Nearest distance of the ball [m], its radius [m] and lateral distances (S,) of the sensor's axis from its centre [m]
-> readings (S,) [m]."""


@dataclass(frozen=True)
class HalfScan:
    """Points of the scan from the middle of the ball to the side where nothing holds the ball."""

    points: NDArray[np.int64]
    """(P,), indices of the points in the scan."""
    places_mm: Array
    """(P, 2), x and y of the points."""
    reading_mm: Array
    """(P,), settled readings."""
    board_mm: float

    @classmethod
    def from_scan(cls, scan: ScanRecording) -> "HalfScan":
        """Return the side of the scan on which the board is seen at the rim; the other one shows a holder."""
        settled = scan.settled_mm
        middle = float(np.median(scan.y_mm[settled < settled.min() + 0.3 * INNER_MM]))
        first, last = (np.median(settled[scan.y_mm == end]) for end in (scan.y_mm.min(), scan.y_mm.max()))
        outward = 1.0 if last >= first else -1.0
        points = np.flatnonzero(outward * (scan.y_mm - middle) >= -0.5 * START_RADIUS_MM)
        places = np.stack([scan.x_mm, scan.y_mm], axis=1)[points]
        return cls(points, places, settled[points], float(last if outward > 0 else first))

    @property
    def inner(self) -> Mask:
        """(P,), points that see the ball alone, or nearly."""
        return self.reading_mm < self.reading_mm.min() + INNER_MM

    @property
    def shows_a_ball(self) -> bool:
        """Whether there is a near object in front of a far board."""
        is_far = self.board_mm >= self.reading_mm.min() + 3.0 * INNER_MM
        return bool(is_far and np.count_nonzero(self.inner) >= MIN_INNER)


@dataclass(frozen=True)
class Ball:
    """A ball in front of the sensor, which stands for the near object of a scan."""

    x_mm: float
    """Place of the middle of the ball along x of the scan."""
    y_mm: float
    """Place of the middle of the ball along y of the scan."""
    nearest_mm: float
    """Distance from the plane of the sensor to the ball."""
    radius_mm: float

    def from_middle_mm(self, places_mm: Array) -> Array:
        """Return the distances (P,) of places (P, 2) from the ball's middle."""
        return np.hypot(*(places_mm - (self.x_mm, self.y_mm)).T)

    def readings_mm(self, law: Law, places_mm: Array) -> Array:
        """Return the readings (P,) at places (P, 2)."""
        off_mm = self.from_middle_mm(places_mm)
        # The same places for balls that differ little, so that the law may return its last result again.
        at_mm = np.arange(0.0, WHOLE_MM * (np.ceil(off_mm.max() / WHOLE_MM) + 1.0), STEP_MM)
        table = law(1e-3 * self.nearest_mm, 1e-3 * self.radius_mm, 1e-3 * at_mm)
        return np.interp(off_mm, at_mm, 1e3 * table)


def with_last_result(law: Law) -> Law:
    """Return the law with its last result cached: a fit moves a ball sideways more often than it changes it."""
    last: list[tuple[tuple[float, float, int], Array]] = []

    def cached(nearest_m: float, radius_m: float, off_m: Array) -> Array:
        key = (nearest_m, radius_m, len(off_m))
        if not last or last[0][0] != key:
            last[:] = [(key, law(nearest_m, radius_m, off_m))]
        return last[0][1]

    return cached


def fitted_ball(law: Law, places_mm: Array, reading_mm: Array) -> Ball:
    """Return the ball whose readings at places (P, 2) are nearest to those measured (P,), by least squares."""
    from scipy.optimize import least_squares  # noqa: PLC0415 - takes long to load, and only scans need it

    law = with_last_result(law)
    nearest = float(reading_mm.min())
    x_mm, y_mm = places_mm[reading_mm < nearest + 0.3 * INNER_MM].mean(axis=0).tolist()

    def residual(values: Array) -> Array:
        return Ball(*values.tolist()).readings_mm(law, places_mm) - reading_mm

    solution = least_squares(
        residual,
        (x_mm, y_mm, nearest, START_RADIUS_MM),
        bounds=([-1e4, -1e4, 1.0, MIN_RADIUS_MM], [1e4, 1e4, 2e3, MAX_RADIUS_MM]),
        x_scale=(1.0, 1.0, 1.0, 5.0),
        diff_step=DIFFERENCE,
        ftol=CONVERGED,
        xtol=CONVERGED,
        gtol=CONVERGED,
    )
    return Ball(*solution.x.tolist())


class SmoothBeam:
    """The beam of a range sensor that looks along the x axis at a ball in front of a board.

    Both halves of the beam see the same, so that only the upper one is computed.
    """

    def __init__(self, tof: TofSensor, effects: RobotEffects) -> None:
        half_cone = 0.5 * np.radians(tof.field_of_view_deg)
        angle, roll = ray_pattern(RAYS, 2.0 * half_cone)
        upper = np.sin(roll) >= 0.0
        angle, roll = angle[upper], roll[upper]
        self._rays = ray_directions(TofMount(x_m=0.0, y_m=0.0, z_m=1.0, yaw_deg=0.0), angle, roll)
        self._profile = beam_profile(tof, angle)
        self._weighting = effects.functions(Slot.RAY_WEIGHT)
        self._head_on = head_on_factor(self._profile, angle, self._weighting)
        # The part of the beam that a ray stands for is as wide as the rays are apart.
        self._apart_rad = half_cone * np.sqrt(np.pi / RAYS)

    def seen(self, nearest_m: float, radius_m: float, board_m: float, off_m: Array) -> tuple[Array, Array]:
        """Return mean range [m] and angle of incidence [rad] of the sensor at lateral distances from the ball, (S,)."""
        ahead, count = self._rays, len(self._rays)
        # From the sensor to the centre of the ball, (S, 3), and that along each ray, (S, rays).
        to_centre = np.stack([np.full_like(off_m, nearest_m + radius_m), -off_m, np.zeros_like(off_m)], axis=1)
        along = to_centre @ ahead.T
        passing = np.sqrt(np.maximum((to_centre**2).sum(axis=1)[:, None] - along**2, 0.0))
        half_chord = np.sqrt(np.maximum(radius_m**2 - passing**2, 0.0))
        on_ball = np.clip(0.5 + (radius_m - passing) / (self._apart_rad * along), 0.0, 1.0)
        distance = np.concatenate([along - half_chord, np.broadcast_to(board_m / ahead[:, 0], along.shape)], axis=1)
        lit = np.concatenate([on_ball * half_chord / radius_m, (1.0 - on_ball) * ahead[:, 0]], axis=1)
        weight = applied(self._weighting, np.tile(self._profile, 2) * lit, distance)
        share = weight / weight.sum(axis=1, keepdims=True)
        range_m = self._head_on * (share * distance).sum(axis=1)
        by_ball, by_board = (part.sum(axis=1)[:, None] for part in (share[:, :count], share[:, count:]))
        outward = ((share * distance)[:, :count] @ ahead - by_ball * to_centre) / radius_m
        normal = outward + by_board * (-1.0, 0.0, 0.0)
        # What the lower half adds cancels the part of the normal that points up.
        facing = -normal[:, 0] / np.hypot(normal[:, 0], normal[:, 1])
        return range_m, np.arccos(np.clip(facing, -1.0, 1.0))
