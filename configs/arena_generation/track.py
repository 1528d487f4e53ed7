"""A line that is defined by lengths and curvatures, from which its poses and its pieces follow."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from configs.schema.arena import ArcPiece, LinePiece, StraightPiece
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class Segment:
    """A straight or an arc of a line, by length and curvature."""

    length_m: float
    curvature_1_m: float
    """Curvature, positive to the left, 0 for a straight."""


@dataclass(frozen=True)
class Track:
    """Segments end to end, whose tangent is always continuous."""

    begin: PlanarPose
    segments: tuple[Segment, ...]
    start_m: float = 0.0
    """Distance along the track at which the robot starts."""

    @property
    def length_m(self) -> float:
        return sum(segment.length_m for segment in self.segments)

    @cached_property
    def begins(self) -> list[PlanarPose]:
        """Poses at the beginning of each segment, and at the end of the track."""
        poses = [self.begin]
        for segment in self.segments:
            length_m, curvature_1_m = np.array([segment.length_m]), np.array([segment.curvature_1_m])
            x, y, yaw = _along(np.array(poses[-1:]), curvature_1_m, length_m)[0].tolist()
            poses.append((x, y, yaw))
        return poses

    @cached_property
    def offsets(self) -> Array:
        """(segments + 1,), distance along the track at the beginning of each segment, and at the end."""
        return np.concatenate([[0.0], np.cumsum([segment.length_m for segment in self.segments])])

    def poses(self, s: Array) -> Array:
        """Return poses (N, 3) at distances s (N,) along the track, within its length."""
        which = np.clip(np.searchsorted(self.offsets, s, side="right") - 1, 0, len(self.segments) - 1)
        begins, curvatures_1_m = self._bends
        return _along(begins[which], curvatures_1_m[which], s - self.offsets[which])

    @cached_property
    def _bends(self) -> tuple[Array, Array]:
        """Poses (segments, 3) at which segments begin, and their curvatures (segments,) [1/m]."""
        return np.array(self.begins[:-1]), np.array([segment.curvature_1_m for segment in self.segments])

    def mirrored(self) -> "Track":
        """Return the line with left and right exchanged, from the same beginning."""
        return replace(self, segments=tuple(Segment(s.length_m, -s.curvature_1_m) for s in self.segments))

    def pieces(self) -> tuple[LinePiece, ...]:
        """Return the pieces of the schema, in the direction of travel."""
        begins = self.begins
        return tuple(
            _piece(segment, begin, end) for segment, (begin, end) in zip(self.segments, pairwise(begins), strict=True)
        )


def _along(begins: Array, curvatures_1_m: Array, s: Array) -> Array:
    """Return poses (N, 3) at distances s (N,) from poses `begins` (N, 3) along arcs with these curvatures (N,)."""
    turned = curvatures_1_m * s
    # The length of the chord of the arc; sinc is 1 for a straight, so there is no division by a curvature of 0.
    chord = s * np.sinc(0.5 * turned / np.pi)
    heading = begins[:, 2] + 0.5 * turned
    offsets = np.stack([chord * np.cos(heading), chord * np.sin(heading), turned], axis=1)
    return begins + offsets


def _piece(segment: Segment, begin: PlanarPose, end: PlanarPose) -> LinePiece:
    if segment.curvature_1_m == 0:
        return StraightPiece(kind="straight", start=begin[:2], end=end[:2])
    x, y, yaw = begin
    to_left_m = 1 / segment.curvature_1_m
    start_deg = math.degrees(math.remainder(yaw - math.copysign(math.pi / 2, to_left_m), 2 * math.pi))
    return ArcPiece(
        kind="arc",
        center=(x - to_left_m * math.sin(yaw), y + to_left_m * math.cos(yaw)),
        radius_m=abs(to_left_m),
        start_deg=start_deg,
        end_deg=start_deg + math.degrees(segment.curvature_1_m * segment.length_m),
    )
