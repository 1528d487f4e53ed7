"""Settings of a robot or an arena that do not fit its other settings, and are probably in another unit."""

from collections.abc import Iterator

from configs.schema.scenario import RunSpec
from pipeline.run_warnings.suspicion import Suspicion
from symolo.arena.footprints import obstacle_footprint

LINE_SENSORS = 8
MAX_SENSOR_WIDTH = 1.15
"""Largest distance of the outer ones, relative to the width of the body, that is usual."""
MIN_TIME_CONSTANT_S = 3e-4
"""A tenth of the mechanical time constant of quick coreless motors. It does not depend on the gear: R J / K^2."""
MIN_FRICTION = 0.05
"""Friction of a wheel below which it slides: rubber has 0.5 to 1, and steel on ice 0.03."""
MAX_REACH = 1.25
"""Largest reach of an obstacle, relative to that of the floor: boxes at its edge may enclose it."""
Unusual = tuple[str, float | tuple[float, ...], str]
"""Field, its value, and what it means."""


def unusual_sizes(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the settings that do not fit others of the run, unless they were drawn."""
    candidates = (*_line_sensor(spec), *_wall_distance(spec), *_motor(spec), *_wheels(spec), *_obstacles(spec))
    for field, value, text in candidates:
        if not any(name == field or name.startswith(f"{field}.") for name in spec.drawn):
            shown = str(list(value)) if isinstance(value, tuple) else f"{value:g}"
            yield Suspicion(f"{field} unusual", f"{field} {shown} means that {text}")


def _line_sensor(spec: RunSpec) -> Iterator[Unusual]:
    pitch_m, body_m = spec.robot.line_sensor.pitch_m, spec.robot.chassis.width_m
    width_m = (LINE_SENSORS - 1) * pitch_m
    if width_m > MAX_SENSOR_WIDTH * body_m:
        instead = f"if it is the distance of the outer ones, write pitch_m: {pitch_m / (LINE_SENSORS - 1):.3g}"
        yield (
            "robot.line_sensor.pitch_m",
            pitch_m,
            f"the line sensor, {width_m:.3g} m, is wider than the body, {body_m:g} m; {instead}",
        )


def _wall_distance(spec: RunSpec) -> Iterator[Unusual]:
    """Yield a distance to the followed wall at which the body is well within it."""
    mounts, chassis = spec.robot.tof.mounts, spec.robot.chassis
    distance_m = spec.robot.controller.wall.target_distance_m
    beyond_m = 0.5 * chassis.width_m - max(abs(mounts.left.y_m), abs(mounts.right.y_m))
    if spec.arena.walls and distance_m < 0.5 * beyond_m:
        text = f"the body, which reaches {beyond_m:.3g} m farther to the side than the sensor, touches the wall"
        yield "robot.controller.wall.target_distance_m", distance_m, text


def _motor(spec: RunSpec) -> Iterator[Unusual]:
    motor = spec.robot.motor
    inertia_kg_m2 = motor.rotor_inertia_kg_m2
    settles_s = inertia_kg_m2 * motor.winding_resistance_ohm / motor.torque_constant_N_m_A**2
    if 0.0 < settles_s < MIN_TIME_CONSTANT_S:
        text = (
            f"the motor alone is up to speed within {1e3 * settles_s:.2g} ms, and small motors need 3 ms or more;"
            " with a gear, write the inertia of the rotor times the square of the gear ratio"
        )
        yield "robot.motor.rotor_inertia_kg_m2", inertia_kg_m2, text


def _wheels(spec: RunSpec) -> Iterator[Unusual]:
    friction = spec.robot.drive.wheel_friction
    if friction < MIN_FRICTION:
        yield "robot.drive.wheel_friction", friction, "the wheels slide as on ice; rubber on a floor has 0.5 to 1"


def _obstacles(spec: RunSpec) -> Iterator[Unusual]:
    """Yield the obstacles that reach beyond the floor."""
    limit_m = spec.arena.floor.half_extent_m
    for index, obstacle in enumerate(spec.arena.obstacles):
        reach_m = max(max(map(abs, corner)) for corner in obstacle_footprint(obstacle).corners())
        if reach_m > MAX_REACH * limit_m and obstacle.mesh is None:
            length_m = max(obstacle.size)
            text = (
                f"{obstacle.name} reaches {reach_m:.3g} m from the middle, beyond the floor, which ends at"
                f" {limit_m:g} m (arena.floor.half_extent_m); if its {length_m:g} m are cm, write {0.01 * length_m:g}"
            )
            yield f"arena.obstacles.{index}.size", tuple(obstacle.size), text
