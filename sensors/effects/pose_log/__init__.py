"""Effects on the logged pose: the tracked point, its heading, and its clock."""
