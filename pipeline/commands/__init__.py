"""The commands of `symolo`: one file for each command, or for a group of commands that belong together.

`make/` has the commands that make data, `datasets/` those for datasets that exist, `measured/` those for measured data.
`options.py` declares the options that several commands share. A command imports what it needs when it is called, so
that `symolo --help` is quick.
"""
