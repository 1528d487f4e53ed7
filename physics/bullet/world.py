"""Bodies of an arena in a PyBullet client, and the collision groups that decide what may touch what."""

from math import cos, sin

import pybullet

from physics.robot.body_inertia import GRAVITY_M_S2
from symolo.arena.geometry import Arena, Box

RAYS, BOXES, CHASSIS, TREADS, FLOOR = 1, 2, 4, 8, 16
"""Collision groups: treads (wheels and caster) meet the floor only, the chassis meets walls and obstacles only.

Bullet puts its rays into group 1; tests compare them with `physics.arena.rays`. They pass through the robot.
"""

SOLVER_RESIDUAL = 1e-16
"""Residual at which the solver stops; Bullet's default 1e-7 lets a straight drive of 1 m drift 0.5 mm to one side."""


def connect(physics_hz: int) -> int:
    """Return a new client with its engine in this process, without a window."""
    client = int(pybullet.connect(pybullet.DIRECT))
    pybullet.setGravity(0, 0, -GRAVITY_M_S2, physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=1.0 / physics_hz,
        solverResidualThreshold=SOLVER_RESIDUAL,
        deterministicOverlappingPairs=1,
        physicsClientId=client,
    )
    return client


def add_arena(client: int, arena: Arena) -> dict[int, int]:
    """Add floor and boxes as fixed bodies; return the surface number (0 floor, 1 + i box i) by body id."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=[0, 0, 1], physicsClientId=client)
    floor = pybullet.createMultiBody(0, shape, physicsClientId=client)
    pybullet.changeDynamics(floor, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
    pybullet.setCollisionFilterGroupMask(floor, -1, FLOOR, TREADS | RAYS, physicsClientId=client)
    return {floor: 0} | {_add_box(client, box): 1 + i for i, box in enumerate(arena.boxes) if box.is_solid}


def _shape(client: int, box: Box) -> int:
    if box.mesh is None:
        half = [0.5 * size for size in box.size]
        return int(pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client))
    # The body's origin is the middle of the bounding box, as for a box.
    vertices = (box.mesh.vertices - (0.0, 0.0, 0.5 * box.size[2])).tolist()
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_MESH,
        vertices=vertices,
        indices=box.mesh.triangles.ravel().tolist(),
        flags=pybullet.GEOM_FORCE_CONCAVE_TRIMESH,
        physicsClientId=client,
    )
    return int(shape)


def _add_box(client: int, box: Box) -> int:
    shape = _shape(client, box)
    turn = [0.0, 0.0, sin(0.5 * box.yaw_rad), cos(0.5 * box.yaw_rad)]
    body = pybullet.createMultiBody(0, shape, basePosition=box.center, baseOrientation=turn, physicsClientId=client)
    pybullet.changeDynamics(body, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
    pybullet.setCollisionFilterGroupMask(body, -1, BOXES, CHASSIS | RAYS, physicsClientId=client)
    return int(body)
