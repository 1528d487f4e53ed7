"""What every package builds on: errors, atomic file writing, random streams, strict YAML, progress."""
