"""How alike two sets of files are: `symolo compare`."""
