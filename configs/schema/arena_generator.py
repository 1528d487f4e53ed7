"""What a generated arena is to be like: numbers that each run may draw, and the room that is always kept."""

from typing import Annotated

from pydantic import Field, model_validator

from configs.schema.base import FromList, Section, disagreement
from configs.schema.surface import SurfaceName


class Clearance(Section):
    """Room that every generated arena keeps, from the line's middle where nothing else is said.

    The defaults are for robot `nominal`, 0.18 x 0.17 m, with its straight avoidance path of 0.68 m, 0.19 m to the side.
    """

    stretches_m: float = Field(default=0.25, ge=0.02, le=5)
    """Between two stretches of line: the sensor row's 67 mm, and as much again for the robot's wander on either."""
    beside_m: float = Field(default=0.16, ge=0.02, le=5)
    """To whatever is not to be touched: half the robot's width, 35 mm that its corners swing out, 40 mm to spare."""
    ahead_m: float = Field(default=0.32, ge=0.02, le=5)
    """Before the front sensor to what is not in the way; from 0.20 m on it counts as an obstacle to be passed."""
    before_m: float = Field(default=0.50, ge=0.02, le=5)
    """Straight line before an obstacle's middle: 0.33 m from which it is passed, and some to come in straight."""
    after_m: float = Field(default=0.62, ge=0.02, le=5)
    """Straight line behind an obstacle's middle: the rest of the path, and some to settle on the line."""
    obstacle_reach_m: float = Field(default=0.10, ge=0.005, le=5)
    """From the line to the outermost of an obstacle: the path's 0.19 m less half the robot's width."""
    passing_m: float = Field(default=0.35, ge=0.02, le=5)
    """On the side where an obstacle is passed: the path's 0.19 m, the robot's half diagonal, and 35 mm to spare."""
    other_side_m: float = Field(default=0.20, ge=0.02, le=5)
    """On the other side, for a robot that meets the line at 45 degrees and swings over it."""
    free_side_m: float = Field(default=0.52, ge=0.02, le=5)
    """All that the side sensor sees there is further off, where an obstacle is passed; the robot asks for 0.42 m."""
    blocked_side_m: float = Field(default=0.36, ge=0.02, le=5)
    """All that the left sensor sees is nearer, where an obstacle is passed on the right."""
    regained_side_m: float = Field(default=0.38, ge=0.02, le=5)
    """Every box that a side sensor sees is further off, where the robot swings over the line that it meets again behind
    an obstacle: what it sees within 0.34 m in a moment without a line it follows like a wall."""


class ArenaGenerator(Section):
    """A closed line of straights and arcs round a random polygon, walls around it, boxes on it and beside it.

    The line passes the start of the route straight on. Each number may be a distribution, drawn per run; what differs
    within one arena is drawn between `least_` and `most_`.
    """

    corners: int = Field(default=5, ge=3, le=12)
    """Of the polygon that the line rounds off."""
    radius_m: float = Field(default=1.1, ge=0.3, le=20)
    """Mean distance of the corners from the polygon's middle."""
    irregularity: float = Field(default=0.3, ge=0, le=0.9)
    """Share by which a corner may lie further in or out, and by which its direction may be off the even one."""
    elongation: float = Field(default=1.0, ge=1, le=4)
    """Length over width."""
    clockwise: bool = False
    """Which way round the robot goes."""
    min_bend_radius_m: float = Field(default=0.22, ge=0.05, le=5)
    max_bend_radius_m: float = Field(default=0.60, ge=0.05, le=5)
    walls: int = Field(default=4, ge=0, le=12)
    """Sides of the enclosure; 4 make a rectangle, 0 leave it out."""
    min_wall_clearance_m: float = Field(default=0.35, ge=0.02, le=10)
    """From the line to the wall on the side where they are nearest."""
    max_wall_clearance_m: float = Field(default=0.90, ge=0.02, le=10)
    wall_height_m: float = Field(default=0.15, ge=0.01, le=3)
    min_obstacles: int = Field(default=0, ge=0, le=12)
    max_obstacles: int = Field(default=1, ge=0, le=12)
    """Boxes on straight stretches of the line, to be passed; fewer where there is no room for more."""
    min_obstacle_m: float = Field(default=0.08, ge=0.01, le=1)
    max_obstacle_m: float = Field(default=0.10, ge=0.01, le=1)
    max_obstacle_offset_m: float = Field(default=0.01, ge=0, le=1)
    """From the line's middle to the obstacle's."""
    max_obstacle_yaw_deg: float = Field(default=15, ge=0, le=45)
    """Turned against the line."""
    max_decoys: int = Field(default=3, ge=0, le=40)
    """Boxes beside the line, not to be touched; fewer where there is no room for more."""
    min_decoy_m: float = Field(default=0.05, ge=0.01, le=1)
    max_decoy_m: float = Field(default=0.15, ge=0.01, le=1)
    max_decoy_distance_m: float = Field(default=0.60, ge=0.05, le=10)
    """From the line to a decoy's middle."""
    surfaces: Annotated[tuple[SurfaceName, ...], FromList, Field(min_length=1)] = ("white_board", "cardboard", "wood")
    """Of walls and boxes, each as likely."""
    clearance: Clearance = Clearance()

    @model_validator(mode="after")
    def _ranges_and_sides(self) -> "ArenaGenerator":
        for least, most in (
            ("min_bend_radius_m", "max_bend_radius_m"),
            ("min_wall_clearance_m", "max_wall_clearance_m"),
            ("min_obstacles", "max_obstacles"),
            ("min_obstacle_m", "max_obstacle_m"),
            ("min_decoy_m", "max_decoy_m"),
        ):
            low, high = getattr(self, least), getattr(self, most)
            if low > high:
                raise disagreement(least, low, f"at most {most}, which is {high}")
        if self.walls in {1, 2}:
            raise disagreement("walls", self.walls, "0 or 3 and more, because fewer enclose nothing")
        if self.min_bend_radius_m < 0.5 * self.clearance.stretches_m:
            allowed = f"at least half of clearance.stretches_m, which is {self.clearance.stretches_m}"
            raise disagreement("min_bend_radius_m", self.min_bend_radius_m, allowed)
        if self.max_decoy_distance_m < self.clearance.beside_m:
            allowed = f"at least clearance.beside_m, which is {self.clearance.beside_m}"
            raise disagreement("max_decoy_distance_m", self.max_decoy_distance_m, allowed)
        return self
