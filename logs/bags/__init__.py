"""Bags of ROS 1 and ROS 2: the numbers and images of their topics, read in a child process."""
