"""Line sensors: rows of channels that measure how much light the floor reflects."""
