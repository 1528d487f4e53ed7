"""What is read: line sensor, time-of-flight sensors, encoders, odometry."""
