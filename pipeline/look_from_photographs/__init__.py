"""A look fitted to photographs of a user: reading, fit, and the files."""
