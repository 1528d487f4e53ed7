"""Localisation baselines on a release: one file for each method, and this table."""

from pipeline.baselines import ekf, odometry, particles, retrieval
from pipeline.baselines.base import Method
from pipeline.baselines.further_sensors import gyro_ekf, lidar_matching, stereo_matching
from pipeline.baselines.learned import method as learned_method

METHODS: tuple[Method, ...] = (
    odometry.METHOD,
    ekf.METHOD,
    particles.METHOD,
    retrieval.METHOD,
    learned_method.METHOD,
    gyro_ekf.METHOD,
    lidar_matching.METHOD,
    stereo_matching.METHOD,
)
"""Methods in the order of tables and figures."""
