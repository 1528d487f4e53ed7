"""The tables of a run: data.csv and the tables beside it."""
