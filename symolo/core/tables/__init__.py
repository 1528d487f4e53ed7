"""Tables of numbers: rows in files, samples over time, and poses as lines of text."""
