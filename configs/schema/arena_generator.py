"""Recipe of a generated arena: numbers that each run may draw, and the room that every arena leaves."""

from typing import Annotated

from pydantic import Field, model_validator

from configs.schema.appearance.surface import SurfaceName
from configs.schema.base import FromList, Section, disagreement


class Clearance(Section):
    """Room that every generated arena leaves, measured from the line's middle unless stated otherwise.

    The defaults are for robot `nominal`, 0.18 x 0.17 m, with its straight avoidance path of 0.68 m, 0.19 m to the side.
    """

    stretches_m: float = Field(default=0.25, ge=0.02, le=5)
    """Distance between two parts of the line: the sensor row's 67 mm, and as much again for deviations on both."""
    beside_m: float = Field(default=0.16, ge=0.02, le=5)
    """Distance to everything that must not be touched: half the robot's width, 35 mm for its corners, 40 mm reserve."""
    ahead_m: float = Field(default=0.32, ge=0.02, le=5)
    """Distance from the front sensor to bodies beside the line; below 0.20 m they would count as obstacles."""
    before_m: float = Field(default=0.50, ge=0.02, le=5)
    """Length of straight line before an obstacle's middle: 0.33 m, at which passing begins, and a margin to line up."""
    after_m: float = Field(default=0.62, ge=0.02, le=5)
    """Length of straight line after an obstacle's middle: the rest of the path, and a margin to settle on the line."""
    obstacle_reach_m: float = Field(default=0.10, ge=0.005, le=5)
    """Distance from the line to the far edge of an obstacle: the path's 0.19 m minus half the robot's width."""
    passing_m: float = Field(default=0.35, ge=0.02, le=5)
    """Room on the side of the passing: the path's 0.19 m, half the robot's diagonal, and 35 mm reserve."""
    other_side_m: float = Field(default=0.20, ge=0.02, le=5)
    """Room on the other side, for a robot that meets the line at 45 degrees and overshoots it."""
    free_side_m: float = Field(default=0.52, ge=0.02, le=5)
    """Smallest reading of the side sensor on the side of the passing; the robot requires 0.42 m."""
    blocked_side_m: float = Field(default=0.36, ge=0.02, le=5)
    """Largest reading of the left sensor where an obstacle is passed on the right."""
    regained_side_m: float = Field(default=0.38, ge=0.02, le=5)
    """Smallest distance of boxes from a side sensor where the robot overshoots the line after an obstacle. While the
    robot sees no line, it follows any body within 0.34 m as if it were a wall."""


class ArenaGenerator(Section):
    """A closed line of straights and arcs around a random polygon, walls around it, boxes on it and beside it.

    The line is straight at the start of the route. Each number may be a distribution, drawn per run; what differs
    within one arena is drawn between `min_` and `max_`.
    """

    corners: int = Field(default=5, ge=3, le=12)
    """Number of corners of the polygon that the line follows with rounded corners."""
    radius_m: float = Field(default=1.1, ge=0.3, le=20)
    """Mean distance of the corners from the middle of the polygon."""
    irregularity: float = Field(default=0.3, ge=0, le=0.9)
    """Largest relative deviation of a corner's distance, and of its direction from even spacing."""
    elongation: float = Field(default=1.0, ge=1, le=4)
    """Ratio of length to width."""
    clockwise: bool = False
    """Whether the robot drives clockwise."""
    min_bend_radius_m: float = Field(default=0.22, ge=0.05, le=5)
    """Smallest radius of a bend of the line [m]."""
    max_bend_radius_m: float = Field(default=0.60, ge=0.05, le=5)
    """Largest radius of a bend of the line [m]."""
    walls: int = Field(default=4, ge=0, le=12)
    """Number of walls of the enclosure; 4 make a rectangle, 0 is no enclosure."""
    min_wall_clearance_m: float = Field(default=0.35, ge=0.02, le=10)
    """Smallest distance between the line and a wall."""
    max_wall_clearance_m: float = Field(default=0.90, ge=0.02, le=10)
    """Largest distance between the line and a wall [m]."""
    wall_height_m: float = Field(default=0.15, ge=0.01, le=3)
    """Height of the walls [m]."""
    min_obstacles: int = Field(default=0, ge=0, le=12)
    """Smallest number of boxes on the line."""
    max_obstacles: int = Field(default=1, ge=0, le=12)
    """Largest number of boxes to be passed, on straight parts of the line; fewer if there is no room."""
    min_obstacle_m: float = Field(default=0.08, ge=0.01, le=1)
    """Smallest length and width of a box on the line [m]."""
    max_obstacle_m: float = Field(default=0.10, ge=0.01, le=1)
    """Largest length and width of a box on the line [m]."""
    max_obstacle_offset_m: float = Field(default=0.01, ge=0, le=1)
    """Largest distance between the middles of line and obstacle."""
    max_obstacle_yaw_deg: float = Field(default=15, ge=0, le=45)
    """Largest rotation of an obstacle against the line."""
    max_decoys: int = Field(default=3, ge=0, le=40)
    """Largest number of boxes beside the line, not to be touched; fewer if there is no room."""
    min_decoy_m: float = Field(default=0.05, ge=0.01, le=1)
    """Smallest length and width of a box beside the line [m]."""
    max_decoy_m: float = Field(default=0.15, ge=0.01, le=1)
    """Largest length and width of a box beside the line [m]."""
    max_decoy_distance_m: float = Field(default=0.60, ge=0.05, le=10)
    """Largest distance from the line to the middle of a decoy."""
    surfaces: Annotated[tuple[SurfaceName, ...], FromList, Field(min_length=1)] = ("white_board", "cardboard", "wood")
    """Surfaces of walls and boxes, all equally likely."""
    clearance: Clearance = Clearance()

    @model_validator(mode="after")
    def _ranges_and_sides(self) -> "ArenaGenerator":
        for lower, upper in (
            ("min_bend_radius_m", "max_bend_radius_m"),
            ("min_wall_clearance_m", "max_wall_clearance_m"),
            ("min_obstacles", "max_obstacles"),
            ("min_obstacle_m", "max_obstacle_m"),
            ("min_decoy_m", "max_decoy_m"),
        ):
            low, high = getattr(self, lower), getattr(self, upper)
            if low > high:
                raise disagreement(lower, low, f"at most {upper}, which is {high}")
        if self.walls in {1, 2}:
            raise disagreement("walls", self.walls, "0, or 3 or more, because 1 or 2 enclose nothing")
        if self.min_bend_radius_m < 0.5 * self.clearance.stretches_m:
            allowed = f"at least half of clearance.stretches_m, which is {self.clearance.stretches_m}"
            raise disagreement("min_bend_radius_m", self.min_bend_radius_m, allowed)
        if self.max_decoy_distance_m < self.clearance.beside_m:
            allowed = f"at least clearance.beside_m, which is {self.clearance.beside_m}"
            raise disagreement("max_decoy_distance_m", self.max_decoy_distance_m, allowed)
        return self
