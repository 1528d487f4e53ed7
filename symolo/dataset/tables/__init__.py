"""The tables of a run: data.csv and the side tables."""
