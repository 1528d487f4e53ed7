"""Units of work, the worker processes that do them, and the supervisor of the workers."""
