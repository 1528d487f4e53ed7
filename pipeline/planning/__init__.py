"""The output of a scenario and its cost."""
