"""The posterior of a diagnosis: its file, and robots that are drawn from it."""
