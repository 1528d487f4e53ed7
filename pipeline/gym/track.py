"""The track around an arena, along the line and beside the walls, and how far a robot gets on it."""

import math
from dataclasses import dataclass

import numpy as np

from configs.schema.scenario import RunSpec
from pipeline.preview.path import Leg, PreviewPath
from symolo.arena.geometry import Arena
from symolo.core.geometry.poses import PlanarPose


@dataclass(frozen=True)
class TrackPlace:
    """The point of the track that is nearest to a robot."""

    distance_m: float
    """Distance of the middle of the axle from it; infinite in an arena without line and walls."""
    along: tuple[float, float]
    """Unit vector in the direction of driving there."""


@dataclass(frozen=True)
class DrivingTrack:
    """Legs in the direction in which the start of the run turns about their centre."""

    legs: tuple[Leg, ...]

    @classmethod
    def from_spec(cls, spec: RunSpec, arena: Arena) -> "DrivingTrack":
        return cls(PreviewPath.from_spec(spec, arena).legs)

    def nearest(self, x_m: float, y_m: float) -> TrackPlace:
        """Return the nearest point of the track to a point of the floor."""
        best_m, best_leg, best_s = math.inf, None, 0.0
        for leg in self.legs:
            if leg.piece.at_min_away_m(x_m, y_m) >= best_m:
                continue
            s, offset = (float(value[0]) for value in leg.piece.local(np.array([[x_m, y_m]])))
            nearest_s = min(max(s, 0.0), leg.piece.length_m)
            distance_m = math.hypot(s - nearest_s, offset)
            if distance_m < best_m:
                best_m, best_leg, best_s = distance_m, leg, nearest_s
        if best_leg is None:
            return TrackPlace(math.inf, (0.0, 0.0))
        yaw = best_leg.pose_at(best_leg.piece.length_m - best_s if best_leg.backwards else best_s)[2]
        return TrackPlace(best_m, (math.cos(yaw), math.sin(yaw)))

    def progress_m(self, before: PlanarPose, after: PlanarPose, within_m: float) -> tuple[float, float]:
        """Return how far a robot got along the track between two poses, and its distance from the track at the end.

        The progress is the displacement along the direction of the track, below 0 for a robot that drives backwards,
        and 0 for one that is further away from the track than `within_m`.
        """
        place = self.nearest(after[0], after[1])
        if place.distance_m > within_m:
            return 0.0, place.distance_m
        step = (after[0] - before[0]) * place.along[0] + (after[1] - before[1]) * place.along[1]
        return step, place.distance_m
