"""The diagnosis as a command: reading cases, running it, writing its files."""
