"""Stages that predict changes of the pose, and the smoothed poses that they start from."""
