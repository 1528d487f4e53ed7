"""A page that plays the runs of a dataset in a browser."""
