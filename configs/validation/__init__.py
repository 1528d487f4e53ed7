"""Validation of a tree against the schema: its shape, the faults of a tree, and the errors that name them."""
