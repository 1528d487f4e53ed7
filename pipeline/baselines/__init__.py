"""Localisation baselines on a release: one file for each method, and this table."""

from pipeline.baselines import ekf, odometry, particles, regressor
from pipeline.baselines.base import Method

METHODS: tuple[Method, ...] = (odometry.METHOD, ekf.METHOD, particles.METHOD, regressor.METHOD)
"""Methods in the order of tables and figures."""
