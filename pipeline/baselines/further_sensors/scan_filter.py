"""Scan matching: wheel odometry, corrected by scans of many rays that agree with the map.

Each scan is one measurement of an iterated extended Kalman filter (Bar-Shalom, Li and Kirubarajan, Estimation with
Applications to Tracking and Navigation, 2001, section 10.5.2). As in ICP, each iteration looks up what the map has
where each ray points, and then moves the robot so that the readings agree with it, from point to plane (Chen and
Medioni, "Object modelling by registration of multiple range images", 1992). Beside pose and wheels, the state has the
error of all ranges that lasts during a run. The map has an error too: each surface is displaced along its normal.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physics.arena.rays import RayScene
from pipeline.baselines.ekf import GATE
from pipeline.baselines.further_sensors.scans import MatchedScan, ScanLog
from pipeline.baselines.motion import STATES, WheelMotion, initial_state, rolled_distances_m
from pipeline.baselines.robot_knowledge import MAP_SD_M, RobotKnowledge
from symolo.core.arrays import Array
from symolo.core.geometry.poses import rotations_about_z
from symolo.dataset.tables.rows import Ints
from symolo.evaluation.estimate import Estimate

LASTING = STATES
"""Index of the lasting error of the sensor in the state."""
ITERATIONS = 4
GRAZING = 0.2
"""Cosine of the incidence below which a ray is not used: a small turn would change its range much."""
BEYOND_M = 1.0
"""Length [m] beyond its reading at which a ray ends on the map."""
AS_ONE_S = 1.0
"""Time [s] within which the error of the map is the same: all scans of this time show as little of it as one."""
MIN_LASTING_SD = 1e-6
"""Smallest standard deviation of the lasting error, so that the covariance of the state has an inverse."""
MIN_SHARE = 0.5
"""Share of the rays to a surface that must agree with it; otherwise something else is there, and none is used."""
MIN_RAYS = 10
"""Number of rays that must agree with the map."""


@dataclass(frozen=True)
class _Residuals:
    """Rays that meet something on the map."""

    error_m: Array
    """(K,), reading less expected range."""
    by_state: Array
    """(K, 7), derivatives of the expected reading by the state."""
    variance: Array
    """(K,), variance of the noise of each reading."""
    shared_sd_m: Array
    """(K,), standard deviation of the error that the rays on a surface share: of the map, and of the sensor."""
    surface: Ints
    """(K,), number of the surface that each ray meets."""

    def only(self, rays: NDArray[np.bool_]) -> "_Residuals":
        return _Residuals(
            self.error_m[rays], self.by_state[rays], self.variance[rays], self.shared_sd_m[rays], self.surface[rays]
        )


class ScanFilter:
    """An extended Kalman filter of pose and wheels that scans correct.

    The last state is the lasting error of the ranges. `predict` moves the state by the travels of the wheels, and
    `correct` matches a scan with the map.
    """

    def __init__(self, knowledge: RobotKnowledge, log: ScanLog, scan_period_s: float) -> None:
        self._motion = WheelMotion.from_knowledge(knowledge)
        self._scene = RayScene(knowledge.map)
        state, covariance = initial_state(knowledge.start)
        self.state = np.append(state, 0.0)
        self.covariance = np.diag([0.0] * STATES + [max(log.lasting_sd, MIN_LASTING_SD) ** 2])
        self.covariance[:STATES, :STATES] = covariance
        self._map_sd_m = MAP_SD_M * np.sqrt(max(AS_ONE_S / scan_period_s, 1.0))

    def predict(self, rolled_m: Array) -> None:
        by_state, by_rolled = np.eye(len(self.state)), np.zeros((len(self.state), 2))
        by_state[:STATES, :STATES], by_rolled[:STATES] = self._motion.jacobians(self.state[:STATES], rolled_m)
        noise = (by_rolled * self._motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        self.covariance = by_state @ self.covariance @ by_state.T + noise
        self.state[:STATES] = self._motion.moved(self.state[:STATES], rolled_m)

    def correct(self, scan: MatchedScan) -> None:
        """Update the state by a scan; leave it if too few rays agree with the map."""
        prior, information = self.state, np.linalg.inv(self.covariance)
        state, gained = prior.copy(), np.zeros_like(information)
        for _ in range(ITERATIONS):
            near = self._gated(self._residuals(scan, state), state - prior)
            if len(near.error_m) < MIN_RAYS:
                return
            gained, pull = self._gained(near, near.error_m + near.by_state @ (state - prior))
            state = prior + np.linalg.solve(information + gained, pull)
        self.state, self.covariance = state, np.linalg.inv(information + gained)

    def _gated(self, every: _Residuals, moved: Array) -> _Residuals:
        """Return the rays whose readings are likely by the prediction, at a state that was moved from it."""
        spread = np.einsum("ki,ij,kj->k", every.by_state, self.covariance, every.by_state)
        variance = every.variance + every.shared_sd_m**2
        from_prior_m = every.error_m + every.by_state @ moved
        likely = from_prior_m**2 <= GATE * (spread + variance)
        near = every.error_m**2 <= GATE * (variance + 0.25 * spread)
        agree = likely & near
        for surface in np.unique(every.surface):
            on = every.surface == surface
            agree[on] &= np.mean(agree[on]) >= MIN_SHARE
        return every.only(agree)

    def _residuals(self, scan: MatchedScan, state: Array) -> _Residuals:
        """Return the rays that meet a wall or obstacle of the map from the pose of a state (7,)."""
        R_WR = rotations_about_z(state[2:3])[0]
        place = np.array([state[0], state[1], 0.0])
        origins, points = place + scan.origins_R @ R_WR.T, place + scan.points_R @ R_WR.T
        range_m = np.linalg.norm(points - origins, axis=1)
        along = (points - origins) / range_m[:, None]
        reach_m = range_m + BEYOND_M
        hits = self._scene.cast(origins, origins + reach_m[:, None] * along)
        facing = np.einsum("ki,ki->k", along, hits.normal)
        (used,) = ((hits.surface > 0) & (-facing > GRAZING)).nonzero()
        normal, facing, expected_m = hits.normal[used], facing[used], (hits.fraction * reach_m)[used]
        arm = origins[used] + expected_m[:, None] * along[used] - place
        by_state = np.zeros((len(used), len(state)))
        by_state[:, :2] = -normal[:, :2] / facing[:, None]
        by_state[:, 2] = -(normal[:, 1] * arm[:, 0] - normal[:, 0] * arm[:, 1]) / facing
        by_state[:, LASTING] = scan.by_lasting[used]
        error_m = range_m[used] - expected_m - scan.by_lasting[used] * state[LASTING]
        shared_sd_m = np.hypot(self._map_sd_m / facing, scan.shared_sd_m[used])
        return _Residuals(error_m, by_state, scan.sd_m[used] ** 2, shared_sd_m, hits.surface[used])

    def _gained(self, rays: _Residuals, error_m: Array) -> tuple[Array, Array]:
        """Return the information (7, 7) of the rays about the state, and its product with the state they show (7,).

        The covariance of the rays on a surface is a diagonal, and a matrix of rank one for the error that they share;
        the inverse is that of Sherman and Morrison.
        """
        weight = 1.0 / rays.variance
        both = np.column_stack((rays.by_state, error_m))
        product = (rays.by_state * weight[:, None]).T @ both
        for surface in np.unique(rays.surface):
            on = rays.surface == surface
            shared = weight[on] * rays.shared_sd_m[on]
            total = shared @ both[on]
            product -= np.outer(total[:-1], total) / (shared @ rays.shared_sd_m[on] + 1.0)
        return product[:, :-1], product[:, -1]


def matched(knowledge: RobotKnowledge, log: ScanLog) -> Estimate:
    """Return the poses by the wheels and the scans of a log."""
    rows = [scan.row for scan in log.scans]
    period_s = float(np.median(np.diff(knowledge.t_s[rows]))) if len(rows) > 1 else AS_ONE_S
    scan_filter, by_row = ScanFilter(knowledge, log, period_s), {scan.row: scan for scan in log.scans}
    poses, covariances = [], []
    for row, rolled_m in enumerate(rolled_distances_m(knowledge)):
        scan_filter.predict(rolled_m)
        if row in by_row:
            scan_filter.correct(by_row[row])
        poses.append(scan_filter.state[:3].copy())
        covariances.append(scan_filter.covariance[:3, :3])
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))
