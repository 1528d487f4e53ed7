"""Bags of ROS 1 and ROS 2: what their topics say, read in a child process."""
