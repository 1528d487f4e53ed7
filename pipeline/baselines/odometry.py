"""Wheel odometry: the sum of the encoder counts from the start on, without any other sensor."""

from collections.abc import Sequence

import numpy as np

from pipeline.baselines.base import Method, TrainingRun
from pipeline.baselines.motion import WheelMotion, initial_state, rolled_distances_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.evaluation.estimate import Estimate


def _estimate(knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], _rng: np.random.Generator) -> Estimate:
    motion = WheelMotion.from_knowledge(knowledge)
    state, covariance = initial_state(knowledge.start)
    poses, covariances = [], []
    for rolled_m in rolled_distances_m(knowledge):
        by_state, by_rolled = motion.jacobians(state, rolled_m)
        covariance = by_state @ covariance @ by_state.T + (by_rolled * motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        state = motion.moved(state, rolled_m)
        poses.append(state[:3])
        covariances.append(covariance[:3, :3])
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


METHOD = Method("odometry", "wheel odometry", "encoder counts added up from the start", _estimate)
