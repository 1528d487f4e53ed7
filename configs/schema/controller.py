"""The built-in controller: line and wall following, corners, avoidance and search (paper section 4)."""

from typing import Annotated

from pydantic import Field

from configs.schema.base import FromList, Point2, Section


class FollowGains(Section):
    """v = K1 - K3 |e|, w = K2 e (paper Eq. 6-7), with e in units of the line sensor's weights."""

    k1_m_s: float = Field(gt=0, le=2)
    """Speed without an error, K1 [m/s]."""
    k2_rad_s: float = Field(ge=0, le=20)
    """Yaw rate per error, K2 [rad/s]."""
    k3_m_s: float = Field(ge=0, le=2)
    """Loss of speed per error, K3 [m/s]."""


class WallFollowing(Section):
    """Following of a wall beside the robot."""

    gains: FollowGains
    """Gains of the control law, with the scaled wall error in place of the line error."""
    target_distance_m: float = Field(gt=0, le=1)
    """Perpendicular distance of the sensor from the wall (paper Eq. 14)."""
    error_scale_per_m: float = Field(gt=0, le=1000)
    """Factor from the wall error to the range of the line error."""
    far_error_limit: float = Field(gt=0, le=3.5)
    """Limit of the wall error of a robot that is too far away; small, because at the end of a wall the beam sees wall
    and background together, and a large error would turn the robot around the end."""
    lost_beyond_m: float = Field(gt=0, le=2)
    """Reading of the side sensor above which the followed wall is lost."""
    found_within_m: float = Field(gt=0, le=2)
    """Reading of the side sensor below which a wall can be followed."""


class Corner(Section):
    """Turn at a wall that stands ahead of a followed wall."""

    front_below_m: float = Field(gt=0, le=2)
    """Reading of the front sensor below which the robot turns away from the wall ahead [m]."""
    turn_rate_rad_s: float = Field(gt=0, le=20)
    """Yaw rate of that turn [rad/s]."""
    front_clear_m: float = Field(gt=0, le=2)
    """Reading of the front sensor above which the turn may end [m]."""


class CurvePath(Section):
    """A spline in the frame of the robot where avoidance began, x forward, y left, for a bend to the left."""

    points: Annotated[tuple[Point2, ...], FromList, Field(min_length=4, max_length=100)]
    """Control points; the first is the robot itself."""


class FaceObstacle(Section):
    """Turn of the robot towards an obstacle on a bend, after which a stored path fits every encounter."""

    speed_m_s: float = Field(gt=0, le=2)
    """Speed of the robot when it drives back or trims its distance [m/s]."""
    turn_rate_rad_s: float = Field(gt=0, le=20)
    """Yaw rate of the search for the obstacle's edges [rad/s]."""
    back_below_m: float = Field(ge=0, le=2)
    """Reading of the sensor that detected the obstacle below which the robot first backs off, for room to turn."""
    back_m: float = Field(ge=0, le=0.5)
    """Length of the drive backwards [m]."""
    seen_below_m: float = Field(gt=0, le=2)
    """Reading of the front sensor below which it sees the obstacle."""
    max_out_rad: float = Field(gt=0, le=3.2)
    """Largest turn away from the inside of the bend in the search for the obstacle's outer edge."""
    max_in_rad: float = Field(gt=0, le=3.2)
    """Largest turn towards the inside of the bend."""
    edge_m: float = Field(gt=0, le=1)
    """Readings within this distance of the smallest belong to the middle of the obstacle."""
    face_gain_1_s: float = Field(gt=0, le=20)
    """Yaw rate per angle between the heading and the obstacle's middle."""
    tolerance_rad: float = Field(gt=0, le=1)
    """Angle from the obstacle's middle at which the robot faces it [rad]."""
    tolerance_m: float = Field(gt=0, le=0.1)
    """Deviation of the distance at which trimming ends [m]."""
    max_trim_m: float = Field(gt=0, le=0.5)
    """Longest drive that brings the obstacle to the distance at which the paths begin."""


class CurveAvoidance(Section):
    """Paths for obstacles on a bend (paper section 4.3, Fig. 7b and 7c), mirrored for a bend to the right.

    They begin where the obstacle stands straight ahead at `avoidance.front_below_m`.
    """

    side_below_m: float = Field(gt=0, le=2)
    """Reading of a side sensor below which it sees an obstacle on a bend that the front sensor cannot see."""
    ahead_below_m: float = Field(gt=0, le=2)
    """Front reading below which, on a straight, a body ahead is an obstacle; the reading is too large while the body is
    only partly in the beam."""
    both_below_m: float = Field(ge=0, le=2)
    """Reading of the front and of a side sensor below which, on a straight, an obstacle is between the two beams."""
    memory_m: float = Field(gt=0, le=10)
    """Length of the recent path over which the turn is measured."""
    straight_below_rad: float = Field(gt=0, le=3.2)
    """Turn below which the recent path is straight."""
    face: FaceObstacle
    """Turn towards the obstacle before a path begins."""
    inner: CurvePath
    """Path on the inside of a bend."""
    outer: CurvePath
    """Path on the outside of a bend."""
    turn_rate_rad_s: float = Field(gt=0, le=20)
    """Yaw rate of turns on the spot and largest yaw rate on the path; sharper bends are driven more slowly."""
    turn_above_rad: float = Field(gt=0, le=3.2)
    """Angle between heading and path above which the robot turns on the spot."""
    line_after_m: float = Field(gt=0, le=2)
    """Distance without the line after which the robot follows it again when it sees it."""
    cross_m: float = Field(gt=0, le=0.5)
    """Distance that the robot drives on after it meets the line, before it turns into it."""


class Avoidance(Section):
    """A pre-computed path beside the obstacle: out, along, back (paper section 4.3, Fig. 7a)."""

    front_below_m: float = Field(gt=0, le=2)
    """Reading of the front sensor below which avoidance begins [m]."""
    free_side_beyond_m: float = Field(gt=0, le=2)
    """Reading of a side sensor from which on that side is free to pass [m]."""
    out_length_m: float = Field(gt=0, le=2)
    """Length along the line over which the path leaves it [m]."""
    along_length_m: float = Field(gt=0, le=2)
    """Length of the path beside the obstacle [m]."""
    back_length_m: float = Field(gt=0, le=2)
    """Length along the line over which the path returns to it [m]."""
    side_m: float = Field(gt=0, le=1)
    """Distance of the path from the line beside the obstacle [m]."""
    points: int = Field(ge=10, le=100_000)
    """Number of points of the path."""
    speed_m_s: float = Field(gt=0, le=2)
    """Speed on the path [m/s]."""
    look_ahead_m: float = Field(gt=0, le=0.5)
    """Distance along the path to the point that the robot steers to [m]."""
    behind_beyond_m: float = Field(gt=0, le=2)
    """Reading of the side sensor towards the obstacle above which the obstacle is passed."""
    curves: CurveAvoidance | None = None
    """Settings of the curve paths, by which obstacles on a line are passed; without them the robot takes the straight
    path."""


class Lost(Section):
    """States 33 and 44: the robot searches for a lost wall on its side. At first it drives nearly straight, because the
    wall may continue beyond a gap.
    """

    speed_m_s: float = Field(ge=0, le=2)
    """Speed during the search [m/s]."""
    turn_rate_rad_s: float = Field(ge=0, le=20)
    """Yaw rate of the search [rad/s]."""
    gap_m: float = Field(ge=0, le=5)
    """Distance without a wall after which the wall counts as ended; an immediate turn would hit the end of the wall."""
    gap_turn_rate_rad_s: float = Field(ge=0, le=20)
    """Yaw rate before `gap_m` is reached [rad/s]; small, so that a gap is crossed nearly straight."""


class Controller(Section):
    """Settings of the built-in controller, by what it does (paper section 4)."""

    line: FollowGains
    wall: WallFollowing
    corner: Corner
    avoidance: Avoidance
    lost: Lost
