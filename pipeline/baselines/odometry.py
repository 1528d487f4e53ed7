"""Wheel odometry: counts added up from the start, and nothing else looked at."""

from collections.abc import Sequence

import numpy as np

from pipeline.baselines.base import Estimate, Method, TrainingRun
from pipeline.baselines.motion import WheelMotion, begun, slip_sd_m, ways
from pipeline.baselines.robot_knowledge import RobotKnowledge


def _estimate(knowledge: RobotKnowledge, _lessons: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    motion = WheelMotion(knowledge.drawing.odometry)
    state, covariance = begun(knowledge.start)
    poses, covariances = [], []
    for ways_m in ways(knowledge):
        by_state, by_ways = motion.jacobians(state, ways_m)
        covariance = by_state @ covariance @ by_state.T + (by_ways * slip_sd_m(ways_m) ** 2) @ by_ways.T
        state = motion.moved(state, ways_m)
        poses.append(state[:3])
        covariances.append(covariance[:3, :3])
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


METHOD = Method("odometry", "wheel odometry", "encoder counts added up from the start", _estimate)
