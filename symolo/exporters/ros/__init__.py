"""The messages of ROS bags, for ROS 1 and ROS 2 alike."""
