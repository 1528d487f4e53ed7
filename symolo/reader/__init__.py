"""Released datasets as tables, poses and pictures in memory."""
