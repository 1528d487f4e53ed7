"""Moving obstacles in a PyBullet client: kinematic bodies, put in place with their velocity before every step.

Both are needed. A body that is placed alone has no velocity for the contact solver, which then pushes by the depth of
the overlap only: a box of 0.3 m/s that meets a free one of 1 kg sinks 3.8 mm into it at 1000 Hz, with its velocity set
0.1 mm. Bodies of no mass obey this; those in maximal coordinates do not.
"""

from collections.abc import Mapping, Sequence
from math import cos, sin

import numpy as np
import pybullet

from symolo.arena.geometry import Arena
from symolo.arena.obstacle_motion import ObstacleMotion

_BLOCK_STEPS = 500
"""Number of steps for which poses are computed at once."""


class MovingBoxes:
    """The moving obstacles of one PyBullet client."""

    def __init__(self, client: int, paths: Sequence[tuple[int, float, ObstacleMotion]], physics_hz: int) -> None:
        """Take over bodies, each given by its id, the height of its middle [m] and its path."""
        self._client = client
        self._paths = tuple(paths)
        self._physics_hz = physics_hz
        self._block: list[list[tuple[int, list[float], list[float], list[float], list[float]]]] = []
        self._first = 0

    @classmethod
    def from_arena(
        cls, client: int, arena: Arena, surface_of_body: Mapping[int, int], physics_hz: int
    ) -> "MovingBoxes | None":
        """Return the moving boxes of an arena, or None if nothing moves, which then costs nothing."""
        boxes = [(body, arena.boxes[surface - 1]) for body, surface in surface_of_body.items() if surface > 0]
        paths = [(body, box.center[2], box.motion) for body, box in boxes if box.motion is not None]
        return cls(client, paths, physics_hz) if paths else None

    def place(self, step: int) -> None:
        """Set every box to its pose and velocity at the beginning of a step."""
        if not self._first <= step < self._first + len(self._block):
            self._compute_block(step)
        for body, position, turn, velocity, spin in self._block[step - self._first]:
            pybullet.resetBasePositionAndOrientation(body, position, turn, self._client)
            pybullet.resetBaseVelocity(body, velocity, spin, self._client)

    def _compute_block(self, first: int) -> None:
        t_s = np.arange(first, first + _BLOCK_STEPS) / self._physics_hz
        self._first = first
        self._block = [[] for _ in t_s]
        for body, height_m, motion in self._paths:
            poses, rates = motion.poses_at(t_s).tolist(), motion.rates_at(t_s).tolist()
            for row, (x, y, yaw), (vx, vy, spin) in zip(self._block, poses, rates, strict=True):
                turn = [0.0, 0.0, sin(0.5 * yaw), cos(0.5 * yaw)]
                row.append((body, [x, y, height_m], turn, [vx, vy, 0.0], [0.0, 0.0, spin]))
