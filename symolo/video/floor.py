"""The floor from above in a frame of a video: line, walls, obstacles, the path so far, the robot and its ranges."""

import numpy as np

from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE
from symolo.pages.states import STATE_STYLES, stretches
from symolo.playback.playback import Playback
from symolo.video.canvas import Canvas, Colour, rgb
from symolo.video.rows import row_at
from symolo.video.time_plots import ticks_around

_TAPE, _WALL, _OBSTACLE, _EDGE = (190, 190, 190), (150, 150, 150), (236, 236, 236), (70, 74, 80)
_PAPER = (255, 255, 255)
_PALE = 0.75
"""Share of white in the colour of the path that is still to come."""
_MARGIN_M = 0.12
_CORNERS: Array = 0.5 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
_NOSE: Array = np.array([[0.42, 0.0], [0.1, 0.22], [0.1, -0.22]])
"""Triangle that points ahead, in lengths and widths of the robot."""


class FloorView:
    """The floor of one run; frames may have any order, and those in the order of time are the quickest."""

    def __init__(self, playback: Playback, width_px: int, height_px: int) -> None:
        self._run = playback
        self._boxes = playback.arena.boxes if playback.arena else ()
        low, high = _window(playback)
        self._scale = min(width_px / (high[0] - low[0]), height_px / (high[1] - low[1]))
        self._middle_m, self._middle_px = 0.5 * (low + high), 0.5 * np.array([width_px, height_px])
        self._stretches = stretches(playback.state)
        self._still = self._background(width_px, height_px)
        self._driven, self._driven_to = self._still.copy(), 0

    @property
    def line_px(self) -> float:
        """Width of a line on this floor: thinner on a smaller one."""
        return max(1.0, 0.006 * self._scale)

    def frame(self, row: int) -> Canvas:
        """Return the floor at a row of the run."""
        if row < self._driven_to:
            self._driven, self._driven_to = self._still.copy(), 0
        self._path(self._driven, self._driven_to, row, pale=0.0)
        self._driven_to = row
        canvas = self._driven.copy()
        for box in self._boxes:
            if box.motion is not None:
                (pose,) = box.poses_at(self._run.t_s[row : row + 1])
                self._box(canvas, pose, box.size[:2], _OBSTACLE)
        self._scans(canvas, row)
        self._beams(canvas, row)
        self._robot(canvas, row)
        return canvas

    def _background(self, width_px: int, height_px: int) -> Canvas:
        canvas = Canvas.blank(width_px, height_px)
        for left, right in self._run.arena.line.edges() if self._run.arena else ():
            canvas.area(self._place(np.concatenate((left, right[::-1]))), _TAPE)
        for box in self._boxes:
            if box.motion is None:
                (pose,) = box.poses_at(np.zeros(1))
                self._box(canvas, pose, box.size[:2], _WALL if box.kind == "wall" else _OBSTACLE)
        self._path(canvas, 0, len(self._run.state) - 1, pale=_PALE)
        self._scale_bar(canvas)
        return canvas

    def _scale_bar(self, canvas: Canvas) -> None:
        """Draw a bar of a round length, about an eighth of the height, in the lower left corner."""
        height_px = canvas.pixels.shape[0]
        text_px = 0.03 * height_px
        length_m = ticks_around(np.array([0.0, 0.25 * height_px / self._scale]), from_zero=True)[1]
        left, bottom = 0.5 * text_px, height_px - 0.5 * text_px
        wide = max(length_m * self._scale, 3.2 * text_px) + text_px
        top = bottom - 1.8 * text_px
        plate = np.array([[0.0, top], [wide, top], [wide, height_px], [0.0, height_px]])
        canvas.area(plate, _PAPER)
        ends = np.array([[left, bottom], [left + length_m * self._scale, bottom]])
        canvas.line(ends, _EDGE, 0.15 * text_px)
        canvas.text(f"{length_m:g} m", left, bottom - 0.4 * text_px, text_px, _EDGE)

    def _box(self, canvas: Canvas, pose: Array, size: tuple[float, float], colour: Colour) -> None:
        corners = self._place(_on_floor(pose, _CORNERS * size))
        canvas.area(corners, colour)
        canvas.line(corners, _EDGE, 1.0, closed=True)

    def _path(self, canvas: Canvas, first: int, last: int, *, pale: float) -> None:
        """Draw the path from one row to another, each stretch in the colour of its state, mixed with white."""
        for part in self._stretches:
            begin, end = max(part.first, first), min(part.end, last)
            if begin < end:
                colour = np.array(rgb(STATE_STYLES[part.state].colour))
                red, green, blue = np.rint(colour + pale * (255 - colour)).astype(int).tolist()
                points = self._place(self._run.pose[begin : end + 1, :2])
                canvas.line(points, (red, green, blue), (1.0 if pale else 2.0) * self.line_px)

    def _scans(self, canvas: Canvas, row: int) -> None:
        """Draw the end of each ray of the last scan, from where the robot was then."""
        for scan in self._run.scans:
            index = row_at(scan.t_s, float(self._run.t_s[row]))
            if scan.t_s[index] > self._run.t_s[row] + 1e-6:
                continue
            rays = np.column_stack((np.cos(scan.angles_rad), np.sin(scan.angles_rad)))
            ends = np.array([scan.x_m, scan.y_m]) + scan.range_m[index][:, None] * rays
            pose = self._run.pose[row_at(self._run.t_s, float(scan.t_s[index]))]
            for point in self._place(_on_floor(pose, ends[np.isfinite(ends).all(axis=1)])):
                canvas.area(point + 2.2 * self.line_px * _CORNERS, rgb(BLUE))

    def _beams(self, canvas: Canvas, row: int) -> None:
        for beam in self._run.beams:
            range_m = beam.range_m[row]
            if np.isnan(range_m):
                continue
            start = np.array([beam.x_m, beam.y_m])
            end = start + range_m * np.array([np.cos(beam.yaw_rad), np.sin(beam.yaw_rad)])
            points = self._place(_on_floor(self._run.pose[row], np.array([start, end])))
            canvas.line(points, rgb(beam.colour), self.line_px)
            canvas.area(points[1] + 5.0 * self.line_px * _CORNERS, rgb(beam.colour))

    def _robot(self, canvas: Canvas, row: int) -> None:
        pose, robot = self._run.pose[row], self._run.robot
        size = np.array([robot.length_m, robot.width_m])
        body = self._place(_on_floor(pose, _CORNERS * size))
        canvas.area(body, rgb(STATE_STYLES[int(self._run.state[row])].colour))
        canvas.line(body, _EDGE, 1.0, closed=True)
        wheel = np.array([robot.wheel_diameter_m, 0.3 * robot.wheel_diameter_m])
        for side in (0.5, -0.5):
            canvas.area(
                self._place(_on_floor(pose, _CORNERS * wheel + np.array([0.0, side * robot.track_m]))), (90, 94, 100)
            )
        canvas.area(self._place(_on_floor(pose, _NOSE * size)), (255, 255, 255))

    def _place(self, points_m: Array) -> Array:
        """Return where points (K, 2) in W are in the picture [px]."""
        return self._middle_px + self._scale * (points_m - self._middle_m) * [1.0, -1.0]


def _window(playback: Playback) -> tuple[Array, Array]:
    """Return the smallest and the largest x and y [m] of everything that is shown."""
    points = [playback.pose[:, :2]]
    if playback.arena:
        points += [edge for pair in playback.arena.line.edges() for edge in pair]
        for box in playback.arena.boxes:
            poses = box.poses_at(playback.t_s if box.motion else np.zeros(1))
            points += [_on_floor(pose, _CORNERS * box.size[:2]) for pose in poses[:: max(1, len(poses) // 100)]]
    everything = np.concatenate(points)
    return everything.min(axis=0) - _MARGIN_M, everything.max(axis=0) + _MARGIN_M


def _on_floor(pose: Array, points: Array) -> Array:
    """Return points (K, 2) of a body in W, for its pose (3,)."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return pose[:2] + points @ np.array([[cos, sin], [-sin, cos]])
