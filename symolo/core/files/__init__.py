"""Files on disk: whole or not at all, hashed, locked, and read within limits."""
