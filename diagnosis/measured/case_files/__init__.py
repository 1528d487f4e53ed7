"""Files of a measured case: nominal.yaml and data.csv, read strictly and written."""
