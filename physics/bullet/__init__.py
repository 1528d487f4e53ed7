"""The PyBullet engine; the only place that imports pybullet."""
