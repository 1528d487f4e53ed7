"""Range sensors: time of flight, ultrasound and lidar, and the effects on a reading of a range."""
