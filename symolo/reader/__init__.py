"""Released datasets as tables, poses and images in memory."""
